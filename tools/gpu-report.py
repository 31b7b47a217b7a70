#!/usr/bin/env python3
"""What gpu-report.sh packs and writes.

gpu-report.py --tests SOURCE BUILD PACK: copies the test programs that use a Vulkan device, and lists them in tests.txt
gpu-report.py --specs SOURCE PACK: copies the specs of frame times and of cars, with the scenes that are in the pack
gpu-report.py --sized SPECS WIDTHxHEIGHT: those specs in that size, NAME-sized.json
gpu-report.py WORK OUT: the page OUT/DEVICE.md of what a run left in WORK, with its figures beside it"""
import csv
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys

# Tests that use a device, by name.
DEVICE_TESTS = re.compile(r"vulkan|dialect|list_frame")
# Chips whose rays are computed by the shader cores: what they take says nothing of cards that have cores for it.
WITHOUT_RAY_CORES = re.compile(r"\b(GH200|GB200|[AHB][12368]00|H20|A30|[PV]100|MI\d{2,3}[AX]?|GTX 1\d{3}|"
                               r"TITAN (V|Xp?))\b", re.I)
# Frames of a setup in the table of windows, and runs of one in that of cars.
FRAMES, CAR_RUNS = 7, 3
# Frames at the start of a run that are no part of its median: the first makes pipelines, the second those of reuse.
FIRST_FRAMES = 2
FIRST = "first frame, ms by the clock"
SPECS = {"frame-times": "hlavova-frame-times", "cars": "hlavova-cars"}
# Hlavova 2025, tables 6.2 and 6.3, Prague, ms on an RTX 3060 at 1920x1080: lamps, and lamps and windows.
THESIS = {"SRIS #1": (6.94, 7.30), "SRIS #5": (7.09, 11.63), "SRIS #10": (7.19, 16.95), "SRIS #20": (7.19, 27.03),
          "SRIS #30": (7.30, 33.33), "SRIS #40": (7.69, 47.61), "temporal": (8.13, 47.61), "ReSTIR": (10.10, 47.61),
          "unbiased": (11.76, 47.61)}


def pack_tests(source, build, pack):
    tests = json.loads(subprocess.run(["meson", "introspect", "--tests", build], check=True, capture_output=True,
                                      text=True).stdout)
    os.makedirs(pack + "/build/tests", exist_ok=True)
    with open(pack + "/tests.txt", "w", encoding="utf-8") as out:
        for test in sorted(tests, key=lambda t: t["name"]):
            program = test["cmd"][0]
            inside = os.path.realpath(program).startswith(os.path.realpath(build) + os.sep)
            if not DEVICE_TESTS.search(test["name"]) or not inside or not os.access(program, os.X_OK):
                continue
            shutil.copy2(program, pack + "/build/tests/")
            words = ["@PACK@/build/tests/" + os.path.basename(program)]
            for word in test["cmd"][1:]:
                kept = os.path.relpath(word, build) if word.startswith(build) else None
                if kept:
                    os.makedirs(os.path.dirname(os.path.join(pack, "build", kept)), exist_ok=True)
                    shutil.copy2(word, os.path.join(pack, "build", kept))
                words.append("@PACK@/build/" + kept if kept else word)
            out.write(" ".join([test["name"]] + words) + "\n")
    for folder, _, files in os.walk(build):  # shaders that test programs read from the build folder
        for name in files:
            if name.endswith(".spv") and os.sep + "tests" in folder[len(build):]:
                to = os.path.join(pack, "build", os.path.relpath(folder, build))
                os.makedirs(to, exist_ok=True)
                shutil.copy2(os.path.join(folder, name), to)


def pack_specs(source, pack):
    for name, file in SPECS.items():
        spec = json.load(open("%s/experiments/%s.json" % (source, file), encoding="utf-8"))
        scenes = [s for s in spec["scenes"] if s["inputs"] == ["builtin:city"]]
        cities = {"lamps": "Rotterdam, lamps", "windows": "Rotterdam, lamps and windows",
                  "lit": "Rotterdam, all windows lit"}
        for city, title in cities.items():
            if name == "frame-times" and os.path.exists("%s/specs/%s.noct" % (pack, city)):
                scenes.append({"name": title, "inputs": [city + ".noct"]})
        spec["scenes"] = scenes
        json.dump(spec, open("%s/specs/%s.json" % (pack, name), "w", encoding="utf-8"), indent=1)


