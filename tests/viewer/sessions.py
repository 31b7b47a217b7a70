"""What a client of `nocturne view` gets: moving and resting pictures, layouts, edits that two clients share; and how
the program begins and ends."""
import os
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import time

import hand
from hand import CITY, all_see, enter, near, said
from wire import LIMIT, TOKEN, Client, Picture, Program


def test_a_picture_shows_the_newest_input(p):
    c = enter(p)
    eye = said(c, "stats")["camera"]["target"]
    hand.moves(c, 3, turn=[0.01, 0])
    for n in range(100001, 100031):
        c.say("input", n=n, seconds=0.03, turn=[0.01, 0], keys=[])
    c.wait_for(lambda m: isinstance(m, Picture) and m.input == 100030)
    c.say("input", n=100031, seconds=0.03, turn=[0.2, 0])
    figures = said(c, "stats")
    c.wait_for(lambda m: isinstance(m, Picture) and m.input == 100031)
    assert not near(figures["camera"]["target"], eye, 1e-6)
    c.close()


def test_frames_are_dropped_not_queued(p):
    """While a picture is not acknowledged there is no other; then comes the newest."""
    c = enter(p)
    c.say("input", n=1, turn=[0.01, 0])
    first = c.wait_for(lambda m: isinstance(m, Picture) and m.input == 1, ack=False)
    for n in range(2, 40):
        c.say("input", n=n, turn=[0.01, 0])
        time.sleep(0.02)
    try:
        other = c.wait_for(lambda m: isinstance(m, Picture), timeout=1.5, ack=False)
        assert False, "picture %d came beside %d" % (other.number, first.number)
    except socket.timeout:
        pass
    c.say("ack", pane=0, n=first.number)
    late = []  # of 38 inputs: the picture held back, the one that was being rendered, the newest
    while not late or late[-1].input != 39:
        late.append(c.picture())
        assert len(late) <= 3, [x.input for x in late]
    c.close()


def test_rest_is_whole_exact_and_ends(p):
    c = enter(p, 320, 180)
    c.say("set", name="frames", value="12")
    c.say("input", n=1, turn=[0.01, 0])
    moving = c.wait_for(lambda m: isinstance(m, Picture) and m.input == 1)
    pictures = []
    while not pictures or pictures[-1].codec != 1 or pictures[-1].frames < 12:
        pictures.append(c.picture())
    last = pictures[-1]
    assert (last.width, last.height) == (320, 180) and last.frames >= 12 and not last.moving
    assert last.body[:8] == b"\x89PNG\r\n\x1a\n"
    errors = [x.error for x in pictures if x.error == x.error and x.width == 320]
    assert errors and 0 < errors[-1] < 1, errors
    try:
        c.picture(timeout=2)
        assert False, "a picture after the last one"
    except socket.timeout:
        pass
    p.rests()
    c.close()


def test_rest_without_a_mean(p):
    """Frames that are not accumulated have no variance, and come all the same."""
    c = enter(p, 160, 90)
    c.say("set", name="accumulate", value="off")
    said(c, "state", lambda m: m["panes"][0]["values"]["accumulate"] in ("off", "false"))
    for _ in range(3):
        picture = c.wait_for(lambda m: isinstance(m, dict) and m["t"] == "note" or
                             isinstance(m, Picture) and not m.moving and m.width == 160)
        assert isinstance(picture, Picture) and picture.frames == 1 and picture.error != picture.error, picture
    c.close()


def test_display_keeps_the_mean(p):
    """Exposure and modes show at once, and nothing begins anew."""
    c = enter(p, 320, 180)
    c.say("set", name="frames", value="12")
    c.wait_for(lambda m: isinstance(m, Picture) and m.codec == 1 and m.frames >= 12)
    c.say("set", name="exposure", value="2")
    again = c.picture()
    assert again.frames >= 12 and (again.width, again.height) == (320, 180), again.frames
    c.say("set", name="show", value="normal")
    mode = c.wait_for(lambda m: isinstance(m, Picture) and m.flags & 4)
    assert mode.frames >= 12, mode.frames
    c.say("set", name="method", value="is")
    c.wait_for(lambda m: isinstance(m, Picture) and m.frames < 12)
    c.close()


