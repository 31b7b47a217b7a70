#!/usr/bin/env python3
"""tools/mutants.py: its list is of this tree. Each text is in its file once, the tests are of the suites that the list
says, docs/mutants.md tells of each mutant; and a list that is wrong is told of. To run the mutants takes long: see
CONTRIBUTING.md."""
import os
import sys

sys.dont_write_bytecode = True
SOURCE = os.environ["NOC_SOURCE"]
sys.path.insert(0, os.path.join(SOURCE, "tools"))
import mutants  # noqa: E402

LEAST = 24  # of mutants


def the_list_is_of_this_tree():
    tests = mutants.suites_of(os.environ["NOC_BUILD"])
    none = [m.name + ": none of its tests is here" for m in mutants.MUTANTS
            if not any(test in tests for test in m.quick) and "vulkan" not in m.name and "viewer" not in m.file]
    few = [] if len(mutants.MUTANTS) >= LEAST else [f"{len(mutants.MUTANTS)} mutants"]
    return [*mutants.faults(mutants.MUTANTS, SOURCE, tests), *none, *few]


def the_docs_tell_of_each():
    with open(os.path.join(SOURCE, "docs", "mutants.md"), encoding="utf-8") as file:
        told = [row.split("|")[1:3] for row in file if row.startswith("| ")]
    told = [(name.strip(), path.strip()) for name, path in told if name.strip() not in ("mutant", "---")]
    listed = [(m.name, m.file) for m in mutants.MUTANTS]
    return ([f"{name} ({path}): not in docs/mutants.md" for name, path in listed if (name, path) not in told] +
            [f"{name} ({path}): not in tools/mutant_list.py" for name, path in told if (name, path) not in listed])


def wrong_lists_are_told_of():
    good = mutants.MUTANTS[0]
    suites = {"quick": ["nocturne"], "slow": ["full"]}
    wrong = {
        "a text that is not there": ("has its text 0 times", [good._replace(text="no such line\n")]),
        "a text that is there often": ("times, not once", [good._replace(text=";")]),
        "a file that is not there": ("No such file", [good._replace(file="src/none.c")]),
        "one that changes nothing": ("changes nothing", [good._replace(replacement=good.text)]),
        "a name twice": ("two mutants have that name", [good, good]),
        "a full test among quick ones": ("slow is of the suite full", [good._replace(quick=["slow"], full=[])]),
        "a quick test among full ones": ("quick is not of the suite full", [good._replace(quick=[], full=["quick"])]),
    }
    return [f"{what}: {told}" for what, (text, listed) in wrong.items()
            for told in [list(mutants.faults(listed, SOURCE, suites))] if len(told) != 1 or text not in told[0]]


failed = 0
TESTS = the_list_is_of_this_tree, the_docs_tell_of_each, wrong_lists_are_told_of
for number, test in enumerate(TESTS):
    found = test()
    failed |= bool(found)
    print("%sok %d - %s" % ("not " if found else "", number + 1, test.__name__.replace("_", " ")))
    for line in found:
        print("# " + line)
print("1..%d" % len(TESTS))
sys.exit(failed)
