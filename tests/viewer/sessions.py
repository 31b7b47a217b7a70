"""What a client of `nocturne view` gets: moving and resting pictures, layouts, edits that two clients share, answers;
and how the program begins and ends."""
import json
import os
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

import tap
from wire import TOKEN, Client, Closed, Picture, Program

CITY = ("builtin:city", "--city-size", "150", "--threads", "2")


def enter(p, width=320, height=180):
    c = Client(p)
    assert c.status == 101, c.status
    c.say("hello", width=width, height=height)
    c.welcome = c.text_of("welcome")
    c.picture()
    return c


def said(c, t, wanted=lambda m: True, timeout=180):
    return c.wait_for(lambda m: isinstance(m, dict) and m["t"] == t and wanted(m), timeout)


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


def test_a_picture_shows_the_newest_input(p):
    c = enter(p)
    eye = said(c, "stats")["camera"]["target"]
    for n in range(1, 31):
        c.say("input", n=n, seconds=0.03, turn=[0.01, 0], keys=[])
    picture = c.wait_for(lambda m: isinstance(m, Picture) and m.input == 30)
    assert picture.moving
    c.say("input", n=31, seconds=0.03, turn=[0.2, 0])
    figures = said(c, "stats")
    picture = c.wait_for(lambda m: isinstance(m, Picture) and m.input == 31)
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
    held = c.wait_for(lambda m: isinstance(m, Picture), ack=False)
    assert held.input == 39, held.input
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
    before = p.cpu()
    time.sleep(2)
    assert p.cpu() - before < 0.1, "it renders at rest"
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
    moving = []
    for n in range(1, 13):
        c.say("input", n=n, turn=[0.0005, 0])
        figures = said(c, "stats")
        picture = c.picture()
        moving += [figures["ev100"]] if picture.moving else []
    assert len(moving) > 4 and all(abs(ev - rest) < 0.15 for ev in moving), (rest, moving)
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
    while seen < 6 and time.monotonic() - start < 90:
        n += 1
        c.say("camera", name=("street", "overview", "aerial")[n % 3], n=n)
        c.say("navigate", mode="fly")
        try:
            seen += isinstance(c.wait_for(lambda m: isinstance(m, Picture), timeout=0.01), Picture)
        except socket.timeout:
            pass
    assert seen == 6, seen
    c.wait_for(lambda m: isinstance(m, Picture) and m.input == n, timeout=20)
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


def ask(c, what, timeout=180, **values):
    c.say("ask", what=what, **values)
    while True:
        answer = said(c, "answer", lambda m: m["id"] == values["id"], timeout)
        if answer["done"] >= 1:
            return answer


def test_who_lights_this(p):
    c = enter(p)
    answer = ask(c, "pixel", id=1, pane=0, x=0.5, y=0.9)
    assert answer["lux"] > 0 and len(answer["place"]) == 3 and answer["class"], answer
    shares = [row["share"] for row in answer["rows"]]
    assert abs(sum(shares) - 1) < 0.02 and all(row["error"] >= 0 for row in answer["rows"]), sum(shares)
    named = [row["share"] for row in answer["rows"] if row["light"] >= 0]
    assert named == sorted(named, reverse=True) and len(named) > 1
    lamp = ask(c, "lamp", id=2, light=answer["rows"][0]["light"])
    assert near(lamp["place"], answer["rows"][0]["place"], 0.01) and lamp["lumens"] > 0
    assert lamp["group"] == "lamps" and 1800 < lamp["kelvin"] < 7000, lamp
    assert ask(c, "region", id=3, pane=0, rect=[0.4, 0.8, 0.6, 0.95])["lux"] > 0
    whole = ask(c, "region", id=6, pane=0, object=answer["object"])
    areas = [one["area"] for one in whole["classes"]]
    assert abs(sum(areas) / whole["area"] - 1) < 0.001 and areas == sorted(areas, reverse=True), whole
    mean = sum(one["area"] * one["lux"] for one in whole["classes"]) / sum(areas)
    assert abs(mean - whole["lux"]) < 6 * whole["lux_error"] + 0.05 * mean, (mean, whole)
    assert all(one["class"] and one["lux_error"] >= 0 for one in whole["classes"])
    assert "classes" not in answer
    c.say("save", id=9, what="csv", of=1)
    file = c.wait_for(lambda m: isinstance(m, Picture) and m.kind == 2)
    name, text = file.body[:file.name_size].decode(), file.body[file.name_size:].decode()
    lines = text.splitlines()
    assert file.number == 9 and name == "lights.csv" and lines[0].startswith("rank,name,kind,of,lux,"), lines[0]
    assert len(lines) == 1 + answer["emitters"] + 2, (len(lines), answer["emitters"])
    assert answer["emitters"] > len(named)
    assert '"sky"' in lines[-2] and '"all"' in lines[-1], lines[-2:]
    listed = [line.split(",") for line in lines[1:-2]]
    assert abs(sum(float(row[6]) for row in listed) + float(lines[-2].split(",")[6]) - 1) < 0.001
    c.say("save", id=10, what="csv", of=12345)
    assert said(c, "note")["level"] == "error"
    assert "refused" in ask(c, "lamp", id=4, light=999999999)
    c.say("ask", id=5, what="lights")
    lights = c.wait_for(lambda m: isinstance(m, Picture) and m.kind == 3)
    count = int.from_bytes(lights.body[4:8], "little")
    assert lights.number == 5 and count > 10 and len(lights.body) >= 8 + 24 * count
    at, record, sections = 0, {1: 24, 2: 16, 3: 12, 5: 1, 6: 12, 7: 1}, {}
    while at < len(lights.body):
        kind, count = struct.unpack_from("<II", lights.body, at)
        sections[kind] = lights.body[at + 8:at + 8 + record[kind] * count]
        at += 8 + record[kind] * count
    west, south, east, north, width, height = struct.unpack_from("<4f2I", sections[5])
    cells = sections[5][24:]
    assert west < east and south < north and 0 < width <= 512 and 0 < height <= 512 and len(cells) == width * height
    names = sections[7].decode().split("\0")
    lines = {struct.unpack_from("<I", sections[6], i + 8)[0] for i in range(0, len(sections[6]), 12)}
    assert "Ring West" in names and names[-1] == "" and lines == set(range(len(names) - 1)), names
    assert set(cells) == {0, 1} and 0.1 < sum(cells) / len(cells) < 0.9, sum(cells) / len(cells)
    c.close()