def test_a_picture_tells_what_it_was_made_with(p):
    """The first picture that shows a setting by its number is of that mode, method and world."""
    c = enter(p, 160, 90)
    made = {}

    def picture(n, pane=0):
        """What was told of the first picture of that pane which shows message n."""
        def wanted(m):
            if isinstance(m, dict) and m["t"] == "stats":
                made[m["pane"]] = m
            return isinstance(m, Picture) and m.kind == 1 and m.pane == pane and m.input >= n
        c.wait_for(wanted)
        return made[pane]

    steps = ("show", "illuminance"), ("method", "is"), ("show", "picture"), ("method", "headlight"), ("method", "ris")
    set_to = {"show": "picture", "method": "ris"}
    for n, (name, value) in enumerate(steps, 1):
        set_to[name] = value
        c.say("set", n=n, name=name, value=value)
        state = said(c, "state", lambda m: m["input"] >= n)
        assert state["panes"][0]["values"][name] == value and not state["panes"][0]["failed"]
        told = picture(n)
        assert {name: told[name] for name in set_to} == set_to, (told, set_to)
    c.say("set", n=10, name="show", value="no-such")  # what is refused is numbered, too, and a picture comes
    state = said(c, "state", lambda m: m["input"] == 10)
    assert picture(10)["show"] == state["panes"][0]["values"]["show"] == "picture"
    was = made[0]["world"]
    c.say("world", n=11, name="group.lamps", value="0.5,2200K")
    version = said(c, "state", lambda m: m["input"] == 11)["world"]["version"]
    assert version > was
    while made[0]["world"] < version:
        assert made[0]["world"] >= was
        picture(11)
    c.say("world", n=12, name="group.lamps", value="on,own")
    c.say("layout", n=13, name="difference")
    version = said(c, "state", lambda m: m["input"] == 13 and len(m["panes"]) == 3)["world"]["version"]
    while picture(13, 2)["world"] < version:
        pass
    assert "show" not in made[2] and "method" not in made[2], made[2]
    assert (made[1]["show"], made[1]["method"]) == ("picture", "reference"), made[1]
    c.close()


def test_a_pane_that_was_not_looked_at_catches_up(p):
    """A client that is slow to show one pane's picture gets what was set meanwhile once it has."""
    c = enter(p, 160, 90)
    c.say("set", name="frames", value="2")
    c.say("layout", n=1, name="divider")
    kept = {}

    def keeps(m):
        """Acknowledges pictures of pane 0, and none of pane 1 that is of the layout."""
        if isinstance(m, Picture) and m.kind == 1:
            if m.pane and m.input:
                kept[m.pane] = m.number
            else:
                c.say("ack", pane=m.pane, n=m.number)
        return isinstance(m, Picture) and m.kind == 1 and m.pane == 0

    while 1 not in kept:
        c.wait_for(keeps, ack=False)
    since = time.monotonic()
    while time.monotonic() < since + 6:  # 5 s later nobody looks at it
        try:
            c.wait_for(keeps, ack=False, timeout=since + 6 - time.monotonic())
        except socket.timeout:
            pass
    c.say("set", n=2, pane=-1, name="show", value="depth")
    c.wait_for(lambda m: keeps(m) and m.input == 2 and not m.moving, ack=False)
    try:  # until it rests
        while True:
            c.wait_for(keeps, ack=False, timeout=1)
    except socket.timeout:
        pass
    c.say("ack", pane=1, n=kept[1])
    told = {}

    def wanted(m):
        if isinstance(m, dict) and m["t"] == "stats":
            told[m["pane"]] = m["show"]
        return isinstance(m, Picture) and m.pane == 1 and m.input == 2

    c.wait_for(wanted)
    assert told[1] == "depth", told
    c.close()


def test_layouts(p):
    c = enter(p, 160, 90)
    for name, panes in ("divider", 2), ("methods", 6), ("difference", 3), ("single", 1):
        c.say("layout", name=name)
        state = said(c, "state", lambda m: m["layout"] == name)
        assert len(state["panes"]) == panes
        seen = set()
        while len(seen) < panes:
            seen.add(c.picture().pane)
        assert seen == set(range(panes))
        if name == "difference":
            figures = said(c, "stats", lambda m: m["pane"] == 2)
            assert figures["rmse"] > 0 and 0.2 < figures["bias"] < 5, figures
            legend = figures["legend"]
            assert legend["low"] == -legend["high"] < 0 and len(legend["colours"]) == 17, legend
            assert figures["frames"] >= 1, figures
    c.close()


