#!/usr/bin/env python3
"""coverage.py BUILD CORPUS: share of each room's lines that the tests run (BUILD was made by `make coverage`), and that
the fuzzers' inputs do: their seeds, and what they found in CORPUS where it is there. A line a room. What a process
counted is lost where it was killed."""
import glob, json, os, subprocess, sys

build, corpus = (os.path.abspath(a) for a in sys.argv[1:3])
root = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
tests = json.loads(subprocess.check_output(["meson", "introspect", "--tests", build]))


def profiles(kind):
    """Where processes count, four files a program, which they take turns to add to."""
    folder = os.path.join(build, "profiles", kind)
    os.makedirs(folder, exist_ok=True)
    for path in glob.glob(folder + "/*"):
        os.unlink(path)
    return folder, {**os.environ, "LLVM_PROFILE_FILE": folder + "/%4m.profraw"}


def rooms(folder):
    """Room: [lines that were run, lines]."""
    merged = folder + ".profdata"
    counted = [p for p in glob.glob(folder + "/*.profraw") if os.path.getsize(p)]
    subprocess.run(["llvm-profdata", "merge", "-sparse", "-failure-mode=all", "-o", merged, *counted], check=True,
                   stderr=subprocess.DEVNULL)
    objects = [os.path.join(build, name) for name in ("libnocturne.so", "nocturne", "nocturne-reader")]
    out = subprocess.run(["llvm-cov", "export", "-summary-only", "-instr-profile", merged, objects[0],
                          *("-object=" + o for o in objects[1:]),
                          os.path.join(root, "src")], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                         check=True).stdout
    sums = {}
    for f in json.loads(out)["data"][0]["files"]:
        path = os.path.relpath(f["filename"], root).split("/")
        if path[0] != "src": # system's headers
            continue
        room = sums.setdefault("/".join(path[:2]), [0, 0])
        room[0] += f["summary"]["lines"]["covered"]
        room[1] += f["summary"]["lines"]["count"]
    return sums


def replay(environment):
    """The programs of fuzz/, by their tests' commands."""
    for test in (t for t in tests if t["name"].startswith("fuzz-")):
        found = os.path.join(corpus, test["name"][5:])
        command = test["cmd"] + ([found] if os.path.isdir(found) and os.listdir(found) else [])
        if subprocess.call(command, env={**environment, **test["env"]}, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL):
            print("coverage: %s breaks something" % test["name"], file=sys.stderr)


folder, environment = profiles("fuzz")
replay(environment)
fuzzed = rooms(folder)
folder, environment = profiles("tests")
names = [t["name"] for t in tests if not t["name"].startswith("fuzz-")]
status = subprocess.call(["meson", "test", "-C", build, "--no-rebuild", "--quiet", "--timeout-multiplier", "4", *names],
                         env=environment, stdout=subprocess.DEVNULL)
tested = rooms(folder)
print("%-18s %7s %8s %8s" % ("room", "lines", "tests", "fuzzers"))
total = [0, 0, 0]
for room in sorted(tested):
    run, lines = tested[room]
    fuzz = fuzzed.get(room, [0, 0])[0]
    print("%-18s %7d %7.1f%% %7.1f%%" % (room, lines, 100 * run / max(lines, 1), 100 * fuzz / max(lines, 1)))
    total = [total[0] + lines, total[1] + run, total[2] + fuzz]
print("%-18s %7d %7.1f%% %7.1f%%" % ("all", total[0], 100 * total[1] / total[0], 100 * total[2] / total[0]))
if status:
    print("coverage: some tests failed (%s/meson-logs/testlog.txt)" % build, file=sys.stderr)
sys.exit(status != 0)