def size_specs(specs, size):
    """Times are what is wanted: a reference of one cheap frame. A moving camera has rows of its last frame alone, so
    cars get repetitions, of whose last frames a median can be told."""
    width, height = map(int, size.split("x"))
    for name in SPECS:
        spec = json.load(open("%s/%s.json" % (specs, name), encoding="utf-8"))
        spec.update({"size": size, "repetitions": CAR_RUNS if name == "cars" else 1, "shown": [],
                     "reference": {"method": "ris", "candidates": "uniform", "frames": 1}})
        if name == "frame-times":
            spec["frames"] = FRAMES
        spec.pop("crop", None)
        spec.pop("light-view", None)
        json.dump(spec, open("%s/%s-sized.json" % (specs, name), "w", encoding="utf-8"), indent=1)


def read(path, otherwise=""):
    try:
        return open(path, encoding="utf-8", errors="replace").read().strip()
    except OSError:
        return otherwise


def read_json(path):
    try:
        return json.load(open(path, encoding="utf-8"))
    except (OSError, ValueError):
        return None


def table(head, rows):
    """Markdown: the first column to the left, others to the right."""
    lines = ["| " + " | ".join(head) + " |", "|" + "|".join(["---"] + ["--:"] * (len(head) - 1)) + "|"]
    return "\n".join(lines + ["| " + " | ".join(r) + " |" for r in rows]) + "\n"


def number(v, digits=3):
    return "-" if v is None else "%.0f" % v if abs(v) >= 100 else "%.*g" % (digits, v)


def ratio(a, b):
    return a / b if a and b else None


class Run:
    """What a run of gpu-report.sh left in its work folder."""

    def __init__(self, work):
        self.work = work
        self.number, self.kind, self.size = (read(work + "/chosen").split("\n") + ["", "", ""])[:3]
        self.steps = [line.split() for line in read(work + "/steps.txt").splitlines()]
        line = re.search(r"^vulkan *%s .*$" % re.escape(self.number or "0"), read(work + "/devices.out"), re.M)
        name = re.sub(r"^vulkan *\d+ \w+, ", "", line[0]) if line else "no device"
        self.name, self.driver = name.rsplit(", ", 1) if ", " in name else (name, "")
        self.software = self.kind == "software"
        # On a processor that others use CPU time is the figure; a GPU's is by the clock.
        self.seconds = "cpu_s" if self.software else "wall_s"

    def has_ray_cores(self):
        return not self.software and not WITHOUT_RAY_CORES.search(self.name)

    def took(self):
        seconds, *stopped = (read(self.work + "/took") or "?").split()
        return ("**the run was stopped by a signal after %s s**" if stopped else "the whole run took %s s") % seconds

    def status(self, name):
        return next((s[1] for s in self.steps if s[0] == name), None)

    def why(self, name):
        """Why a step has no figures; "": it has."""
        status = self.status(name)
        if status == "0":
            return ""
        if status in (None, "-"):
            return "no time was left"
        if status in ("124", "137"):
            return "it was stopped at its limit"
        if status == "stopped":
            return "the run was stopped"
        said = [l for l in read("%s/%s.err" % (self.work, name)).splitlines() if l.startswith("nocturne:")]
        return said[-1].removeprefix("nocturne: ") if said else "it ended with status " + status