def test_the_reference_is_never_smoothed(p):
    """Neither a pane of that method, nor one of that caption whatever its method, though its look has it."""
    c = enter(p, 48, 27)
    turns = 0

    def moving(panes):
        """Flag `smoothed` of each pane's first moving picture that shows an input of now."""
        nonlocal turns
        found, before = {}, turns
        while not panes <= set(found):
            turns += 1
            c.say("input", n=turns, turn=[0.01, 0])
            picture = c.picture()
            if picture.moving and picture.input > before:
                found.setdefault(picture.pane, bool(picture.flags & 2))
        return found

    c.say("layout", name="difference")
    panes = said(c, "state", lambda m: m["layout"] == "difference")["panes"]
    assert [one["caption"] for one in panes] == ["this", "reference", "difference"], panes
    assert panes[1]["values"]["smooth"] == "true" and "reference" in panes[1]["idle"]["smooth"], panes[1]
    assert moving({0, 1, 2}) == {0: True, 1: False, 2: False}
    c.say("set", pane=1, name="method", value="ris")
    said(c, "state", lambda m: m["panes"][1]["values"]["method"] == "ris")
    assert moving({0, 1, 2}) == {0: True, 1: False, 2: False}
    c.say("layout", name="methods")
    said(c, "state", lambda m: m["layout"] == "methods")
    c.say("set", pane=-1, name="smooth", value="on")
    said(c, "state", lambda m: all(one["values"]["smooth"] == "true" for one in m["panes"]))
    assert moving({0})[0] is False
    c.say("layout", name="single")
    said(c, "state", lambda m: m["layout"] == "single")
    c.say("set", name="method", value="reference")
    state = said(c, "state", lambda m: m["panes"][0]["values"]["method"] == "reference")
    assert "reference" in state["panes"][0]["idle"]["smooth"], state["panes"][0]["idle"]
    assert moving({0}) == {0: False}
    c.close()


def test_a_picture_that_moves_is_as_bright(p):
    c = enter(p, 960, 540)
    c.say("set", name="frames", value="8")
    c.wait_for(lambda m: isinstance(m, Picture) and m.codec == 1 and m.frames >= 8)
    for _ in range(2): # a picture later exposure has followed
        c.say("set", name="tonemap", value="reinhard")
        time.sleep(0.5)
        c.say("set", name="tonemap", value="filmic")
        rest = said(c, "stats")["ev100"]
        c.picture()
    moving, n, end = [], 0, time.monotonic() + LIMIT
    while len(moving) < 8 and time.monotonic() < end:
        n += 1
        c.say("input", n=n, turn=[0.0005, 0])
        figures = said(c, "stats")
        picture = c.picture()
        moving += [figures["ev100"]] if picture.moving else []
    assert len(moving) == 8 and all(abs(ev - rest) < 0.15 for ev in moving), (rest, moving)
    c.close()


def test_a_mode_that_changes_in_mid_frame(p):
    """What only shows otherwise breaks a frame off, at times one of another size, which leaves no picture."""
    c = enter(p, 1280, 720)
    c.say("set", name="show", value="illuminance")
    said(c, "state", lambda m: m["panes"][0]["values"]["show"] == "illuminance")
    for n in range(1, 5):
        c.say("input", n=n, turn=[0.01, 0])
        c.wait_for(lambda m: isinstance(m, Picture) and m.input == n and not m.moving and m.width < 1280)
        time.sleep(0.02) # the next one is larger, and on its way
        c.say("set", name="isolines", value=("5,7.5,10,20", "0")[n % 2])
        again = c.wait_for(lambda m: isinstance(m, Picture) or isinstance(m, dict) and m["t"] == "note")
        assert isinstance(again, Picture), again
    figures = said(c, "stats", lambda m: m.get("legend") and m["legend"]["isolines"] == [5, 7.5, 10, 20])
    assert figures["legend"]["low"] <= 5 and figures["legend"]["high"] >= 20, figures["legend"]
    c.say("set", name="isolines", value="20,10")
    assert "isolines" in said(c, "note")["text"]
    c.close()


