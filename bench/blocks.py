#!/usr/bin/env python3
"""A city of blocks in rows, as CityGML: as many windows as one likes.

    bench/blocks.py SIDE -o blocks.gml                  SIDE x SIDE blocks; 55: 3,025 of them, 1,037,234 windows
    bench/blocks.py SIDE --tiles FOLDER [--megabytes N]  a file a row of blocks, or as many rows as make it so large

Blocks are 28 to 34 m long, 18 m deep and 18 to 36 m high, with walls, roof and ground, along streets of 14 m. Of tiles
the blocks that follow stand north of those before, so that no two files hold the same.
"""
import argparse
import os

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<CityModel xmlns="http://www.opengis.net/citygml/2.0" xmlns:b="http://www.opengis.net/citygml/building/2.0" \
xmlns:g="http://www.opengis.net/gml">
<g:boundedBy><g:Envelope srsName="EPSG:25832" srsDimension="3"><g:lowerCorner>690000 5330000 500</g:lowerCorner>\
<g:upperCorner>700000 5340000 600</g:upperCorner></g:Envelope></g:boundedBy>
"""
TAIL = "</CityModel>\n"


def surface(kind, name, corners):
    places = " ".join("%.2f %.2f %.2f" % c for c in corners + corners[:1])
    polygon = "<g:Polygon><g:exterior><g:LinearRing><g:posList>%s</g:posList></g:LinearRing></g:exterior></g:Polygon>"
    return ("<b:boundedBy><b:%s g:id=\"%s\"><b:lod2MultiSurface><g:MultiSurface><g:surfaceMember>%s"
            "</g:surfaceMember></g:MultiSurface></b:lod2MultiSurface></b:%s></b:boundedBy>\n" %
            (kind, name, polygon % places, kind))


def block(i, j):
    x, y = 690000 + 48.0 * i, 5330000 + 32.0 * j
    length, height = 28 + 2 * ((i + j) % 4), 18 + 3 * ((7 * i + 3 * j) % 7)
    low = [(x, y, 500), (x + length, y, 500), (x + length, y + 18, 500), (x, y + 18, 500)]
    high = [(a, b, c + height) for a, b, c in low]
    name = "block-%d-%d" % (i, j)
    text = "<cityObjectMember><b:Building g:id=\"%s\">\n" % name
    text += surface("GroundSurface", name + "-g", low[::-1]) + surface("RoofSurface", name + "-r", high)
    for k in range(4):
        n = (k + 1) % 4
        text += surface("WallSurface", "%s-%d" % (name, k), [low[k], low[n], high[n], high[k]])
    return text + "</b:Building></cityObjectMember>\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("side", type=int)
    parser.add_argument("-o", dest="output")
    parser.add_argument("--tiles")
    parser.add_argument("--megabytes", type=float, default=0)
    args = parser.parse_args()
    if bool(args.output) == bool(args.tiles):
        parser.error("either -o or --tiles")
    if args.output:
        with open(args.output, "w") as out:
            out.write(HEAD)
            for j in range(args.side):
                out.writelines(block(i, j) for i in range(args.side))
            out.write(TAIL)
        return
    os.makedirs(args.tiles, exist_ok=True)
    row = 0
    for tile in range(args.side):
        with open(os.path.join(args.tiles, "tile-%04d.gml" % tile), "w") as out:
            size = out.write(HEAD)
            while True:
                size += sum(out.write(block(i, row)) for i in range(args.side))
                row += 1
                if size >= 1e6 * args.megabytes:
                    break
            out.write(TAIL)


if __name__ == "__main__":
    main()
