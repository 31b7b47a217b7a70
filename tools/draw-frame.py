#!/usr/bin/env python3
"""Draws docs/frame-*.svg: the passes of a frame in their order, and what each reads and writes, as render/plan.c says.

draw-frame.py [BUILD [FOLDER]]     default: build and docs beside this script's folder"""
import json, os, subprocess, sys
from xml.sax.saxutils import escape

LIVES = [("on", "#e9f3e6", "kept for the next frame"), ("frame", "#fbf1dc", "of this frame"),
         ("tile", "#f3e6f0", "of a tile, in a thread's scratch")]
LEFT, TOP, COLUMN, ROW, HEAD = 236, 70, 98, 30, 22
INK, READ, WRITE = "#222222", "#2f6db3", "#c0551a"


def text(x, y, s, size=13, anchor="start", style=""):
    return '<text x="%g" y="%g" font-size="%g" text-anchor="%s" stroke="none" %s>%s</text>' % (
        x, y, size, anchor, style, escape(s))


def line(x1, y1, x2, y2, thick):
    return '<path d="M%g %gL%g %g" stroke="%s" stroke-width="%g"/>' % (x1, y1, x2, y2, INK, thick)


def box(x, y, w, h, colour):
    return '<rect x="%g" y="%g" width="%g" height="%g" stroke="none" fill="%s"/>' % (x, y, w, h, colour)


def mark(x, y, reads, writes, others):
    """A blue circle: read, with a ring where other pixels are read too. An orange square: written."""
    r, out = 8, []
    if others:
        out.append('<circle cx="%g" cy="%g" r="%g" fill="none" stroke="%s" stroke-width="2"/>' % (x, y, r + 4, READ))
    if reads and writes:
        out.append('<path d="M%g %ga%g %g 0 0 1 0 %gz" stroke="none" fill="%s"/>' % (x, y + r, r, r, -2 * r, READ))
        out.append(box(x, y - r, r, 2 * r, WRITE))
    elif reads:
        out.append('<circle cx="%g" cy="%g" r="%g" stroke="none" fill="%s"/>' % (x, y, r, READ))
    elif writes:
        out.append(box(x - r, y - r, 2 * r, 2 * r, WRITE))
    return out


def accumulate(index):
    """What follows the last stage (backend's accumulate), in the words of the table."""
    reads, writes = ("colour", "observations", "picture", "visibility cache"), ("picture", "visibility cache")
    return {"name": "accumulate", "rays": "", "reads": [index[b] for b in reads], "writes": [index[b] for b in writes],
            "others": []}


def draw(buffers, stages):
    index = {b["name"]: i for i, b in enumerate(buffers)}
    learns = any(index["observations"] in p["writes"] for stage in stages for p in stage)
    last = accumulate(index)
    if not learns:
        gone = (index["observations"], index["visibility cache"])
        last["reads"], last["writes"] = ([i for i in last[k] if i not in gone] for k in ("reads", "writes"))
    columns = [(n, p) for n, stage in enumerate(stages + [[last]]) for p in stage]
    used = {i for _, p in columns for i in p["reads"] + p["writes"]}
    groups = [(title, colour, [i for i, b in enumerate(buffers) if b["lives"] == lives and i in used])
              for lives, colour, title in LIVES]
    groups = [g for g in groups if g[2]]
    width = LEFT + COLUMN * len(columns) + 10
    bottom = TOP + sum(HEAD + ROW * len(rows) for _, _, rows in groups)
    out, y = [], TOP
    for title, colour, rows in groups:
        out += [box(8, y, width - 16, HEAD + ROW * len(rows), colour),
                text(14, y + 16, title, 12, style='font-weight="bold"')]
        y += HEAD
        for i in rows:
            b = buffers[i]
            size = "%d B a %s" % (b["bytes"], b["domain"]) if b["bytes"] else "a " + b["domain"]
            out += [text(24, y + ROW / 2 + 4, b["name"]), text(LEFT - 8, y + ROW / 2 + 4, size, 11, "end")]
            for k, (_, p) in enumerate(columns):
                out += mark(LEFT + COLUMN * (k + 0.5), y + ROW / 2, i in p["reads"], i in p["writes"], i in p["others"])
            y += ROW
    for k, (stage, p) in enumerate(columns):
        x, begins = LEFT + COLUMN * k, k == 0 or columns[k - 1][0] != stage
        if begins:
            title = "stage %d: tile by tile" % (stage + 1) if stage < len(stages) else "all pixels"
            out.append(text(x + 6, 20, title, 11, style='font-style="italic"'))
        words = p["name"].split(", ")
        for i, word in enumerate(words):
            out.append(text(x + COLUMN / 2, 56 - 16 * (len(words) - 1 - i), word, 13, "middle", 'font-weight="bold"'))
        out += [line(x, 8 if begins else 28, x, bottom + 30, 1.6 if begins else 0.4),
                text(x + COLUMN / 2, bottom + 20, p["rays"], 12, "middle")]
    out += [text(14, bottom + 20, "rays", 12, style='font-weight="bold"'), line(8, TOP, width - 8, TOP, 1.6),
            line(8, bottom, width - 8, bottom, 1.6)]
    x, y = 24, bottom + 58
    legend = ((1, 0, 0, "read at its own pixel or tile"), (1, 0, 1, "read at other pixels too"), (0, 1, 0, "written"),
              (1, 1, 0, "read and written"))
    for reads, writes, others, what in legend:
        out += mark(x, y, reads, writes, others) + [text(x + 18, y + 5, what, 12)]
        x += 56 + 6 * len(what)
    height = bottom + 84
    return ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %g %g" width="%g" height="%g" '
            'font-family="sans-serif" fill="%s">\n<rect width="100%%" height="100%%" fill="#ffffff"/>\n%s\n</svg>\n'
            % (width, height, width, height, INK, "\n".join(out)))


root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
build = sys.argv[1] if len(sys.argv) > 1 else os.path.join(root, "build")
folder = sys.argv[2] if len(sys.argv) > 2 else os.path.join(root, "docs")
plan = json.loads(subprocess.run([os.path.join(build, "tools", "plan_json")], check=True, capture_output=True).stdout)
for name, stages in plan["frames"].items():
    with open(os.path.join(folder, "frame-%s.svg" % name), "w", encoding="utf-8") as file:
        file.write(draw(plan["buffers"], stages))