def test_panes_have_one_bar(p):
    c = enter(p, 320, 180)
    c.say("layout", name="divider")
    c.say("set", pane=-1, name="show", value="illuminance")
    c.say("set", pane=1, name="method", value="is")
    said(c, "state", lambda m: m["panes"][1]["values"]["method"] == "is")
    ends = {0: [], 1: []}
    while min(map(len, ends.values())) < 6:
        figures = said(c, "stats", lambda m: m.get("legend"))
        ends[figures["pane"]].append((figures["legend"]["low"], figures["legend"]["high"]))
    assert ends[0][-1] == ends[1][-1] and len(set(ends[0][4:])) == 1, ends
    c.close()


def test_the_command_has_the_range_that_was_found(p):
    c = enter(p, 160, 90)
    c.say("set", name="show", value="illuminance")
    last = {"stats": None, "state": None}

    def agree(m):  # they come in any order, and the range may become wider
        if isinstance(m, dict) and m["t"] == "stats" and m.get("legend"):
            last["stats"] = [m["legend"]["low"], m["legend"]["high"]]
        elif isinstance(m, dict) and m["t"] == "state" and "--show-range" in m["command"]:
            command = m["command"].split()
            last["state"] = [float(end) for end in command[command.index("--show-range") + 1].split(",")]
        return last["state"] and last["state"] == last["stats"]

    c.wait_for(agree)
    c.say("set", name="show", value="picture")
    said(c, "state", lambda m: "--show" not in m["command"])
    c.close()


def test_a_mode_to_open_with(p):
    q = Program(*CITY, "--show", "illuminance", "--show-range", "1,50", "--isolines", "5,10")
    c = Client(q)
    c.say("hello", width=160, height=90)
    state = c.text_of("welcome")["state"]
    values = state["panes"][0]["values"]
    assert [values[name] for name in ("show", "show-range", "isolines")] == ["illuminance", "1,50", "5,10"], values
    assert "--show illuminance --show-range 1,50 --isolines 5,10" in state["command"], state["command"]
    legend = said(c, "stats", lambda m: m.get("legend"))["legend"]
    assert (legend["low"], legend["high"], legend["isolines"]) == (1, 50, [5, 10]), legend
    c.close()
    q.end()
    assert run("builtin:single", "--show", "class", "--isolines", "5", "--port", "0")[0] == 2


def test_help_tells_what_it_begins_with(p):
    c = enter(p, 160, 90)
    look = {row["name"]: row for row in c.welcome["schema"]["look"]}
    text = subprocess.run([os.environ["NOC_PROGRAM"], "help", "--markdown"], capture_output=True, text=True,
                          check=True).stdout
    section = text.split("\n## nocturne view ")[1].split("\n## ")[0]
    compared = set()
    for line in section.splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        name = cells[1].strip("`").split()[0].lstrip("-").replace("[no-]", "") if len(cells) > 4 else ""
        if name in look and look[name]["kind"] in ("int", "real", "choice", "bool") and cells[3]:
            told = {"on": "true", "off": "false"}.get(cells[3], cells[3])
            assert told == look[name]["value"], (name, told, look[name]["value"])
            compared.add(name)
    assert {"method", "preset", "history", "show", "draws"} <= compared and len(compared) > 30, compared
    c.close()


def test_what_cannot_be_set_is_told(p):
    c = enter(p)
    for values in ({"name": "method", "value": "magic"}, {"name": "no-such", "value": "1"},
                   {"name": "draws", "value": "0"}, {"name": "environment", "value": "/etc/passwd"},
                   {"name": "method", "value": "ris", "pane": 5}):
        c.say("set", **values)
        note = said(c, "note")
        assert note["level"] == "error" and note["text"], note
    for values in {"name": "no-such", "value": "1"}, {"name": "group.none", "value": "off"}:
        c.say("world", **values)
        assert said(c, "note")["level"] == "error"
    c.say("camera", name="nowhere")
    assert said(c, "note")["level"] == "error"
    c.say("set", name="method", value="restir")
    c.picture()
    c.close()


def test_cameras_by_name_do_not_starve(p):
    """They come as fast as they may, among other things; pictures go on, and the newest is what is seen."""
    c = enter(p)
    seen, n, start = 0, 0, time.monotonic()
    while seen < 6 and time.monotonic() - start < LIMIT:
        n += 1
        c.say("camera", name=("street", "overview", "aerial")[n % 3], n=n)
        c.say("navigate", mode="fly")
        try:
            seen += isinstance(c.wait_for(lambda m: isinstance(m, Picture), timeout=0.01), Picture)
        except socket.timeout:
            pass
    assert seen == 6, seen
    c.wait_for(lambda m: isinstance(m, Picture) and m.input == n)
    c.close()


