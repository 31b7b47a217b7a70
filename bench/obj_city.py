#!/usr/bin/env python3
"""A city at night as OBJ, made without Nocturne: for measurements on a scene that its own city building never touched.

    bench/obj_city.py MODEL.city.json[.gz] -o city.obj

reads buildings from CityJSON (1.x and 2.0, coordinates in metres; Nocturne would build its own city of it) and writes
city.obj, y up, near the origin, and city.mtl beside it: walls and roofs as the polygons they are, a flat ground, dark
and lit windows, shop fronts, neon signs, and street lamps with emissive faces. Ke is radiance in cd/m2. Lit windows are
chosen among all so that there are --quads emissive quads, every one a parallelogram. The same model, numbers and seed
make the same files.

The land is taken as flat at the foot of the lowest building. Polygons with holes are left out and counted: OBJ has no
holes.
"""
import argparse
import collections
import gzip
import itertools
import json
import math
import os
import random
import sys
import zlib

STOREY = 2.9        # m
CELL = 8.0          # m, of the grid that roofs are found by
LAND = 1500.0       # m, of ground around the model
STREET = 40.0       # m, between copies of it
PANE = .01          # m, of windows before their wall: no wall behind them that a pixel could look at, past their edge
NESTING = {"MultiSurface": 0, "CompositeSurface": 0, "Solid": 1, "MultiSolid": 2, "CompositeSolid": 2}
BUILDINGS = ("Building", "BuildingPart", "BuildingInstallation")

# Linear Rec.709, luminance left open.
WARM, NEUTRAL, SODIUM = (1, .69, .36), (1, .93, .83), (1, .52, .08)
WHITES = {"bulb": (1, .62, .27), "warm": WARM, "neutral": NEUTRAL, "curtain": (1, .45, .2), "screen": (.55, .8, 1)}
NEON = {"red": (1, .06, .05), "amber": (1, .45, .03), "green": (.1, 1, .2), "cyan": (.1, .8, 1), "violet": (.7, .15, 1)}
PAINT = ((.30, .16, .11), (.36, .22, .15), (.24, .13, .10), (.46, .42, .36), (.55, .52, .47), (.33, .32, .31))

Lamp = collections.namedtuple("Lamp", "name colour lumens height lantern")
LAMPS = (Lamp("street_warm", WARM, 4500, 7.0, False), Lamp("street_neutral", NEUTRAL, 6500, 8.0, False),
         Lamp("street_sodium", SODIUM, 5600, 6.0, False), Lamp("lantern", WARM, 1800, 4.0, True))


def luminance(rgb):
    return .2126 * rgb[0] + .7152 * rgb[1] + .0722 * rgb[2]


def shining(rgb, cd_m2):
    return tuple(c * cd_m2 / luminance(rgb) for c in rgb)


def add(p, q, factor=1.0):
    return tuple(a + factor * b for a, b in zip(p, q))


def newell(ring):
    """The normal of a polygon, as long as the polygon's area (Newell's method)."""
    n = [0.0, 0.0, 0.0]
    for p, q in zip(ring, ring[1:] + ring[:1]):
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            n[k] += (p[i] - q[i]) * (p[j] + q[j]) / 2
    return n


def holds(ring, x, y):
    """Whether a polygon of the plane holds a point (crossings of a ray)."""
    inside = False
    for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1]):
        if (ay > y) != (by > y) and x < (bx - ax) * (y - ay) / (by - ay) + ax:
            inside = not inside
    return inside


# ---- the model ----

def read_model(path):
    try:
        with open(path, "rb") as f:
            data = f.read()
        model = json.loads(gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data)
    except (OSError, EOFError, ValueError, zlib.error) as error:
        sys.exit("obj_city: %s: %s" % (path, error))
    if not isinstance(model, dict) or model.get("type") != "CityJSON":
        sys.exit("obj_city: %s: not CityJSON" % path)
    return model


def flatten(faces, values, depth):
    """(face, value or None) of nested lists; any list of values may be null."""
    for part, value in zip(faces, values or itertools.repeat(None)):
        if depth:
            yield from flatten(part, value, depth - 1)
        else:
            yield part, value


def surfaces(geometry):
    """(rings, semantic type or None) of every surface of a geometry."""
    semantics = geometry.get("semantics") or {}
    for rings, value in flatten(geometry["boundaries"], semantics.get("values"), NESTING[geometry["type"]]):
        yield rings, semantics["surfaces"][value]["type"] if value is not None else None


