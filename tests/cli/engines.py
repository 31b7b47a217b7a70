#!/usr/bin/env python3
"""The commands of docs/many-machines.md, as they stand there.

engines.py FILE HEADING [N]: prints the N-th block (from 1) below that heading.
engines.py FILE job INDEX: prints, for a shell, what a pod of that index of the Kubernetes job runs."""
import re
import shlex
import sys

text = open(sys.argv[1], encoding="utf-8").read()


def block(heading, number):
    part = re.search(r"^## " + re.escape(heading) + r"$(.*?)(?=^## |\Z)", text, re.M | re.S).group(1)
    return re.findall(r"^```\w+\n(.*?)^```$", part, re.M | re.S)[number - 1]


if sys.argv[2] == "job":
    job = block("Kubernetes", 1)
    assert re.search(r"^  completionMode: Indexed$", job, re.M)
    completions = int(re.search(r"^  completions: (\d+)$", job, re.M).group(1))
    words = re.search(r"^ +command: \[(.*)\]$", job, re.M).group(1).split(", ")
    if int(sys.argv[3]) < completions:
        print("JOB_COMPLETION_INDEX=" + sys.argv[3], shlex.join(words))
else:
    print(block(sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 1), end="")
