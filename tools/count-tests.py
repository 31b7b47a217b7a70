#!/usr/bin/env python3
"""count-tests.py BUILD: counts the single tests of the last `meson test` from its log, names those that failed or were
skipped, and ends with the line `N passed, N failed, N skipped`. Exit status 1 if any failed, or if there were none."""
import json
import re
import sys

RESULT = re.compile(r"^(not )?ok\b\s*(\d*)\s*(.*)$")
ASIDE = re.compile(r"^# ([\d.]+ s|(not )?ok - tests)$")  # times, and what cmocka says at the end
PLAN = re.compile(r"^1\.\.(\d+)")


def read_tap(text):
    """-> ([(name, state, reason)], planned): TAP as cmocka and the shell tests print it. Of a failure the reason is the
    last that is said of it."""
    tests, planned, why = [], None, ""
    for line in text.splitlines():
        plan, result = PLAN.match(line), RESULT.match(line)
        if plan:
            planned = int(plan.group(1))
        elif line.startswith("# skipped:"):  # tests/test.h says the reason on the line before
            why = line[len("# skipped:"):].strip()
        elif result:
            name, state, reason = result.group(3).strip(" -"), "failed" if result.group(1) else "passed", ""
            skip = re.search(r"#\s*SKIP\b\s*(.*)$", name, re.I)
            if skip:
                before = name[: skip.start()].strip(" -")
                # cmocka: "# SKIP name"; elsewhere: "name # SKIP reason"
                name, reason = (before, skip.group(1)) if before else (skip.group(1), why)
                state = "skipped"
            tests.append((name, state, reason))
            why = ""
        elif tests and tests[-1][1] == "failed" and line.startswith("# ") and not ASIDE.match(line):
            tests[-1] = (tests[-1][0], "failed", line[2:302].strip())
    return tests, planned


def main():
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    told = []
    with open(sys.argv[1] + "/meson-logs/testlog.json", encoding="utf-8", errors="replace") as log:
        for line in log:
            program = json.loads(line)
            outcome = program["result"]
            tests, planned = read_tap(program.get("stdout", ""))
            if not tests:  # no TAP: the program is one test
                state = {"OK": "passed", "EXPECTEDFAIL": "passed", "SKIP": "skipped"}.get(outcome, "failed")
                tests, planned = [("", state, outcome)], 1
            elif planned is None or planned > len(tests):  # died before the end: what it did not reach has failed
                tests += [("(not reached)", "failed", outcome)] * max(1, (planned or 0) - len(tests))
            elif outcome not in ("OK", "SKIP", "EXPECTEDFAIL") and not any(t[1] == "failed" for t in tests):
                tests.append(("(at the end)", "failed", outcome))  # a sanitizer's report, a bad exit status
            for name, state, reason in tests:
                counts[state] += 1
                if state != "passed":
                    told.append("%s: %s %s%s" % (state, program["name"], name, " (%s)" % reason if reason else ""))
    for line in sorted(told):
        print(line)
    print("%(passed)d passed, %(failed)d failed, %(skipped)d skipped" % counts)
    return 1 if counts["failed"] or not counts["passed"] else 0


if __name__ == "__main__":
    sys.exit(main())