class Wall:
    """A vertical polygon in its own plane: s to the right as seen from outside, z up."""

    def __init__(self, ring, normal):
        length = math.hypot(normal[0], normal[1])
        self.ring = ring
        self.normal = (normal[0] / length, normal[1] / length)
        self.origin = ring[0]
        self.right = (-self.normal[1], self.normal[0])
        self.flat = [(self.s_of(p), p[2]) for p in ring]
        self.s0, self.s1 = min(p[0] for p in self.flat), max(p[0] for p in self.flat)
        self.z0, self.z1 = min(p[2] for p in ring), max(p[2] for p in ring)

    def s_of(self, p):
        return (p[0] - self.origin[0]) * self.right[0] + (p[1] - self.origin[1]) * self.right[1]

    def point(self, s, z, before=0.0):
        """The place at (s, z), that many metres before the wall."""
        return tuple(self.origin[k] + s * self.right[k] + before * self.normal[k] for k in (0, 1)) + (z,)

    def holds_quad(self, s0, s1, z0, z1):
        return all(holds(self.flat, s, z) for s in (s0, s1) for z in (z0, z1))

    def quad(self, s0, s1, z0, z1, before):
        return [self.point(s, z, before) for s, z in ((s0, z0), (s1, z0), (s1, z1), (s0, z1))]


class Roofs:
    """Roofs from above: tells what is built over."""

    def __init__(self, rings):
        self.cells = collections.defaultdict(list)
        for ring in rings:
            flat, top = [p[:2] for p in ring], max(p[2] for p in ring)
            columns, rows = ([math.floor(f(p[k] for p in ring) / CELL) for f in (min, max)] for k in (0, 1))
            for i in range(columns[0], columns[1] + 1):
                for j in range(rows[0], rows[1] + 1):
                    self.cells[i, j].append((flat, top))

    def cover(self, p):
        """Whether a point lies below a roof."""
        cell = self.cells.get((math.floor(p[0] / CELL), math.floor(p[1] / CELL)), ())
        return any(p[2] < top and holds(flat, p[0], p[1]) for flat, top in cell)

    def open_around(self, p, radius):
        ring = [add(p, (radius * math.cos(a), radius * math.sin(a), 0)) for a in (k * math.pi / 4 for k in range(8))]
        return not any(self.cover(q) for q in [p] + ring)


class Model:
    """Walls and roofs of each building, near the origin, and what was left out or turned round."""

    def __init__(self, paths):
        self.counts = collections.Counter()
        found = [self.read(read_model(path)) for path in paths]
        buildings = [b for faces in found for b in faces if b]
        points = [p for b in buildings for _, ring in b for p in ring]
        if not points:
            sys.exit("obj_city: no buildings with surfaces in " + ", ".join(paths))
        low, high = ([f(p[k] for p in points) for k in range(3)] for f in (min, max))
        shift = (-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2])
        self.half = ((high[0] - low[0]) / 2, (high[1] - low[1]) / 2)
        buildings = [[(kind, [add(p, shift) for p in ring]) for kind, ring in b] for b in buildings]
        self.roofs = Roofs([ring for b in buildings for kind, ring in b if kind == "roof"])
        self.buildings = [self.sort(b) for b in buildings]

    def read(self, model):
        scale, shift = ((model.get("transform") or {}).get(k, d)
                        for k, d in (("scale", (1, 1, 1)), ("translate", (0, 0, 0))))
        vertices = [tuple(v[k] * scale[k] + shift[k] for k in range(3)) for v in model["vertices"]]
        for name in sorted(model["CityObjects"]):
            thing = model["CityObjects"][name]
            shapes = [g for g in thing.get("geometry", []) if g["type"] in NESTING]
            if thing["type"] in BUILDINGS and shapes:
                finest = max(shapes, key=lambda g: str(g.get("lod", "")))
                yield [face for rings, kind in surfaces(finest) for face in self.face(vertices, rings, kind)]

    def face(self, vertices, rings, kind):
        ring = [vertices[i] for i in rings[0]]
        normal = newell(ring)
        area = math.hypot(*normal)
        if len(rings) > 1 or area < 1e-3:
            self.counts["polygons with holes left out" if len(rings) > 1 else "polygons without area left out"] += 1
        elif abs(normal[2]) < .05 * area:
            yield "wall", ring
        elif kind != "GroundSurface" and (kind == "RoofSurface" or normal[2] > 0):
            yield "roof", ring

    def sort(self, building):
        walls, roofs = [], []
        for kind, ring in building:
            normal = newell(ring)
            if kind == "roof":
                roofs.append(ring if normal[2] >= 0 else ring[::-1])
                self.counts["roofs turned round"] += normal[2] < 0
                continue
            wall = Wall(ring, normal)
            middle = (wall.s0 + wall.s1) / 2, (wall.z0 + wall.z1) / 2
            before, behind = (self.roofs.cover(wall.point(*middle, d)) for d in (.2, -.2))
            if before and not behind:
                wall = Wall(ring[::-1], [-c for c in normal])
                self.counts["walls turned round"] += 1
            walls.append(wall)
        self.counts["buildings whose foot is above the ground"] += bool(walls) and min(w.z0 for w in walls) > 1
        return walls, roofs