def head(run):
    lines = ["# " + run.name, ""]
    facts = ["Vulkan device: " + run.name + (", " + run.driver if run.driver else "") + ", " + (run.kind or "unknown")]
    if read(run.work + "/smi.out"):
        facts.append("nvidia-smi: " + read(run.work + "/smi.out").replace("\n", "; "))
    facts += ["Commit: " + read(run.work + "/commit", "unknown"),
              "Pictures: %s px; %s" % (run.size, run.took())]
    lines += ["- " + f for f in facts] + [""]
    if run.software:
        lines += ["**This is software on a processor, no GPU.** Its figures show that the report works. They say "
                  "nothing of a GPU: compare none of them with a card's. Times are CPU time, of all threads.", ""]
    elif not run.has_ray_cores():
        lines += ["**This chip has no ray-tracing cores**: its driver traces rays by the shader cores. So its "
                  "milliseconds and its trace floor say nothing of a card that has such cores, as the thesis's RTX "
                  "3060. What carries over is what passes do between rays, and quotients of frames that send equal "
                  "rays.", ""]
    lines += ["Made by `make gpu-report` (`tools/gpu-report.sh`). Times are medians, by the clock unless said "
              "otherwise. First frames, which make pipelines and fill caches, are in columns of their own and no part "
              "of a median. The thesis is Hlavová 2025 ([hlavova.md](../hlavova.md)), measured on an RTX 3060.", ""]
    return "\n".join(lines)


def tests(run):
    spec = importlib.util.spec_from_file_location("count", os.path.join(os.path.dirname(__file__), "count-tests.py"))
    count = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(count)
    rows, told = [], []
    for name, status, took in run.steps:
        if not name.startswith("test-"):
            continue
        results, planned = count.read_tap(read("%s/%s.out" % (run.work, name)))
        states = [state for _, state, _ in results]
        if status == "-":
            why = "left out: no time was left"
        elif status in ("124", "137"):
            why = "stopped at its limit"
        elif status == "stopped":
            why = "stopped with the run"
        elif planned and planned > len(results):
            why = "ended before its end, status " + status
        else:
            why = "" if results else "no results, status " + status
        rows.append([name[5:]] + [str(states.count(s)) for s in ("passed", "failed", "skipped")] + [took, why])
        told += ["- %s: %s %s%s" % (state, name[5:], test, " (%s)" % reason if reason else "")
                 for test, state, reason in results if state != "passed"]
    if not rows:
        return "## Tests\n\nNone were run.\n"
    return ("## Tests\n\nThe suite on this device, with its own tolerances.\n\n" +
            table(["Program", "passed", "failed", "skipped", "s", ""], rows) +
            ("\n" + "\n".join(told) + "\n" if told else ""))


def without(run, step, title, bench=None):
    """A table without rows: the step was left out or failed, or it left out all of them."""
    left = (bench or {}).get("left_out") or [{"why": "its file is not whole"}]
    return "## %s\n\nNot measured: %s.\n" % (title, run.why(step) or left[0]["why"])


def left_out(bench, table_name):
    """Rows of a table of bench that had no time or memory."""
    left = ["%s (%s)" % (l["what"], l.get("why", "")) for l in bench.get("left_out", []) if l["table"] == table_name]
    return "\nLeft out: %s.\n" % "; ".join(left) if left else ""


def unfinished(run, step):
    """A table that has rows of a step that did not end by itself."""
    return "\nNot whole: %s.\n" % run.why(step) if run.why(step) else ""


def floor(run):
    title = "Frame over trace floor"
    bench = read_json(run.work + "/floor.json")
    rows = bench and bench["tables"].get("floor")
    if not rows:
        return without(run, "floor", title, bench)
    out = []
    for r in rows:
        seconds, floor_seconds = r.get(run.seconds), r.get("floor_" + run.seconds)
        rays = r.get("rays_shadow", 0) + r.get("rays_primary", 0)
        out.append(["%s, %s" % (r["name"], r["view"]), number(1e3 * seconds), number(ratio(seconds, floor_seconds)),
                    number(ratio(rays, floor_seconds) and 1e-6 * rays / floor_seconds), str(r["frames"]),
                    number(1e3 * r["first_wall_s"])])
    text = ("## %s\n\n`builtin:city`, %s triangles, %s lights. The floor traces the frame's rays and does nothing "
            "else.\n\n" % (title, "{:,}".format(bench["scene"]["triangles"]), "{:,}".format(bench["scene"]["lights"])))
    text += table(["Method, view", "ms a frame", "over its floor", "million rays a second in the floor", "frames",
                   FIRST], out)
    return text + left_out(bench, "floor") + unfinished(run, "floor")


