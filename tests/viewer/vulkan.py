"""`nocturne view` on a Vulkan device: pictures at rest and in motion, numbers, picking, walking, edits, and panes whose
methods the backend refuses."""
import os
import re
import subprocess
import sys

import hand
import tap
from hand import enter, said
from wire import Picture, Program


def test_rest_motion_and_numbers(p):
    c = enter(p, 64, 36)
    assert c.welcome["device"].startswith("vulkan, "), c.welcome["device"]
    c.say("set", name="frames", value="2")
    rest = c.wait_for(lambda m: isinstance(m, Picture) and m.codec == 1 and m.frames >= 2)
    assert (rest.width, rest.height) == (64, 36) and not rest.moving
    hand.moves(c, 3, seconds=0.03, turn=[0.02, 0], keys=["forward"])  # smoothed
    for mode in "depth", "object", "influential":
        c.say("set", name="show", value=mode)
        said(c, "state", lambda m: m["panes"][0]["values"]["show"] == mode)
        c.wait_for(lambda m: isinstance(m, Picture) and m.flags & 4)
    c.close()


def test_picking_and_walking(p):
    c = enter(p, 64, 36)
    c.say("ask", what="pixel", id=1, pane=0, x=0.5, y=0.9)
    answer = said(c, "answer", lambda m: m["id"] == 1 and m["done"] >= 1)
    assert answer["lux"] > 0 and answer["class"], answer
    c.say("navigate", mode="walk")
    eye = said(c, "stats")["camera"]["eye"]
    for n in range(1, 6):
        c.say("input", n=n, seconds=0.2, turn=[0, 0], keys=["forward"])
    c.wait_for(lambda m: isinstance(m, Picture) and m.input == 5)
    figures = said(c, "stats", lambda m: m["camera"]["eye"] != eye)
    assert figures["camera"]["eye"][2] < 30, figures["camera"]
    c.close()


def test_edits(p):
    c = enter(p, 64, 36)
    c.say("world", name="group.lamps", value="0.5,2200K")
    said(c, "state", lambda m: m["world"]["values"]["group.lamps"] == "0.5,2200K")
    c.picture()
    c.say("save", id=1, what="png", pane=0)
    saved = c.wait_for(lambda m: isinstance(m, Picture) and m.kind == 2)
    assert b"backend\0vulkan" in saved.body and b"lamps=0.5,2200K" in saved.body, saved.body[:400]
    c.close()


def test_all_methods(p):
    """A pane that the backend refuses says why; the others have their pictures, and the session goes on."""
    c = enter(p, 48, 27)
    c.say("set", name="frames", value="1")
    c.say("layout", name="methods")
    panes = said(c, "state", lambda m: m["layout"] == "methods")["panes"]
    seen, refused = set(), set()
    while len(seen) + len(refused) < len(panes):
        m = c.wait_for(lambda m: isinstance(m, Picture) and not m.moving or isinstance(m, dict) and m["t"] == "note")
        if isinstance(m, Picture):
            seen.add(m.pane)
        else:
            assert m["level"] == "error" and "on this backend yet" in m["text"], m
            refused.add(m["text"])
    assert len(seen) >= 5, (seen, refused)
    c.say("layout", name="single")
    said(c, "state", lambda m: m["layout"] == "single")
    for method in "headlight", "is", "ris", "restir", "reference":
        c.say("set", name="method", value=method)
        said(c, "state", lambda m: m["panes"][0]["values"]["method"] == method)
        c.picture(pane=0)
    c.close()


def run():
    listed = subprocess.run([os.environ["NOC_PROGRAM"], "devices"], capture_output=True, text=True, check=True)
    if not re.search(r"^vulkan \d+ [a-z]+, [^:]*$", listed.stdout, re.M):
        print("1..0 # SKIP no Vulkan device traces rays here")
        return
    p = Program(*hand.CITY, "--backend", "vulkan")
    try:
        tap.run(tap.tests_of(sys.modules[__name__]), p)
    finally:
        status, text = p.end()
        print("# ended with %s: %s" % (status, text[-2000:]))
        if status != 130:
            sys.exit(1)


run()