# ---- what is added ----

class Night:
    """Quads by material; emissive ones are counted."""

    def __init__(self, model, seed):
        self.model = model
        self.random = random.Random(seed)
        self.materials = {"ground": ((.11, .11, .12), None), "roof": ((.16, .13, .12), None),
                          "metal": ((.08, .08, .09), None),
                          "glass": ((.05, .06, .07), None)}
        for k, rgb in enumerate(PAINT):
            self.materials["wall%d" % k] = (rgb, None)
        self.quads = collections.defaultdict(list)
        self.counts = collections.Counter()

    def emit(self, quad, what, name, rgb, cd_m2):
        self.materials.setdefault(name, ((.05, .05, .05), shining(rgb, cd_m2)))
        self.quads[name].append(quad)
        self.counts[what] += 1

    def pick(self, things):
        return things[int(self.random.random() * len(things))]

    def between(self, low, high):
        return low + (high - low) * self.random.random()

    # Lamps: no two nearer than spacing, on open ground before walls.

    def lamp_places(self, count, spacing):
        wishes = []
        for walls, _ in self.model.buildings:
            for wall in walls:
                if wall.z0 > .5 or wall.s1 - wall.s0 < 1:
                    continue
                for k in range(max(1, int((wall.s1 - wall.s0) / 2))):
                    s = self.between(wall.s0, wall.s1)
                    away = 3 + 40 * self.random.random() ** 2 # m, mostly along the fronts
                    wishes.append((self.random.random(), wall.point(s, 0, away), wall.normal))
        taken, near = [], collections.defaultdict(list)
        for _, p, direction in sorted(wishes):
            i, j = (math.floor(p[k] / spacing) for k in (0, 1))
            others = (q for di in (-1, 0, 1) for dj in (-1, 0, 1) for q in near[i + di, j + dj])
            if all(math.dist(p, q) >= spacing for q in others) and self.model.roofs.open_around(p, 1.8):
                near[i, j].append(p)
                taken.append((p, direction))
                if len(taken) == count:
                    break
        return taken

    def box(self, low, high, place, direction, lit=(), **light):
        """A box along a direction, between two corners as seen from the place; faces named in lit shine."""
        x, y = direction, (-direction[1], direction[0])

        def at(u, v, z):
            return (place[0] + u * x[0] + v * y[0], place[1] + u * x[1] + v * y[1], place[2] + z)
        (u0, v0, z0), (u1, v1, z1) = low, high
        faces = {"bottom": ((u0, v0, z0), (u0, v1, z0), (u1, v1, z0), (u1, v0, z0)),
                 "top": ((u0, v0, z1), (u1, v0, z1), (u1, v1, z1), (u0, v1, z1)),
                 "back": ((u0, v1, z0), (u0, v0, z0), (u0, v0, z1), (u0, v1, z1)),
                 "front": ((u1, v0, z0), (u1, v1, z0), (u1, v1, z1), (u1, v0, z1)),
                 "right": ((u0, v0, z0), (u1, v0, z0), (u1, v0, z1), (u0, v0, z1)),
                 "left": ((u1, v1, z0), (u0, v1, z0), (u0, v1, z1), (u1, v1, z1))}
        for name, corners in faces.items():
            quad = [at(*c) for c in corners]
            if name in lit:
                self.emit(quad, **light)
            else:
                self.quads["metal"].append(quad)

    def lamp(self, place, direction, kind):
        """Luminance is flux / (pi * area): faces shine as Lambert's do."""
        h = kind.height
        if kind.lantern:
            low, high, lit, area = (-.14, -.14, h - .4), (.14, .14, h), ("front", "back", "left", "right"), 4 * .28 * .4
        else:
            low, high, lit, area = (.3, -.15, h), (1, .15, h + .1), ("bottom", "left", "right"), .7 * .3 + 2 * .7 * .1
            self.box((.06, -.04, h), (.3, .04, h + .08), place, direction)
        self.box(low, high, place, direction, lit, what="faces of lamps", name=kind.name, rgb=kind.colour,
                 cd_m2=kind.lumens / (math.pi * area))
        self.box((-.06, -.06, 0), (.06, .06, h - .4 if kind.lantern else h + .08), place, direction)

    def lamps(self, count, spacing):
        district = {}  # lamps of one district are of one kind
        for place, direction in self.lamp_places(count, spacing):
            key = tuple(math.floor(c / 90) for c in place[:2])
            if key not in district:
                district[key] = self.pick(LAMPS)
            self.lamp(place, direction, district[key])
            self.counts["lamps"] += 1

    # Windows, and what shops and towers add.

    def is_open(self, wall, s, z):
        return not any(self.model.roofs.cover(wall.point(s, z, d)) for d in (.3, 1.5, 3))

    def openings(self, wall, shop, sign_from):
        """(s0, s1, z0, z1, of a shop) of the windows that a wall has room for."""
        for storey in range(int((wall.z1 - wall.z0) / STOREY) + 1):
            ground = wall.z0 < .5 and storey == 0
            wide, high, sill = (2.6, 2.1, .4) if shop and ground else (1.2, 1.4, .9)
            step = wide + (.5 if shop and ground else .8)
            z = wall.z0 + storey * STOREY + sill
            n = int((wall.s1 - wall.s0 - .6) / step)
            for k in range(n if z + high < sign_from else 0):
                s = (wall.s0 + wall.s1) / 2 + (k - (n - 1) / 2) * step
                room = wall.holds_quad(s - wide / 2 - .2, s + wide / 2 + .2, z - .2, z + high + .2)
                if room and self.is_open(wall, s, z + high):
                    yield s - wide / 2, s + wide / 2, z, z + high, shop and ground

    def sign(self, wall, s, z, wide, high):
        if wall.holds_quad(s - wide / 2, s + wide / 2, z, z + high) and self.is_open(wall, s, z):
            name = self.pick(sorted(NEON))
            self.box((0, -wide / 2, 0), (.15, wide / 2, high), wall.point(s, z), wall.normal, ("front",), what="signs",
                     name="neon_" + name, rgb=NEON[name], cd_m2=350)

    def windows(self, quads):
        """Shop fronts and signs shine; of all other windows so many as are missing."""
        dark = []
        for walls, _ in self.model.buildings:
            business = self.random.random() < .1
            for wall in walls:
                width = wall.s1 - wall.s0
                shop = business and wall.z0 < .5 and width > 3.5
                tower = wall.z0 < .5 and wall.z1 > 22 and width > 9 and self.random.random() < .4
                if shop:
                    self.sign(wall, (wall.s0 + wall.s1) / 2, 2.75, min(4, .7 * width), .5)
                if tower:
                    self.sign(wall, (wall.s0 + wall.s1) / 2, wall.z1 - 2.6, min(8, .7 * width), 1.8)
                for s0, s1, z0, z1, front in self.openings(wall, shop, wall.z1 - 2.8 if tower else math.inf):
                    if front:
                        white, cd_m2 = self.pick(("warm", "neutral")), self.pick((200, 500))
                        self.emit(wall.quad(s0, s1, z0, z1, PANE), "shop windows", "shop_%s_%d" % (white, cd_m2),
                                  WHITES[white], cd_m2)
                    else: # two casements
                        half = (s1 - s0) / 2 - .04
                        panes = [wall.quad(s, s + half, z0, z1, PANE) for s in (s0, s1 - half)]
                        dark.append((self.random.random(), panes))
        dark.sort()
        missing = min(len(dark), max(0, quads - self.emissive()) // 2)
        for _, panes in dark[:missing]:
            white, cd_m2 = self.pick(sorted(WHITES)), self.pick((10, 30, 80, 200))
            for pane in panes:
                self.emit(pane, "panes of lit windows", "window_%s_%d" % (white, cd_m2), WHITES[white], cd_m2)
        for _, panes in dark[missing:]:
            self.quads["glass"] += panes
        self.counts["dark windows"] = len(dark) - missing

    def emissive(self):
        return sum(self.counts[k] for k in ("faces of lamps", "signs", "shop windows", "panes of lit windows"))


# ---- OBJ ----

class Writer:
    """Vertices are shared within an object; y is up."""

    def __init__(self, file):
        self.file, self.total, self.known, self.polygons = file, 0, {}, 0
        self.shift, self.prefix = (0.0, 0.0), ""

    def begin(self, name):
        self.known = {}
        self.file.write("o %s%s\n" % (self.prefix, name))

    def material(self, name):
        self.file.write("usemtl %s\n" % name)

    def polygon(self, ring):
        indices = []
        for x, y, z in ring:
            text = "v %.3f %.3f %.3f\n" % (x + self.shift[0], z, -y - self.shift[1])
            if text not in self.known:
                self.file.write(text)
                self.total += 1
                self.known[text] = self.total
            indices.append(self.known[text])
        self.file.write("f " + " ".join(map(str, indices)) + "\n")
        self.polygons += 1


def write_materials(file, materials):
    for name, (kd, ke) in materials.items():
        file.write("newmtl %s\nKd %.3f %.3f %.3f\n" % ((name,) + kd))
        file.write("Ks .06 .06 .06\nNs 1000\nillum 2\n" if name == "glass" else "illum 1\n")
        if ke:
            file.write("Ke %.4g %.4g %.4g\n" % ke)
        file.write("\n")


def write_copy(out, model, night, paint):
    for k, (walls, roofs) in enumerate(model.buildings):
        out.begin("building%d" % k)
        out.material("wall%d" % paint[k])
        for wall in walls:
            out.polygon(wall.ring)
        out.material("roof")
        for ring in roofs:
            out.polygon(ring)
    for name in sorted(night.quads):
        out.begin(name)
        out.material(name)
        for quad in night.quads[name]:
            out.polygon(quad)


def write_city(file, library, model, night, copies):
    """Copies stand side by side on one ground, a square of them."""
    out = Writer(file)
    file.write("# a city at night, in metres, y up; Ke in cd/m2\nmtllib %s\n" % library)
    out.begin("ground")
    out.material("ground")
    side = math.ceil(math.sqrt(copies))
    step = tuple(2 * h + STREET for h in model.half)
    x, y = (h + LAND for h in model.half)
    far_x, far_y = x + (side - 1) * step[0], y + (math.ceil(copies / side) - 1) * step[1]
    out.polygon([(-x, -y, 0), (far_x, -y, 0), (far_x, far_y, 0), (-x, far_y, 0)])
    paint = [int(night.random.random() * len(PAINT)) for _ in model.buildings]
    for k in range(copies):
        out.shift, out.prefix = (k % side * step[0], k // side * step[1]), "copy%d_" % k if k else ""
        write_copy(out, model, night, paint)
    return out.polygons


def main():
    parser = argparse.ArgumentParser(description="Writes a real city at night as OBJ with emissive quads.")
    parser.add_argument("models", nargs="+", metavar="MODEL", help="CityJSON, plain or gzip, one CRS for all")
    parser.add_argument("-o", "--output", required=True, metavar="OBJ", help="the MTL is written beside it")
    parser.add_argument("--quads", type=int, default=30000, help="emissive quads, if there are windows enough (30000)")
    parser.add_argument("--lamps", type=int, default=3000, help="street lamps, if there is room (3000)")
    parser.add_argument("--spacing", type=float, default=8, help="least distance of lamps, m (8)")
    parser.add_argument("--copies", type=int, default=1, help="of the city, side by side (1)")
    parser.add_argument("--seed", type=int, default=1, help="another number, other lights (1)")
    args = parser.parse_args()
    model = Model(args.models)
    night = Night(model, args.seed)
    night.lamps(args.lamps, args.spacing)
    night.windows(args.quads)
    stem = os.path.splitext(args.output)[0]
    with open(stem + ".mtl", "w", encoding="ascii") as f:
        write_materials(f, night.materials)
    with open(args.output, "w", encoding="ascii") as f:
        polygons = write_city(f, os.path.basename(stem) + ".mtl", model, night, args.copies)
    print("%d buildings, %d polygons, %d emissive quads" %
          (args.copies * len(model.buildings), polygons, args.copies * night.emissive()))
    for what, count in sorted((night.counts + model.counts).items()): # those above 0
        print("%8d %s" % (count, what))


if __name__ == "__main__":
    main()