def passes(run):
    bench = read_json(run.work + "/floor.json")
    rows = bench and bench["tables"].get("floor")
    if not rows:
        return without(run, "floor", "Milliseconds a pass", bench)
    found = []
    for r in rows:
        for p in r.get("passes", []):
            if p["pass"] not in found:
                found.append(p["pass"])
    street = [r for r in rows if r["view"] == "street"]
    of = {r["name"]: {p["pass"]: p["thread_s"] for p in r.get("passes", [])} for r in street}
    text = ("## Milliseconds a pass\n\n%s, street, of the frames of the first table. A pass that a method does not "
            "have has none.\n\n" % ("Thread time" if run.software else "Timestamps of the device"))
    return text + table(["Pass"] + [r["name"] for r in street],
                        [[p] + [number(1e3 * of[r["name"]][p]) if p in of[r["name"]] else "" for r in street]
                         for p in found])


def growth(run):
    bench = read_json(run.work + "/growth.json")
    lights = bench and bench["tables"].get("lights")
    windows = bench and bench["tables"].get("windows")
    title = "More lights at equal rays"
    text = "## %s\n\n" % title
    if lights:
        first, out = lights[0], []
        for r in lights:
            grown, rays = ratio(r[run.seconds], first[run.seconds]), ratio(r["floor_" + run.seconds],
                                                                           first["floor_" + run.seconds])
            out.append([r["name"], number(1e3 * r[run.seconds]), number(grown), number(rays),
                        number(ratio(grown, rays)), number(1e3 * r["first_wall_s"])])
        text += ("`builtin:mess`, `%s`. Lights have shapes, so that rays take longer with more of them: the column "
                 "*at equal rays* has that divided out.\n\n" % bench["method"])
        text += table(["Lights", "ms a frame", "over the first", "of its floor", "at equal rays", FIRST], out)
        text += left_out(bench, "lights") + unfinished(run, "growth")
    else:
        text = without(run, "growth", title, bench)
    if windows and len(windows) > 1:
        text += ("\nWindows on over windows off in `builtin:city`, `%s`: %s, the floor %s.\n" %
                 (bench["method"], number(ratio(windows[1][run.seconds], windows[0][run.seconds])),
                  number(ratio(windows[1]["floor_" + run.seconds], windows[0]["floor_" + run.seconds]))))
    return text


