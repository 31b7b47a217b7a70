"""Tests as functions whose names begin with test_, in their order; a line of TAP each."""
import os
import sys
import time
import traceback


def run(functions, *values):
    print("1..%d" % len(functions))
    failed = 0
    for number, function in enumerate(functions, 1):
        start = time.monotonic()
        try:
            function(*values)
            wrong = ""
        except Exception:  # a test that fails, however it does
            wrong, failed = traceback.format_exc(), failed + 1
        print("%sok %d - %s" % ("not " if wrong else "", number, function.__name__[5:].replace("_", " ")))
        for line in wrong.splitlines() + ["%.1f s" % (time.monotonic() - start)]:
            print("# " + line)
        sys.stdout.flush()
    sys.exit(failed > 0)


def slow(function):
    """A test that the quick suite leaves out: it waits for what takes the program some ten seconds."""
    function.slow = True
    return function


def tests_of(module):
    quick = os.environ.get("NOC_SUITE") == "quick"
    return [value for name, value in vars(module).items()
            if name.startswith("test_") and not (quick and getattr(value, "slow", False))]
