#!/usr/bin/env python3
"""Measured lux: what a car logged at night in Cambridge, Massachusetts, against nocturne measure at the same places.

usage: bench/fluxmap.py [PROGRAM]

Reads ../shared/data/measured/fluxmap (irawinder/FluxMap, MIT): two logs of lux, and the city's 6,049 street lamps.
The sensor's height and tilt are not told, there are no buildings, and no flux of a lamp: so ranks are compared, not
lux. The first recipe has equal Lambertian lamps 8.5 m up. The second one has what the words of the inventory let
expect: lanterns stand lower and shine to all sides, and the fixture types A1, A2, A3 are taken for large, middling and
small ones.
"""
import csv
import gzip
import math
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
DATA = os.path.join(HERE, "..", "..", "shared", "data", "measured", "fluxmap")
NEAR = 40 # m from a lamp
M_LON, M_LAT = 111320 * math.cos(math.radians(42.37)), 111080
EQUAL = "  - { height: 8.5, profile: none, shape: disc, arm: 0 }\n"
BY_TYPE = "".join("  - { match: { Descriptio: \"%s*\" }, height: 4.3, type: lantern, lumens: 5500 }\n" % word
                  for word in ("Acorn", "Selux", "1907", "Ornamental"))
BY_TYPE += "".join("  - { match: { FixtureTyp: \"%s*\" }, height: %g, profile: none, shape: disc, lumens: %d }\n" % row
                   for row in (("A1", 9.1, 11000), ("A2", 8.5, 7000), ("A3", 7.6, 4000)))


def text_of(name):
    with gzip.open(os.path.join(DATA, name + ".csv.gz"), "rt", encoding="latin-1", newline="") as file:
        return file.read().replace("\r\n", "\n").replace("\r", "\n")


def degrees(value):
    """Of degrees and minutes, DDMM.mmm."""
    whole = int(value / 100)
    return whole + (value - 100 * whole) / 60


def lamps_by_cell(rows):
    cells = {}
    for row in rows:
        try:
            x, y = float(row["x"]) * M_LON, float(row["y"]) * M_LAT
        except (TypeError, ValueError):
            continue
        cells.setdefault((x // NEAR, y // NEAR), []).append((x, y))
    return cells


def is_near(cells, lon, lat):
    x, y = lon * M_LON, lat * M_LAT
    return any(math.hypot(a - x, b - y) <= NEAR for i in (-1, 0, 1) for j in (-1, 0, 1)
               for a, b in cells.get((x // NEAR + i, y // NEAR + j), []))


def readings_of(name, cells):
    """(longitude, latitude, lux) of places near a lamp; those where the car stood count once."""
    found, last = [], None
    for line in text_of(name).splitlines()[1:]:
        try:
            lat, lon, lux = (float(word) for word in line.split(","))
        except ValueError:
            continue
        if name == "LOG1":
            lat, lon = degrees(lat), -degrees(lon)
        if 42 < lat < 43 and -72 < lon < -71 and (lat, lon) != last and is_near(cells, lon, lat):
            found.append((lon, lat, lux))
            last = (lat, lon)
    return found


def ranks(values):
    order, out, i = sorted(range(len(values)), key=values.__getitem__), [0.0] * len(values), 0
    while i < len(order):
        j = i
        while j + 1 < len(order) and values[order[j + 1]] == values[order[i]]:
            j += 1
        for k in order[i:j + 1]:
            out[k] = (i + j) / 2
        i = j + 1
    return out


def correlation(a, b):
    ma, mb = sum(a) / len(a), sum(b) / len(b)
    both = sum((x - ma) * (y - mb) for x, y in zip(a, b))
    return both / math.sqrt(sum((x - ma) ** 2 for x in a) * sum((y - mb) ** 2 for y in b))


def measured(program, folder, recipe, readings):
    with open(os.path.join(folder, "city.yaml"), "w", encoding="ascii") as file:
        file.write("nocturne: 1\ninputs: [lamps.csv]\nluminaires:\n" + recipe)
    points = "".join("%.8f %.8f 1\n" % r[:2] for r in readings)
    out = subprocess.run([program, "measure", os.path.join(folder, "city.yaml"), "-q", "--sky", "0", "--points", "-",
                          "--t-srs", "EPSG:4326"], input=points, capture_output=True, text=True, check=True).stdout
    return [float(row["lux"]) for row in csv.DictReader(out.splitlines())]


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else os.path.join(HERE, "..", "build", "nocturne")
    if not os.path.isdir(DATA):
        sys.exit("fluxmap.py: %s is not here" % DATA)
    inventory = text_of("lightnodes")
    cells = lamps_by_cell(csv.DictReader(inventory.splitlines()))
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "lamps.csv"), "w", encoding="utf-8") as file:
            file.write(inventory)
        print("log    places  lamps            rank correlation  mean lx  measured lx")
        for name in "LOG1", "LOG2":
            readings = readings_of(name, cells)
            lux = [r[2] for r in readings]
            for what, recipe in ("equal, Lambertian", EQUAL), ("by type", BY_TYPE + EQUAL):
                got = measured(program, folder, recipe, readings)
                print("%s %8d  %-18s %14.3f %8.2f %12.2f" % (name, len(lux), what, correlation(ranks(lux), ranks(got)),
                                                            sum(got) / len(got), sum(lux) / len(lux)))


main()
