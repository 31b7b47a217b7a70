#!/usr/bin/env python3
"""turn-tests.py BUILD TIMED TURN: the tests of BUILD whose turn it is at the TURNth of several runs that share the
work. Tests that took under 5 s in the last run of the build folder TIMED are among them always, of longer ones a
quarter. Without that run all of them are."""
import json
import subprocess
import sys

LONG = 5  # s
SHARE = 4


def main():
    build, timed, turn = sys.argv[1], sys.argv[2], int(sys.argv[3])
    listed = json.loads(subprocess.check_output(["meson", "introspect", "--tests", build]))
    seconds = {}
    try:
        with open(timed + "/meson-logs/testlog.json", encoding="utf-8", errors="replace") as log:
            for line in log:
                program = json.loads(line)
                seconds[program["name"]] = program["duration"]
    except OSError:
        pass
    names = [one["name"] for one in listed]
    slow = sorted((name for name in names if seconds.get(name, 0) > LONG), key=lambda name: -seconds[name])
    left_out = {name for i, name in enumerate(slow) if i % SHARE != turn % SHARE}
    print(*(name for name in names if name not in left_out))


if __name__ == "__main__":
    main()
