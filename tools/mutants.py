#!/usr/bin/env python3
"""mutants.py [NAME...]: which tests notice wrong lines. Each mutant of tools/mutant_list.py is made of the last commit,
in a worktree of its own (build-mutants/), and its tests run until one fails: those of the quick suite, with its
samples, then those of the suite full. Prints a table (Markdown); the status is 1 where a mutant is alive. Mutants
compile without a warning: CI would refuse others without a test.

    --list    names them and what is wrong, and does nothing
    --check   looks only whether each text is in its file once, and is of this tree"""
import argparse
import json
import os
import subprocess
import sys
import time

sys.dont_write_bytecode = True
from mutant_list import MUTANTS  # noqa: E402
from test_targets import introspect, targets_of  # noqa: E402

TOOLS = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(TOOLS)
FOLDER = os.path.join(SOURCE, "build-mutants")
TREE = os.path.join(FOLDER, "tree")
BUILD = os.path.join(TREE, "build")


class DoesNotCompile(Exception):
    pass


def say(text):
    print(text, file=sys.stderr, flush=True)


def git(*args, folder=SOURCE):
    return subprocess.run(["git", "-C", folder, *args], check=True, text=True, stdout=subprocess.PIPE).stdout.strip()


def faults(mutants, source, tests=None):
    """What is wrong with the list itself. tests: {name: suites}, of a build folder."""
    for m in mutants:
        try:
            with open(os.path.join(source, m.file), encoding="utf-8") as file:
                count = file.read().count(m.text)
        except OSError as error:
            yield f"{m.name}: {m.file}: {error.strerror}"
            continue
        if count != 1:
            yield f"{m.name}: {m.file} has its text {count} times, not once: {m.text!r}"
        if m.text == m.replacement:
            yield f"{m.name}: changes nothing"
        for full, names in enumerate((m.quick, m.full)) if tests is not None else ():
            for name in names:
                if name in tests and ("full" in tests[name]) != bool(full):
                    yield f"{m.name}: {name} is {'not ' if full else ''}of the suite full"
    names = [m.name for m in mutants]
    yield from (f"{name}: two mutants have that name" for name in sorted(set(names)) if names.count(name) > 1)


def suites_of(build):
    """{test: its suites}"""
    return {test["name"]: [suite.split(":")[-1] for suite in test["suite"]]
            for test in introspect(build, "tests")}


def make_tree():
    """The last commit in a worktree, with a build folder."""
    changed = git("status", "--porcelain", "--untracked-files=no")
    if changed:
        sys.exit("mutants are made of the last commit, and this is not in it:\n" + changed)
    commit = git("rev-parse", "HEAD")
    git("worktree", "prune")
    if os.path.isdir(TREE):
        git("checkout", "--quiet", "--force", "--detach", commit, folder=TREE)
    else:
        git("worktree", "add", "--quiet", "--detach", TREE, commit)
    shared = os.path.join(FOLDER, "shared")
    if os.path.isdir(os.path.join(SOURCE, "..", "shared")) and not os.path.exists(shared):
        os.symlink(os.path.join(SOURCE, "..", "shared"), shared)
    if not os.path.exists(os.path.join(BUILD, "build.ninja")):
        subprocess.run(["meson", "setup", BUILD, TREE, "-Dtests=enabled", "-Dwerror=true"], check=True,
                       stdout=subprocess.DEVNULL)


def compiles(targets):
    return subprocess.run(["ninja", "--quiet", "-C", BUILD, *targets], stdout=sys.stderr).returncode == 0


