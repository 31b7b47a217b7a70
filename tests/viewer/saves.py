"""A picture that a client of `nocturne view` saves goes by way of a file: each call of the kernel on that file fails
once. The client then gets the whole picture or an error, no file is left, and the next picture is saved."""
import os
import signal
import stat
import struct
import sys
import tempfile
import zlib

import tap
from hand import enter
from wire import Picture, Program

SKIPPED = 77


def is_whole_png(data):
    """All chunks have their checksums, and the last one is IEND."""
    at, kind = 8, b""
    while data.startswith(b"\x89PNG\r\n\x1a\n") and at + 12 <= len(data):
        size = struct.unpack(">I", data[at:at + 4])[0]
        kind, body = data[at + 4:at + 8], data[at + 4:at + 8 + size]
        if data[at + 8 + size:at + 12 + size] != struct.pack(">I", zlib.crc32(body)):
            return False
        at += 12 + size
    return kind == b"IEND" and at == len(data)


def saved(c):
    """The bytes of the pane's picture, or the text of the error."""
    c.say("save", id=7, what="png", pane=0)
    m = c.wait_for(lambda m: isinstance(m, Picture) and m.kind == 2 or
                   isinstance(m, dict) and m["t"] == "note" and m["level"] == "error")
    return m.body[m.name_size:] if isinstance(m, Picture) else m["text"]


class Failing:
    """The program, of whose calls on files of `folder` the n-th fails."""

    def __init__(self, folder, n):
        self.report = os.path.join(os.path.dirname(folder), "report")
        script = os.path.join(os.path.dirname(folder), "failing")
        with open(script, "w", encoding="ascii") as f:
            f.write("#!/bin/sh\nTMPDIR=%s exec %s %s %d %s %s \"$@\"\n" %
                    (folder, os.environ["NOC_FAIL_CALL"], folder, n, self.report, os.environ["NOC_PROGRAM"]))
        os.chmod(script, stat.S_IRWXU)
        self.program = Program("builtin:single", "--threads", "1", program=script)

    def end(self):
        """The number of calls, and the one that failed."""
        with open("/proc/%d/task/%d/children" % (self.program.pid, self.program.pid), encoding="ascii") as f:
            os.kill(int(f.read().split()[0]), signal.SIGINT)
        self.program.process.communicate(timeout=180)
        with open(self.report, encoding="ascii") as f:
            lines = f.read().splitlines()
        return int(lines[-1]), lines[0]


def save_twice(folder, n):
    """What two pictures are while the n-th call fails, and what Failing.end returns."""
    p = Failing(folder, n)
    c = enter(p.program, 64, 36)
    both = saved(c), saved(c)
    left = os.listdir(folder)
    c.close()
    assert not left, left
    return both, p.end()


def test_each_call_fails_once(folder):
    both, (calls, _) = save_twice(folder, 0)
    assert all(is_whole_png(data) for data in both), both
    assert calls >= 2 * 4, calls # made, written, flushed, renamed and read, of two pictures
    errors = 0
    for n in range(1, calls // 2 + 1):
        (first, second), (_, failed) = save_twice(folder, n)
        if isinstance(first, str):
            errors += 1
            assert folder in first, (failed, first) # what it could not do, and where
        else:
            assert is_whole_png(first), failed
        assert is_whole_png(second), failed
    assert errors >= 4, errors


def run():
    environment = "ASAN_OPTIONS"
    os.environ[environment] = os.environ.get(environment, "") + ":detect_leaks=0" # not possible while it is traced
    with tempfile.TemporaryDirectory() as base:
        folder = os.path.join(os.path.realpath(base), "in")
        os.mkdir(folder)
        status = os.spawnl(os.P_WAIT, os.environ["NOC_FAIL_CALL"], "fail_call", folder, "0",
                           os.path.join(base, "report"), "/bin/true")
        if status == SKIPPED:
            print("1..0 # SKIP no call can be made to fail on this machine")
            return
        tap.run(tap.tests_of(sys.modules[__name__]), folder)


run()
