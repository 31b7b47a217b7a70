#!/usr/bin/env python3
"""rooms.py [COMMIT|FOLDER...]: lines of C a room, without blank lines and comments, a column for each commit or folder
of sources (without any: this one). Files of src/backend/ are told apart. They are algorithm, which every other
machine's backend would have to write again, unless MACHINE names them; the line "algorithm" is their sum."""
import os
import re
import subprocess
import sys

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
SOURCE = re.compile(r"(src|include)/.*\.(c|h|glsl|comp|rgen|rmiss|rchit)$")
# What is a machine's own, by the name of a file without _tmpl: rays and their structure, memory, lanes, how tiles are
# walked, and the tables and records that connect those.
MACHINE = set("""backend.c backend.h blocks.h cpu.h device.c devices.c embree.c embree.h frame.c kernel_tables.c
    kernels.h lanes.h lights.c many.c moved.c rays.c room.c rt.h scratch.c structure.c tracer.h view.c
    parts.c parts.h host.c memory.c pipelines.c readback.c records.h schedule.c schedule.h shaders.h
    floor.c volk.c vulkan.h world.c bridge.glsl payload.glsl pixel.glsl trace.glsl trace_closest.rchit
    trace_closest.rgen trace_closest.rmiss trace_occlusion.rchit trace_occlusion.rgen
    trace_occlusion.rmiss lists.c list_memory.h list_group.glsl list_tile.glsl list_pixel.glsl
    list_bridge.h learning.c blas.c mean.c pace.c record.c""".split())
NOT_CODE = re.compile(r'/\*.*?\*/|//[^\n]*|("(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\')', re.S)


def lines(text):
    """Lines that hold more than blanks and comments."""
    code = NOT_CODE.sub(lambda m: m.group(1) or "\n" * m.group(0).count("\n"), text)
    return sum(1 for line in code.split("\n") if line.strip())


def files_of_folder(folder):
    for base, _, names in os.walk(folder):
        for name in names:
            path = os.path.relpath(os.path.join(base, name), folder)
            if SOURCE.match(path):
                yield path, open(os.path.join(base, name), encoding="utf-8", errors="replace").read()


def files_of_commit(commit):
    git = lambda *a, **k: subprocess.run(["git", "-C", ROOT, *a], check=True, stdout=subprocess.PIPE, **k).stdout
    paths = [p for p in git("ls-tree", "-r", "-z", "--name-only", commit).decode().split("\0") if SOURCE.match(p)]
    out = git("cat-file", "--batch", input="".join("%s:%s\n" % (commit, p) for p in paths).encode())
    for path in paths:
        end = out.index(b"\n")
        size = int(out[:end].split()[2])
        yield path, out[end + 1:end + 1 + size].decode(errors="replace")
        out = out[end + size + 2:]


def rooms(files):
    """(room, file or ""): lines."""
    sums = {}
    for path, text in files:
        part = path.split("/")
        room = "include" if part[0] == "include" else "/".join(part[1:3 if part[1] == "backend" else 2])
        keys = [(room, "")] + [(room, path[len("src/" + room) + 1:])] * (part[1] == "backend")
        for key in keys:
            sums[key] = sums.get(key, 0) + lines(text)
    return sums


def is_algorithm(key):
    return key[1] != "" and re.sub(r"_tmpl(?=\.)", "", os.path.basename(key[1])) not in MACHINE


def column(what):
    return rooms(files_of_folder(what) if os.path.isdir(what) else files_of_commit(what))


def row(name, figures):
    print("%-40s" % name + "".join("%10s" % ("" if f is None else f) for f in figures))


try:
    columns = [column(a) for a in sys.argv[1:] or [ROOT]]
except subprocess.CalledProcessError:
    sys.exit("rooms.py: no such commit or folder")
row("room", [os.path.basename(a)[:9] for a in sys.argv[1:] or ["here"]])
for key in sorted(set().union(*columns)):
    name = "src/" * (key[0] != "include") + key[0] + "/"
    if key[1]:
        name = "    " + key[1] + " (machine)" * (not is_algorithm(key))
    row(name, [c.get(key) for c in columns])
row("all", [sum(n for key, n in c.items() if not key[1]) for c in columns])
row("algorithm, outside core/ and render/", [sum(n for key, n in c.items() if is_algorithm(key)) for c in columns])
