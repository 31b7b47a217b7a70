"""Tests as functions whose names begin with test_, in their order; a line of TAP each."""
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


def tests_of(module):
    return [value for name, value in vars(module).items() if name.startswith("test_")]