def failing(test, full):
    """Runs a test of the build folder. Returns None if it passes, else which part of it fails."""
    environment = dict(os.environ)
    environment.pop("NOC_SUITE", None)
    if not full:
        environment["NOC_SUITE"] = "quick"
    log = os.path.join(BUILD, "meson-logs", "testlog.json")
    if os.path.exists(log):
        os.remove(log)
    done = subprocess.run(["meson", "test", "-C", BUILD, "--no-rebuild", "--quiet", test], env=environment,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    if done.returncode == 0:
        return None
    if not os.path.exists(log):
        sys.exit(f"{test} did not run:\n{done.stdout}")
    with open(log, encoding="utf-8", errors="replace") as lines:
        result = json.loads(lines.readline())
    for line in result.get("stdout", "").splitlines():
        if line.startswith("not ok") and "# SKIP" not in line:
            return line.split(" - ", 1)[-1]
    return result["result"].lower()


def without_mutant(tests):
    """Holds that they pass. What passed is kept for as long as the sources stay as they are."""
    kept = os.path.join(FOLDER, "passed")
    key = " ".join(git("rev-parse", *("HEAD:" + folder for folder in ("include", "src", "tests"))).split())
    passed = []
    if os.path.exists(kept):
        with open(kept, encoding="utf-8") as file:
            passed = file.read().split("\n")
    passed = passed if passed[:1] == [key] else [key]
    for test in tests:
        if test in passed:
            continue
        say(f"{test} without a mutant")
        part = failing(test, False)
        if part is not None:
            sys.exit(f"fails without any mutant: {test}: {part}")
        passed.append(test)
        with open(kept, "w", encoding="utf-8") as file:
            file.write("\n".join(passed))


def killed(mutant, known):
    """Applies a mutant, runs its tests. Returns (test, part of it, True if the quick suite has it), or None."""
    path = os.path.join(TREE, mutant.file)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace(mutant.text, mutant.replacement))
        for full, tests in enumerate((mutant.quick, mutant.full)):
            for test in (test for test in tests if test in known):
                if not compiles(targets_of(BUILD, [known[test]])):
                    raise DoesNotCompile
                part = failing(test, full)
                if part is not None:
                    return test, part, not full
        return None
    finally:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


def run(mutants):
    make_tree()
    wrong = list(faults(mutants, TREE, suites_of(BUILD)))
    if wrong:
        sys.exit("\n".join(wrong))
    known = {test["name"]: test for test in introspect(BUILD, "tests")}
    quick = sorted({test for m in mutants for test in m.quick if test in known})
    say(f"building {len(quick)} tests")
    if not compiles(targets_of(BUILD, [known[test] for test in quick])):
        sys.exit("the tree does not compile")
    without_mutant(quick)
    rows, alive = [], 0
    for m in mutants:
        since = time.monotonic()
        by, told = None, "ALIVE" if any(test in known for test in m.quick) else "none of its tests is here"
        try:
            by = killed(m, known)
        except DoesNotCompile:
            told = "does not compile"
        if by:
            told = f"{by[0]}: {by[1]}" + ("" if by[2] else " (full)")
        alive += by is None
        rows.append((m, by, f"| {m.name} | {m.file} | {m.wrong} | {told} | {time.monotonic() - since:.0f} |"))
        say(rows[-1][2])
    print("| mutant | file | what is wrong | killed by | s |\n| --- | --- | --- | --- | ---: |")
    print(*(row[2] for row in rows), sep="\n")
    quick_kills = sum(1 for row in rows if row[1] and row[1][2])
    print(f"\n{len(rows)} mutants: the quick suite kills {quick_kills}, the full one {len(rows) - alive}.")
    return alive > 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    unknown = [name for name in args.names if name not in [m.name for m in MUTANTS]]
    if unknown:
        sys.exit("no mutant is named " + ", ".join(unknown) + ": see --list")
    mutants = [m for m in MUTANTS if not args.names or m.name in args.names]
    if args.list:
        for m in mutants:
            print(f"{m.name:20} {m.file}: {m.wrong}")
        return 0
    if args.check:
        wrong = list(faults(mutants, SOURCE))
        print(*wrong, sep="\n", end="\n" if wrong else "")
        return bool(wrong)
    return run(mutants)


if __name__ == "__main__":
    sys.exit(main())
