#!/usr/bin/env python3
"""A large CityGML out of a small one, for measurements of loading.

    bench/gml_city.py MODEL.gml[.gz] --megabytes 200 -o city.gml

repeats the model's members side by side, on a square, with ids of their own, until the file is that large. Coordinates
in posList, pos and Envelope's corners are moved by metres (--unit 1) or degrees (--unit 9e-6, latitude first).
"""
import argparse
import gzip
import math
import re

MEMBER = re.compile(rb"<(\w+:)?(cityObjectMember|featureMember)>.*?</\1?\2>", re.S)
LIST = re.compile(rb"(<(?:\w+:)?(?:posList|pos|lowerCorner|upperCorner)\b[^>]*>)([^<]*)(<)")
NAME = re.compile(rb"((?:\w+:)?id=\"|(?:href|ring|uri)=\"#|<(?:\w+:)?(?:target|ring)[^>]*>#)([^\"<]+)")


def move(text, x, y):
    """Text with its coordinates moved; numbers keep their decimals."""
    def moved(match):
        numbers = match.group(2).split()
        if len(numbers) % 3:
            return match.group(0)
        for i, n in enumerate(numbers):
            if i % 3 < 2:
                places = len(n.partition(b".")[2])
                numbers[i] = b"%.*f" % (places, float(n) + (x, y)[i % 3])
        return match.group(1) + b" ".join(numbers) + match.group(3)
    return LIST.sub(moved, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--megabytes", type=float, default=200)
    parser.add_argument("--metres", type=float, default=1500, help="between copies")
    parser.add_argument("--unit", type=float, default=1, help="of coordinates, a metre")
    args = parser.parse_args()
    with (gzip.open if args.model.endswith(".gz") else open)(args.model, "rb") as file:
        text = file.read()
    members = list(MEMBER.finditer(text))
    first, last = members[0].start(), members[-1].end()
    body = text[first:last]
    copies = max(1, round(args.megabytes * 1e6 / len(body)))
    side = math.ceil(math.sqrt(copies))
    with open(args.output, "wb") as out:
        out.write(text[:first])
        for i in range(copies):
            copy = move(body, i % side * args.metres * args.unit, i // side * args.metres * args.unit) if i else body
            out.write(NAME.sub(lambda m, n=b"c%d-" % i: m.group(1) + n + m.group(2), copy) if i else copy)
            out.write(b"\n")
        out.write(text[last:])


if __name__ == "__main__":
    main()
