"""What tests do as a client: come in, wait for what is said, and run, each with the same program."""
import socket
import sys
import time

import tap
from wire import LIMIT, Picture, Program, joined

CITY = ("builtin:city", "--city-size", "150", "--threads", "2")


def enter(p, width=320, height=180):
    c = joined(p)
    c.say("hello", width=width, height=height)
    c.welcome = c.text_of("welcome")
    c.picture()
    return c


def said(c, t, wanted=lambda m: True, timeout=180):
    return c.wait_for(lambda m: isinstance(m, dict) and m["t"] == t and wanted(m), timeout)


def moves(c, count, **values):
    """Inputs, each when the one before is seen, until so many pictures are moving ones: a client or a program that
    stands still for a moment rests meanwhile. Returns the number of the last input."""
    seen, n, end = 0, 0, time.monotonic() + LIMIT
    while seen < count:
        assert time.monotonic() < end, "%d of %d pictures are moving" % (seen, n)
        n += 1
        c.say("input", n=n, **values)
        seen += c.wait_for(lambda m, n=n: isinstance(m, Picture) and m.input == n).moving
    return n


def all_see(clients, timeout=180):
    """Each of them gets a message for which its wanted(message) holds; all read meanwhile: who does not is dropped."""
    waiting, deadline = list(clients), time.monotonic() + timeout
    while waiting:
        assert time.monotonic() < deadline, "%d of %d do not see it" % (len(waiting), len(clients))
        for c, wanted in clients.items():
            try:
                c.wait_for(wanted if c in waiting else lambda m: False, timeout=0.1)
                waiting.remove(c)
            except socket.timeout:
                pass


def near(a, b, within=1e-3):
    return all(abs(x - y) < within for x, y in zip(a, b))


def run(module):
    """All tests of the module, with one program."""
    p = Program(*CITY, "--clients", "6")
    try:
        tap.run(tap.tests_of(module), p)
    finally:
        status, text = p.end()
        print("# ended with %s: %s" % (status, text[-2000:]))
        if status != 130 or "nothing was estimated" in text:
            sys.exit(1)
