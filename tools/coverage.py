#!/usr/bin/env python3
"""coverage.py BUILD CORPUS: share of each room's lines that the tests run (BUILD was made with -Db_coverage=true), and that the fuzzers'
inputs do: their seeds, and what they found in CORPUS where it is there. A line a room."""
import glob, json, os, subprocess, sys

build, corpus = (os.path.abspath(a) for a in sys.argv[1:3])
root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")


def forget():
    for path in glob.glob(build + "/**/*.gcda", recursive=True):
        os.unlink(path)


def rooms():
    """Room: [lines that were run, lines]."""
    out = subprocess.run(["gcovr", "--root", root, "--filter", os.path.abspath(root) + "/src/", "--object-directory", build, build, "--json-summary",
                          "--gcov-ignore-parse-errors"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout
    sums = {}
    for f in json.loads(out)["files"]:
        room = sums.setdefault("/".join(f["filename"].split("/")[:2]), [0, 0])
        room[0] += f["line_covered"]
        room[1] += f["line_total"]
    return sums


def replay():
    """The programs of fuzz/, by their tests' commands."""
    tests = json.loads(subprocess.check_output(["meson", "introspect", "--tests", build]))
    for test in (t for t in tests if t["name"].startswith("fuzz-")):
        found = os.path.join(corpus, test["name"][5:])
        command = test["cmd"] + ([found] if os.path.isdir(found) and os.listdir(found) else [])
        if subprocess.call(command, env={**os.environ, **test["env"]}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL):
            print("coverage: %s breaks something" % test["name"], file=sys.stderr)


forget()
replay()
fuzzed = rooms()
names = [t["name"] for t in json.loads(subprocess.check_output(["meson", "introspect", "--tests", build])) if not t["name"].startswith("fuzz-")]
forget()
status = subprocess.call(["meson", "test", "-C", build, "--no-rebuild", "--quiet", "--timeout-multiplier", "4", *names], stdout=subprocess.DEVNULL)
tested = rooms()
print("%-18s %7s %8s %8s" % ("room", "lines", "tests", "fuzzers"))
total = [0, 0, 0]
for room in sorted(tested):
    run, lines = tested[room]
    fuzz = fuzzed.get(room, [0, 0])[0]
    print("%-18s %7d %7.1f%% %7.1f%%" % (room, lines, 100 * run / max(lines, 1), 100 * fuzz / max(lines, 1)))
    total = [total[0] + lines, total[1] + run, total[2] + fuzz]
print("%-18s %7d %7.1f%% %7.1f%%" % ("all", total[0], 100 * total[1] / total[0], 100 * total[2] / total[0]))
sys.exit(status != 0)