def test_names_are_found(p):
    c = enter(p)
    answer = ask(c, "find", id=1, text="RING ")
    streets = [one["name"] for one in answer["found"] if one["kind"] == "street"]
    assert "Ring North" in streets and len(streets) == len(set(streets)) <= 12, answer
    found = ask(c, "find", id=2, text="lamp")["found"]
    assert {"lamp", "group"} <= {one["kind"] for one in found} and len(found) <= 48, found
    lamp = next(one for one in found if one["kind"] == "lamp")
    named = ask(c, "name", id=3, light=lamp["light"])
    assert named["name"] == lamp["name"] and near(named["place"], lamp["place"]), (named, lamp)
    exact = ask(c, "find", id=4, text=lamp["name"])["found"]
    assert exact[0]["name"] == lamp["name"], exact[:3]
    assert ask(c, "find", id=5, text="no such name")["found"] == []
    assert ask(c, "find", id=6, text="")["found"] == []
    middle = ask(c, "name", id=7, street="Ring South")["place"]
    there = ask(c, "name", id=8, at=middle[:2])
    assert there["street"].startswith("Ring") and near(there["place"], middle, 0.01), there
    building = next(one for one in ask(c, "find", id=9, text="building")["found"] if one["kind"] == "object")
    assert len(ask(c, "name", id=10, object=building["name"])["place"]) == 3
    assert "refused" in ask(c, "name", id=11, street="no such street")
    street = ask(c, "region", id=12, street="Ring South")
    whole = ask(c, "region", id=13, object="streets") if "object" in there else None
    assert 0 < street["area"] and (whole is None or street["area"] < 0.5 * whole["area"]), street["area"]
    assert "refused" in ask(c, "region", id=14, street="no such street")
    c.close()


def test_regions_have_outlines(p):
    c = enter(p)
    answer = ask(c, "region", id=1, pane=0, rect=[0.4, 0.8, 0.6, 0.95])
    assert len(answer["outline"]) > 30 and all(len(place) == 3 for place in answer["outline"])
    x, y = answer["place"][:2]
    square = [[x - 5, y - 5], [x + 5, y - 5], [x + 5, y + 5], [x - 5, y + 5]]
    outline = ask(c, "region", id=2, polygon=square)["outline"]
    assert all(min(abs(abs(px - x) - 5), abs(abs(py - y) - 5)) < 0.01 for px, py, _ in outline), outline
    c.close()


