#!/usr/bin/env python3
"""turn-tests.py BUILD TIMED TURN [targets]: the tests of BUILD whose turn it is at the TURNth of several runs that
share the work. Tests that took under a second in the last run of the build folder TIMED are among them always. Of
longer ones every name has its turn, one in six, whatever else there is. Without that run all of them are. Where TIMED
is `-`, the quick suite is among them, and a third of the suite `full`. Never among them are those of fuzz/: `make fuzz`
runs their inputs under the sanitizers. With `targets`: what must be built for them."""
import json
import sys
import zlib

sys.dont_write_bytecode = True
from test_targets import introspect, is_full, targets_of  # noqa: E402

LONG = 1  # s
SHARE = 6
SHARE_OF_FULL = 3


def durations(timed):
    try:
        with open(timed + "/meson-logs/testlog.json", encoding="utf-8", errors="replace") as log:
            return {test["name"]: test["duration"] for test in map(json.loads, log)}
    except OSError:
        return {}


def has_turn(test, turn, share):
    return zlib.crc32(test["name"].encode()) % share == turn % share


def main():
    build, timed, turn = sys.argv[1], sys.argv[2], int(sys.argv[3])
    tests = [test for test in introspect(build, "tests") if not test["name"].startswith("fuzz-")]
    if timed == "-":
        tests = [test for test in tests if not is_full(test) or has_turn(test, turn, SHARE_OF_FULL)]
    else:
        seconds = durations(timed)
        tests = [test for test in tests if seconds.get(test["name"], 0) < LONG or has_turn(test, turn, SHARE)]
    if sys.argv[4:] == ["targets"]:
        print(*targets_of(build, tests))
    else:
        print(*(test["name"] for test in tests))


if __name__ == "__main__":
    main()