def test_each_client_has_its_own_camera(p):
    a, b = enter(p), enter(p)
    a.say("camera", eye=[1, 2, 30], target=[4, 5, 6], fov=40, n=1)
    said(a, "stats", lambda m: near(m["camera"]["eye"], [1, 2, 30]) and m["camera"]["fov"] == 40)
    b.say("input", n=1, turn=[0.01, 0])
    assert not near(said(b, "stats")["camera"]["eye"], [1, 2, 30])
    a.say("set", name="method", value="is")
    assert said(a, "state")["panes"][0]["values"].get("method", "is") == "is"
    b.say("set", name="draws", value="7")
    assert said(b, "state")["panes"][0]["values"].get("method", "ris") != "is"
    a.close()
    b.close()


def test_edits_are_shared(p):
    a, b = enter(p), enter(p)
    a.say("set", name="frames", value="12")
    b.say("set", name="frames", value="12")
    def rests(m):
        return isinstance(m, Picture) and m.codec == 1 and m.frames >= 12

    all_see({a: rests, b: rests})
    a.say("world", name="group.lamps", value="0.5,2200K")

    def begins_anew():
        told = []

        def wanted(m):
            if isinstance(m, dict):
                told.extend(["0.5,2200K"] if m["t"] == "state" and
                            m["world"]["values"]["group.lamps"] == "0.5,2200K" else [])
                return False
            return told and m.frames < 12

        return wanted

    all_see({a: begins_anew(), b: begins_anew()})
    c = enter(p)
    assert c.welcome["state"]["world"]["values"]["group.lamps"] == "0.5,2200K"
    a.say("world", name="group.lamps", value="on,own")
    for c in a, b, c:
        c.close()


