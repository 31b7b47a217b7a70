#!/usr/bin/env python3
"""rooms.py [COMMIT|FOLDER...]: lines of C a room, without blank lines and comments, a column for each commit or folder
of sources (without any: this one). Files of src/backend/ are told apart: those that MACHINE names are a machine's own.
Of the others, functions that core calls by name are bridges: what core asks of any machine, as to load a light, or to
sum scores up over a work group. The rest is algorithm, which every other machine's backend would have to write again.
The last lines have the sums; "algorithm and bridges" is what "algorithm" was before bridges were told apart."""
import os
import re
import subprocess
import sys

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
SOURCE = re.compile(r"(src|include)/.*\.(c|h|glsl|comp|rgen|rmiss|rchit|rahit)$")
# What is a machine's own, by the name of a file without _tmpl: rays and their structure, memory, lanes, how tiles are
# walked, and the tables and records that connect those.
MACHINE = set("""backend.c backend.h blocks.h cpu.h device.c devices.c embree.c embree.h frame.c kernel_tables.c
    kernels.h lanes.h lights.c many.c moved.c rays.c room.c rt.h scratch.c structure.c tracer.h view.c
    parts.c parts.h host.c memory.c pipelines.c readback.c records.h schedule.c schedule.h shaders.h
    floor.c volk.c vulkan.h world.c bridge.glsl payload.glsl pixel.glsl trace.glsl trace_closest.rchit
    trace_closest.rgen trace_closest.rmiss trace_occlusion.rchit trace_occlusion.rgen
    trace_occlusion.rmiss lists.c list_memory.h list_group.glsl list_tile.glsl list_pixel.glsl
    list_bridge.h learning.c blas.c mean.c pace.c record.c vulkan/influence.c influence_memory.h tile.glsl compact.glsl
    nearest.glsl trace_meeting.rgen trace_meeting.rahit trace_through.rgen trace_through.rmiss trace_through.rchit
    trace_through.rahit through.c""".split())
NOT_CODE = re.compile(r'/\*.*?\*/|//[^\n]*|("(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\')', re.S)


FUNCTION = re.compile(r"^(?!(?:struct|enum|union|typedef|layout|shared)\b)[A-Za-z_][^;{}=#]*?\b(\w+)\([^;{}]*\)\s*\{",
                      re.M)


def code_of(text):
    """Without comments."""
    return NOT_CODE.sub(lambda m: m.group(1) or "\n" * m.group(0).count("\n"), text)


def lines(text):
    """Lines that hold more than blanks and comments."""
    return sum(1 for line in code_of(text).split("\n") if line.strip())


def functions(text):
    """(name, text) of each function that is defined."""
    code = code_of(text)
    for m in FUNCTION.finditer(code):
        depth, end = 1, m.end()
        while depth and end < len(code):
            depth += (code[end] == "{") - (code[end] == "}")
            end += 1
        yield m.group(1), code[m.start():end]


def asked_by_core(files):
    """Functions that core calls. In C those that it defines itself are not another's; a shader may define some of them
    for a work group in place of core's loops."""
    core = [text for path, text in files.items() if path.startswith("src/core/")]
    called = set(re.findall(r"\b(\w+)\(", "\n".join(code_of(text) for text in core)))
    return called, {name for text in core for name, _ in functions(text)}


def bridge_lines(path, text, called, defined):
    shader = "/shaders/" in path
    return sum(lines(body) for name, body in functions(text) if name in called and (shader or name not in defined))


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
    """(room, file or ""): lines. A third part of a key, "bridge": those of a file's bridges."""
    sums, files = {}, dict(files)
    called, defined = asked_by_core(files)
    for path, text in files.items():
        part = path.split("/")
        room = "include" if part[0] == "include" else "/".join(part[1:3 if part[1] == "backend" else 2])
        keys = [(room, "")] + [(room, path[len("src/" + room) + 1:])] * (part[1] == "backend")
        for key in keys:
            sums[key] = sums.get(key, 0) + lines(text)
        if len(keys) > 1 and is_algorithm(keys[1]):
            sums[keys[1] + ("bridge",)] = bridge_lines(path, text, called, defined)
    return sums


def is_algorithm(key):
    name = re.sub(r"_tmpl(?=\.)", "", os.path.basename(key[1]))
    return key[1] != "" and name not in MACHINE and os.path.basename(key[0]) + "/" + name not in MACHINE


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
    if len(key) == 3:
        name = "        of these, bridges"
    if len(key) == 2 or any(c.get(key) for c in columns):
        row(name, [c.get(key) for c in columns])
row("all", [sum(n for key, n in c.items() if not key[1]) for c in columns])
both = [sum(n for key, n in c.items() if len(key) == 2 and is_algorithm(key)) for c in columns]
bridges = [sum(n for key, n in c.items() if len(key) == 3) for c in columns]
row("algorithm and bridges", both)
row("bridges, that core calls by name", bridges)
row("algorithm, outside core/ and render/", [a - b for a, b in zip(both, bridges)])
