#!/usr/bin/env python3
"""Draws docs/frame.svg: the passes of a frame in their order, and what each reads and writes.

draw-frame.py [FILE]     default: docs/frame.svg beside this script's folder"""
import os, sys
from xml.sax.saxutils import escape

STRUCTURE, LIGHT_SET, LIGHTS = "ray tracing structure", "light set", "lights, materials"
OLD_G, HISTORY, OLD_LIGHTS = "G-buffer, previous", "reservoirs, history", "lights, previous"
CACHE, PICTURE = "visibility cache", "picture (mean), AOVs"
G, RESERVOIRS, COLOUR = "G-buffer", "reservoirs", "colour"
LIST, BATCH, OBSERVATIONS = "list, candidates", "ray batch", "observations"
GROUPS = [  # buffers, by who owns them
    ("world, shared by views", "#e8eef7", [STRUCTURE, LIGHT_SET, LIGHTS]),
    ("view, kept from frame to frame", "#e9f3e6", [OLD_G, HISTORY, OLD_LIGHTS, CACHE, PICTURE]),
    ("view, of this frame", "#fbf1dc", [G, RESERVOIRS, COLOUR]),
    ("thread, of this tile", "#f3e6f0", [LIST, BATCH, OBSERVATIONS]),
]
# own: reads at its own pixel or tile; other: reads at other pixels too; write; both: reads and writes
RAYS = {STRUCTURE: "own", LIGHTS: "own", G: "own", BATCH: "both"}
PASSES = [  # stage, name, rays a pixel, what it does to which buffer
    (0, "primary", "1, nearest hit", {STRUCTURE: "own", LIGHTS: "own", G: "write"}),
    (0, "candidates", "none", {LIGHT_SET: "own", LIGHTS: "own", CACHE: "own", G: "own", RESERVOIRS: "write",
                               LIST: "write", BATCH: "write"}),
    (0, "visibility", "1, lists: 1 to 2 n", {**RAYS, RESERVOIRS: "both", LIST: "own", OBSERVATIONS: "write"}),
    (0, "temporal", "0 to 2, bias rays", {**RAYS, OLD_G: "other", HISTORY: "other", OLD_LIGHTS: "own",
                                          RESERVOIRS: "both"}),
    (1, "spatial", "0 to k + 1, bias rays", {**RAYS, G: "other", RESERVOIRS: "both-other"}),
    (2, "shade", "0 or 1, reference: n", {**RAYS, RESERVOIRS: "own", LIST: "own", COLOUR: "write"}),
    (2, "sky", "1 or 4", {**RAYS, COLOUR: "both"}),
    (3, "accumulate", "none", {LIGHTS: "own", OLD_LIGHTS: "write", CACHE: "write", PICTURE: "both", G: "own",
                               RESERVOIRS: "own", COLOUR: "own", OBSERVATIONS: "own"}),
    (3, "next frame", "", {OLD_G: "write", HISTORY: "write", G: "own", RESERVOIRS: "own"}),
]
STAGES = ["first stage: tile by tile", "a stage a round", "in the last stage", "when the frame is whole"]
LEFT, TOP, COLUMN, ROW = 190, 66, 98, 30
INK, READ, WRITE = "#222222", "#2f6db3", "#c0551a"
rows = [(name, colour) for _, colour, names in GROUPS for name in names]
width, bottom = LEFT + COLUMN * len(PASSES) + 10, TOP + ROW * len(rows) + 22 * len(GROUPS)
height = bottom + 118
out = []


def text(x, y, s, size=13, anchor="start", style=""):
    out.append('<text x="%g" y="%g" font-size="%g" text-anchor="%s" stroke="none" %s>%s</text>'
               % (x, y, size, anchor, style, escape(s)))


def line(x1, y1, x2, y2, thick):
    out.append('<path d="M%g %gL%g %g" stroke="%s" stroke-width="%g"/>' % (x1, y1, x2, y2, INK, thick))


def box(x, y, w, h, colour):
    out.append('<rect x="%g" y="%g" width="%g" height="%g" stroke="none" fill="%s"/>' % (x, y, w, h, colour))


def mark(x, y, kind):
    """A blue circle: read, with a ring where other pixels are read too. An orange square: written."""
    r = 8
    if kind.endswith("other"):
        out.append('<circle cx="%g" cy="%g" r="%g" fill="none" stroke="%s" stroke-width="2"/>' % (x, y, r + 4, READ))
    if kind in ("own", "other"):
        out.append('<circle cx="%g" cy="%g" r="%g" stroke="none" fill="%s"/>' % (x, y, r, READ))
    elif kind == "write":
        box(x - r, y - r, 2 * r, 2 * r, WRITE)
    else:
        out.append('<path d="M%g %ga%g %g 0 0 1 0 %gz" stroke="none" fill="%s"/>' % (x, y + r, r, r, -2 * r, READ))
        box(x, y - r, r, 2 * r, WRITE)


def draw():
    before = None
    for i, (stage, name, rays, _) in enumerate(PASSES):
        x = LEFT + COLUMN * i
        if stage != before:
            text(x + 6, 20, STAGES[stage], 11, "start", 'font-style="italic"')
        text(x + COLUMN / 2, 52, name, 14, "middle", 'font-weight="bold"')
        before = stage
    y = TOP
    for title, colour, names in GROUPS:
        box(8, y, width - 16, 22 + ROW * len(names), colour)
        text(14, y + 16, title, 12, "start", 'font-weight="bold"')
        y += 22
        for name in names:
            text(24, y + ROW / 2 + 4, name)
            for i, (_, _, _, does) in enumerate(PASSES):
                if name in does:
                    mark(LEFT + COLUMN * i + COLUMN / 2, y + ROW / 2, does[name])
            y += ROW
    text(14, bottom + 20, "rays a pixel", 12, "start", 'font-weight="bold"')
    for i, (stage, _, rays, _) in enumerate(PASSES):
        x = LEFT + COLUMN * i
        begins = i == 0 or stage != PASSES[i - 1][0]
        line(x, 8 if begins else 30, x, bottom + 44, 1.6 if begins else 0.4)
        for k, part in enumerate(rays.split(", ")):
            text(x + COLUMN / 2, bottom + 20 + 15 * k, part, 12, "middle")
    line(8, TOP, width - 8, TOP, 1.6)
    line(8, bottom, width - 8, bottom, 1.6)
    x, y = 24, bottom + 70
    legend = (("own", "read at its own pixel or tile"), ("other", "read at other pixels too"), ("write", "written"),
              ("both", "read and written"), ("both-other", "read at others, written at its own"))
    for kind, what in legend:
        mark(x, y, kind)
        text(x + 18, y + 5, what, 12)
        x += 54 + 5.9 * len(what)
    text(14, y + 32, "No pass reads what another tile's passes of the same stage have written. So tiles may run in any "
         "order on any number of threads, and the picture is the same.", 12)


names = {name for name, _ in rows}
assert all(set(does) <= names for _, _, _, does in PASSES)
draw()
folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../docs")
with open(sys.argv[1] if len(sys.argv) > 1 else folder + "/frame.svg", "w", encoding="utf-8") as file:
    file.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %g %g" width="%g" height="%g" '
               'font-family="sans-serif" fill="%s">\n<rect width="100%%" height="100%%" fill="#ffffff"/>\n%s\n</svg>\n'
               % (width, height, width, height, INK, "\n".join(out)))