def rows_of(run, name):
    """Rows of an experiment: {(scene, configuration): [row of each frame]}, in their order."""
    out = {}
    try:
        with open("%s/%s/results.csv" % (run.work, name), newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                out.setdefault((row["scene"], row["configuration"]), []).append(row)
    except OSError:
        pass
    return out


def median(values):
    values = sorted(values)
    n = len(values)
    return 0.5 * (values[(n - 1) // 2] + values[n // 2]) if n else None


def names(rows, at):
    return list(dict.fromkeys(key[at] for key in rows))


def windows(run):
    title = "Windows over lamps"
    rows = rows_of(run, "frame-times")
    if not rows:
        return without(run, "frame-times", title)
    times = {key: median([float(r[run.seconds]) for r in frames if int(r["frame"]) > FIRST_FRAMES])
             for key, frames in rows.items()}
    first = {key: float(r["wall_s"]) for key, frames in rows.items() for r in frames if int(r["frame"]) == 1}
    scenes, configs = names(rows, 0), names(rows, 1)
    places = list(dict.fromkeys(s.rsplit(", ", 1)[0] for s in scenes))
    text = ("## %s\n\nTables 6.2 and 6.3 of the thesis (spec hlavova-frame-times): ms a frame with lamps alone, and in "
            "brackets how many times as long with the windows that are lit at 21 h, and with all of them lit. Medians "
            "of frames %d to %d; first frames are those of the three. Prague is the thesis's own, by its RTX 3060.\n\n"
            % (title, FIRST_FRAMES + 1, FRAMES))
    out = []
    for c in configs:
        line = [c]
        for place in places:
            keys = [("%s, %s" % (place, k), c) for k in ("lamps", "lamps and windows", "all windows lit")]
            cells = [times.get(k) for k in keys]
            line.append("%s (%s, %s)" % (number(cells[0] and 1e3 * cells[0]), number(ratio(cells[1], cells[0])),
                                         number(ratio(cells[2], cells[0]))))
            line.append(" / ".join(number(1e3 * first[k] if k in first else None) for k in keys))
        thesis = THESIS.get(c)
        out.append(line + ["%s (%.2g)" % (number(thesis[0]), thesis[1] / thesis[0]) if thesis else ""])
    heads = [h for place in places for h in (place, "first frames, ms")]
    return text + table(["Setup"] + heads + ["Prague, thesis"], out) + unfinished(run, "frame-times")


def cars(run):
    title = "Cars"
    rows = rows_of(run, "cars")
    if not rows:
        return without(run, "cars", title)
    total = run.seconds.replace("_s", "_total_s")
    frames = max(int(r["frame"]) for runs in rows.values() for r in runs)
    times = {key: median([float(r[run.seconds]) for r in runs]) for key, runs in rows.items()}
    # What a run took beyond as many of its last frames: pipelines are made and caches filled in several.
    starts = {key: float(runs[0][total]) - frames * times[key] for key, runs in rows.items()}
    scenes, configs = names(rows, 0), names(rows, 1)
    place = scenes[0].rsplit(", ", 1)[0]
    out = []
    for c in configs:
        keys = [("%s, %s" % (place, k), c) for k in ("no cars", "cars at rest", "cars driving")]
        cells = [times.get(k) for k in keys]
        out.append([c, number(cells[0] and 1e3 * cells[0]), number(ratio(cells[1], cells[0])),
                    number(ratio(cells[2], cells[1])),
                    " / ".join(number(1e3 * starts[k] if k in starts else None) for k in keys)])
    return ("## %s\n\nSpec hlavova-cars, %s: frame %d, the median of %d runs. Cars that drive have what rays are "
            "traced in built anew each frame; the thesis loses some 3 frames a second by that. The last column is what "
            "the first run took beyond %d such frames: its first frames.\n\n" %
            (title, place, frames, CAR_RUNS, frames) +
            table(["Setup", "ms a frame without cars", "at rest over none", "driving over at rest",
                   "first frames, ms more"], out) + unfinished(run, "cars"))


def processor(run):
    bench = read_json(run.work + "/cpu.json")
    rows = bench and bench["tables"].get("floor")
    if not rows:
        return without(run, "cpu", "The processor beside it", bench)
    return ("## The processor beside it\n\n%s, %d cores, the same frames by the CPU backend, by the clock.\n\n" %
            (bench["processor"], bench["cores"]) +
            table(["Method, view", "ms a frame", "over its floor", FIRST],
                  [["%s, %s" % (r["name"], r["view"]), number(1e3 * r["wall_s"]),
                    number(ratio(r["wall_s"], r["floor_wall_s"])), number(1e3 * r["first_wall_s"])] for r in rows]) +
            left_out(bench, "floor"))


def page(work, out):
    run = Run(work)
    parts = [head(run), tests(run), floor(run), windows(run), growth(run), cars(run), passes(run),
             processor(run)]
    slug = re.sub(r"[^a-z0-9]+", "-", run.name.lower()).strip("-") or "none"
    path = "%s/%s.md" % (out, slug)
    with open(path + ".new", "w", encoding="utf-8") as file:  # a signal never leaves half a page
        file.write("\n".join(parts))
    os.replace(path + ".new", path)
    log = open(out + "/log.txt", "w", encoding="utf-8")
    for name in sorted(os.listdir(work)):
        if name.endswith((".out", ".err", ".txt", ".json")):
            log.write("==> %s\n%s\n" % (name, read(work + "/" + name)))
    for name in SPECS:
        results = "%s/%s/results.csv" % (work, name)
        if os.path.exists(results):
            shutil.copy(results, "%s/%s.csv" % (out, name))
    print(path)


def main(words):
    if words[:1] == ["--tests"]:
        pack_tests(*words[1:4])
    elif words[:1] == ["--specs"]:
        pack_specs(*words[1:3])
    elif words[:1] == ["--sized"]:
        size_specs(*words[1:3])
    else:
        page(*words[:2])


if __name__ == "__main__":
    main(sys.argv[1:])
