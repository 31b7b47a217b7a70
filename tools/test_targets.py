#!/usr/bin/env python3
"""test_targets.py BUILD [NAME...]: what ninja must build for these tests of BUILD; without names for all but those of
Meson's suite `full`. Fails where a name is no test's."""
import json
import os
import sys


def introspect(build, what):
    """What Meson wrote of the build folder when it was last configured: "tests", "targets"."""
    with open(f"{build}/meson-info/intro-{what}.json", encoding="utf-8") as file:
        return json.load(file)


def is_full(test):
    return "full" in (suite.split(":")[-1] for suite in test["suite"])


def targets_of(build, tests):
    files = {target["id"]: target["filename"] for target in introspect(build, "targets")}
    wanted = {name for test in tests for target in test["depends"] for name in files.get(target, [])}
    return sorted(os.path.relpath(name, build) for name in wanted)


def main():
    build, names = sys.argv[1], sys.argv[2:]
    tests = introspect(build, "tests")
    unknown = [name for name in names if name not in [test["name"] for test in tests]]
    if unknown:
        sys.exit("no test is named " + ", ".join(unknown))
    print(*targets_of(build, [test for test in tests if (test["name"] in names if names else not is_full(test))]))


if __name__ == "__main__":
    main()