def test_many_come_and_go(p):
    """Connections that end in all states leave nothing behind."""
    time.sleep(1)
    before = p.threads()
    for i in range(40):
        c = Client(p)
        if c.status == 101 and i % 4:
            c.say("hello", width=200, height=100)
            c.say("layout", name=("single", "divider", "methods", "difference")[i // 4 % 4])
            c.say("ask", id=1, what="pixel", pane=0, x=0.5, y=0.5)
            if i % 4 > 1:
                time.sleep(0.1)
        c.close()
    deadline = time.monotonic() + 240
    while p.threads() > before and time.monotonic() < deadline:
        time.sleep(0.1)
    assert p.threads() <= before, "%d threads are left of %d" % (p.threads(), before)
    enter(p).close()


# ---- how it begins and ends

def run(*arguments, timeout=LIMIT):
    done = subprocess.run([os.environ["NOC_PROGRAM"], "view", *arguments], capture_output=True, text=True,
                          timeout=timeout, check=False)
    return done.returncode, done.stderr, done.stdout


def test_ports_and_addresses_that_cannot_be(p):
    for arguments, status, text in ((("--port", str(p.port)), 1, "--port 0 takes one"),
                                    (("--port", "70000"), 2, "--port"),
                                    (("--address", "256.1.1.1"), 1, "no address of this machine"),
                                    (("--address", "8.8.8.8"), 1, "cannot listen at 8.8.8.8"),
                                    (("--address", ""), 2, "--address"), (("--token", "short"), 2, "--token"),
                                    (("--token", "0123456789abcdef/../"), 2, "--token"),
                                    (("--clients", "0"), 2, "--clients")):
        got = run("builtin:single", *arguments)
        assert got[0] == status and text in got[1] and len(got[1].splitlines()) <= 2, (arguments, got)


def test_a_token_from_a_file(p):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "token")
        for text, status, said in (("short\n", 2, "--token-file: 16 to 128"), ("", 2, "--token-file: 16 to 128"),
                                   ("a" * 129, 2, "--token-file: 16 to 128"), (None, 1, path)):
            if text is None:
                os.unlink(path)
            else:
                with open(path, "w", encoding="ascii") as file:
                    file.write(text)
            got = run("builtin:single", "--port", "0", "--token-file", path)
            assert got[0] == status and said in got[1], (text, got)
        got = run("builtin:single", "--port", "0", "--token-file", folder)
        assert got[0] == 1 and "Is a directory" in got[1], got
        got = run("builtin:single", "--token", TOKEN, "--token-file", path)
        assert got[0] == 2 and "exclude" in got[1], got
        with open(path, "w", encoding="ascii") as file:
            file.write("of-a-file-0123456789\n# and more\n")
        view = subprocess.Popen([os.environ["NOC_PROGRAM"], "view", "builtin:single", "--port", "0", "--token-file",
                                 path],
                                stdout=subprocess.PIPE, text=True)
        link = view.stdout.readline().strip()
        view.terminate()
        view.wait()
        assert link.endswith("#token=of-a-file-0123456789"), link


def test_a_browser_is_given_no_secret_in_its_arguments(p):
    """The page that it is given leads to the link, is of this user alone, and goes with the program."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "xdg-open"), "w", encoding="ascii") as file:
            file.write('#!/bin/sh\nprintf "%s\\n" "$@" > "$HERE/part"; mv "$HERE/part" "$HERE/arguments"\n')
        os.chmod(os.path.join(folder, "xdg-open"), 0o755)
        environment = dict(os.environ, HERE=folder, XDG_RUNTIME_DIR=folder, PATH=folder + ":" + os.environ["PATH"])
        view = subprocess.Popen([os.environ["NOC_PROGRAM"], "view", "builtin:single", "--port", "0", "--open"],
                                stdout=subprocess.PIPE, text=True, env=environment)
        link = view.stdout.readline().strip()
        end = time.monotonic() + LIMIT
        while not os.path.exists(os.path.join(folder, "arguments")) and time.monotonic() < end:
            time.sleep(0.05)
        with open(os.path.join(folder, "arguments"), encoding="ascii") as file:
            arguments = file.read().splitlines()
        assert len(arguments) == 1 and arguments[0].startswith("file://" + folder + "/nocturne-"), arguments
        page = arguments[0][len("file://"):]
        assert os.stat(page).st_mode & 0o777 == 0o600, oct(os.stat(page).st_mode)
        with open(page, encoding="ascii") as file:
            assert link in file.read() and "#token=" in link, link
        view.terminate()
        view.wait()
        assert not os.path.exists(page), page
        # ended while a city of 5 km is built, for some seconds, which it does not wait for
        os.unlink(os.path.join(folder, "arguments"))
        view = subprocess.Popen([os.environ["NOC_PROGRAM"], "view", "builtin:city", "--city-size", "5000", "--port",
                                 "0", "--open"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                env=environment)
        view.stdout.readline()
        view.terminate()
        said_last = view.communicate()[1]
        assert view.returncode == 143 and "interrupted" in said_last, (view.returncode, said_last)
        assert not [name for name in os.listdir(folder) if name.startswith("nocturne-")], os.listdir(folder)


def test_a_link_that_nobody_gets(p):
    """It ends where the link cannot be written: nobody could come."""
    for end in ">/dev/full", ">&-":
        got = subprocess.run(["sh", "-c", 'exec "$0" view builtin:single --port 0 ' + end, os.environ["NOC_PROGRAM"]],
                             stderr=subprocess.PIPE, text=True, timeout=LIMIT, check=False)
        assert got.returncode == 1 and "standard output" in got.stderr, (end, got)


def test_inputs_that_cannot_be(p):
    got = run("nowhere.gml", "--port", "0")
    assert got[0] == 1 and got[1].count("nowhere.gml") == 1 and not got[2], got # no link, either
    assert run("builtin:nothing", "--port", "0")[0] in (1, 2)


def test_an_interruption_ends_it(p):
    for number, status in (signal.SIGINT, 130), (signal.SIGTERM, 143):
        q = Program(*CITY)
        clients = [enter(q, 640, 360) for _ in range(2)]
        clients[0].say("layout", name="methods")
        clients[1].say("ask", id=1, what="region", pane=0, rect=[0, 0, 1, 1])
        ended, text = q.end(number)
        assert ended == status, (ended, text)
        assert not text.strip(), text


def test_an_interruption_is_before_what_waits(p):
    """The processor time after it is not that of the cameras that wait."""
    def go(i):
        c.say("camera", name=("street", "overview")[i % 2])
    q = Program(*CITY)
    c = enter(q)
    before = q.cpu()
    for i in range(20):
        go(i)
        said(c, "state")
    each = (q.cpu() - before) / 20
    for i in range(600):
        go(i)
    said(c, "state")
    os.kill(q.pid, signal.SIGSTOP) # its time is read, and nothing is done until the signal is there
    others, used = resource.getrusage(resource.RUSAGE_CHILDREN), q.cpu()
    os.kill(q.pid, signal.SIGINT)
    ended, text = q.end(signal.SIGCONT)
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    after = now.ru_utime + now.ru_stime - others.ru_utime - others.ru_stime - used
    assert ended == 130, (ended, text)
    assert after < 100 * each, (after, each)


def test_an_interruption_while_it_loads(p):
    q = Program("builtin:city", "--city-size", "5000")
    c = Client(q)
    c.say("hello", width=320, height=180)
    assert said(c, "loading")["done"] >= 0
    ended, text = q.end()
    assert ended == 130, (ended, text)


def test_views_are_told_once(p):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "city.yaml")
        open(path, "w").write("nocturne: 1\ninputs: [builtin:single]\n"
                              "cameras: { street: { view: street }, a: { view: own } }\n")
        q = Program(path)
        c = enter(q, 64, 36)
        assert c.welcome["cameras"] == ["street", "a", "own", "aerial", "overview"], c.welcome["cameras"]
        c.close()
        q.end()


def file_of(c, what, **values):
    c.say("save", id=77, what=what, **values)
    message = c.wait_for(lambda m: isinstance(m, Picture) and m.kind == 2 or
                         isinstance(m, dict) and m["t"] == "note" and m["level"] == "error")
    assert isinstance(message, Picture), message
    assert message.number == 77 and (message.frames > 0) == (what in ("png", "exr")), message.frames
    return message.body[:message.name_size].decode(), message.body[message.name_size:]


def test_files(p):
    """Pictures with the metadata of render, and a recipe and a command line that render the view."""
    c = enter(p)
    c.say("set", name="seed", value="5")
    c.say("world", name="group.lamps", value="0.5,2200K")
    said(c, "state", lambda m: m["world"]["values"]["group.lamps"] == "0.5,2200K")
    c.say("input", n=1, turn=[0.1, 0]) # what is moving is saved whole, too
    name, png = file_of(c, "png", pane=0)
    assert int.from_bytes(png[16:20], "big") == 320 and int.from_bytes(png[20:24], "big") == 180
    assert name == "night.png" and png.startswith(b"\x89PNG")
    for text in (b"group\0lamps=0.5,2200K", b"seed\0" + b"5", b"camera-eye\0", b"method\0", b"scene-lights\0"):
        assert text in png, text
    name, exr = file_of(c, "exr", pane=0)
    assert name == "night.exr" and exr.startswith(b"\x76\x2f\x31\x01") and b"auto-ev100" in exr
    cameras = [dict(name="a", eye=[0, 0, 20], target=[9, 9, 0], fov=50),
               dict(name="b", eye=[5, 0, 20], target=[9, 9, 0], fov=50)]
    name, recipe = file_of(c, "recipe", cameras=cameras)
    assert name == "view.yaml" and b"lamps=0.5,2200K" in recipe and b"bookmarks" in recipe, recipe
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, name)
        open(path, "wb").write(recipe)
        subprocess.run([os.environ["NOC_PROGRAM"], "render", path, "--size", "32x18", "--frames", "1", "-q", "-o",
                        os.path.join(folder, "a.png")], check=True)
        assert os.path.getsize(os.path.join(folder, "a.png")) > 100
    for what in (dict(what="png", pane=4), dict(what="csv", of=12345)):
        c.say("save", id=78, **what)
        said(c, "note", lambda m: m["level"] == "error")
    c.say("world", name="group.lamps", value="on,own")
    c.close()


def test_tokens_differ(p):
    links = set()
    for _ in range(2):
        q = subprocess.Popen([os.environ["NOC_PROGRAM"], "view", "builtin:single", "--port", "0"], text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        links.add(q.stdout.readline().strip().split("token=")[1])
        q.terminate()
        q.communicate()
    assert len(links) == 2 and all(len(token) == 32 for token in links), links


hand.run(sys.modules[__name__])