def test_a_card_tells_what_a_lamp_lights(p):
    c = enter(p)
    light = next(one["light"] for one in ask(c, "find", id=1, text="lamp")["found"] if one["kind"] == "lamp")
    c.say("ask", what="lamp", id=2, light=light)
    first = said(c, "answer", lambda m: m["id"] == 2)
    assert first["done"] < 1 and first["lumens"] > 0 and "reach" not in first
    card = said(c, "answer", lambda m: m["id"] == 2 and m["done"] >= 1)
    assert 2 < card["height"] < 20, card["height"]
    reach = card["reach"]
    assert reach["area"] > 10 and reach["far"] > 5 and 0 < reach["met"] <= card["lumens"] * 1.01, reach
    lumens = [one["lumens"] for one in reach["most_lit"]]
    assert lumens == sorted(lumens, reverse=True) and 0 < len(lumens) <= 12
    c.close()


def test_places_are_gone_to_where_they_are_seen(p):
    """From wherever one is, a lamp and a street are seen in the middle of the picture, with nothing in between."""
    c = enter(p)
    lamps = [one for one in ask(c, "find", id=1, text="lamp")["found"] if one["kind"] == "lamp"][:6]
    street = ask(c, "name", id=2, street="Ring East")["place"]
    for n, place in enumerate([one["place"] for one in lamps] + [street]):
        c.say("jump", n=n + 1, place=place, distance=25, still=True)
        camera = said(c, "state", lambda m: near(m["camera"]["target"], place, 0.01))["camera"]
        away = sum((a - b) ** 2 for a, b in zip(camera["eye"], place)) ** 0.5
        assert 3 < away < 27, away
        seen = ask(c, "pixel", id=10 + n, pane=0, x=0.5, y=0.5)
        assert sum((a - b) ** 2 for a, b in zip(seen["place"], place)) ** 0.5 < 3, (seen["place"], place)
    c.close()


def test_lights_have_their_names_in_legends(p):
    c = enter(p)
    for number, mode in enumerate(("influential", "runner-up", "light")):
        c.say("set", pane=0, name="show", value=mode)
        said(c, "state", lambda m: m["panes"][0]["values"]["show"] == mode)
        labels = said(c, "stats", lambda m: m.get("legend") and m["legend"].get("labels"))["legend"]["labels"]
        assert 0 < len(labels) <= 12, labels
        assert len({label["number"] for label in labels}) == len(labels)
        for label in labels[:3]:
            lamp = ask(c, "lamp", id=50 + number, light=label["number"])
            assert label["text"] != str(label["number"]) and label["colour"][0] == "#", label
            assert lamp["name"][:20] in label["text"], (lamp["name"], label)
    c.close()


def test_questions_can_be_taken_back(p):
    c = enter(p)
    for i in range(30): # more than may wait: the oldest are refused, and the last is answered
        c.say("ask", id=i, what="region", pane=0, rect=[0, 0, 1, 1])
    for i in range(29):
        c.say("cancel", id=i)
    answer = ask(c, "pixel", id=100, pane=0, x=0.5, y=0.9)
    assert answer["lux"] > 0
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

def run(*arguments, timeout=60):
    done = subprocess.run([os.environ["NOC_PROGRAM"], "view", *arguments], capture_output=True, text=True,
                          timeout=timeout, check=False)
    return done.returncode, done.stderr


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


def test_inputs_that_cannot_be(p):
    got = run("nowhere.gml", "--port", "0")
    assert got[0] == 1 and got[1].count("nowhere.gml") == 1, got
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
    time.sleep(1)
    others, used = resource.getrusage(resource.RUSAGE_CHILDREN), q.cpu()
    ended, text = q.end()
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    after = now.ru_utime + now.ru_stime - others.ru_utime - others.ru_stime - used
    assert ended == 130, (ended, text)
    assert after < 100 * each, (after, each)


def test_an_interruption_while_it_loads(p):
    q = Program("builtin:city", "--city-size", "1500")
    c = Client(q)
    c.say("hello", width=320, height=180)
    assert said(c, "loading")["done"] >= 0
    ended, text = q.end()
    assert ended == 130, (ended, text)


def file_of(c, what, **values):
    c.say("save", id=77, what=what, **values)
    message = c.wait_for(lambda m: isinstance(m, Picture) and m.kind == 2 or
                         isinstance(m, dict) and m["t"] == "note" and m["level"] == "error")
    assert isinstance(message, Picture), message
    assert message.number == 77
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


def main():
    p = Program(*CITY, "--clients", "6")
    try:
        tap.run(tap.tests_of(sys.modules[__name__]), p)
    finally:
        status, text = p.end()
        print("# ended with %s: %s" % (status, text[-2000:]))
        if status != 130 or "nothing was estimated" in text:
            sys.exit(1)


main()
