"""What `nocturne view` answers: who lights a place, names, outlines, cards of lamps."""
import contextlib
import json
import os
import shlex
import struct
import subprocess
import sys
import tempfile

import hand
from hand import enter, near, said
from wire import Picture, Program


@contextlib.contextmanager
def client_of(features):
    """A client of a program that shows a map of these features of GeoJSON."""
    with tempfile.NamedTemporaryFile("w", suffix=".geojson") as file:
        json.dump({"type": "FeatureCollection", "features": features}, file)
        file.flush()
        q = Program(file.name, "--map-surfaces", "--threads", "2")
        try:
            c = enter(q)
            yield c
            c.close()
        finally:
            q.end()


def ask(c, what, timeout=180, **values):
    c.say("ask", what=what, **values)
    while True:
        answer = said(c, "answer", lambda m: m["id"] == values["id"], timeout)
        if answer["done"] >= 1:
            return answer


def test_who_lights_this(p):
    c = enter(p)
    answer = ask(c, "pixel", id=1, pane=0, x=0.4, y=0.62)
    assert answer["lux"] > 0 and len(answer["place"]) == 3 and answer["class"], answer
    shares = [row["share"] for row in answer["rows"]]
    assert abs(sum(shares) - 1) < 0.02 and all(row["error"] >= 0 for row in answer["rows"]), sum(shares)
    kinds = {one["kind"]: one for one in answer["kinds"]}
    assert "lamp" in kinds and "sky" in kinds and all(one["lux_error"] >= 0 for one in kinds.values()), kinds
    assert near([sum(one["lux"] for one in kinds.values()) / answer["lux"],
                 sum(one["share"] for one in kinds.values())], [1, 1], 1e-6), kinds
    assert sum(one["emitters"] for one in kinds.values()) == answer["emitters"], kinds
    assert [one["kind"] for one in answer["kinds"]][:2] == ["lamp", "window"], answer["kinds"]
    assert answer["lamps"] == kinds["lamp"]["lux"] > 0 and answer["windows"] == kinds["window"]["lux"] > 0, answer
    assert "--count-windows" in shlex.split(answer["command"]), answer["command"]
    lamps = sum(row["share"] for row in answer["rows"] if row["kind"] == "lamp")
    assert lamps <= kinds["lamp"]["share"] + 1e-9, (lamps, kinds)
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
    for one in ("lamps", "windows"):
        mean = sum(row["area"] * row[one] for row in whole["classes"]) / sum(areas)
        assert abs(mean - whole[one]) < 6 * whole[one + "_error"] + 0.05 * mean, (one, mean, whole)
    assert "classes" not in answer
    c.say("save", id=9, what="csv", of=1)
    file = c.wait_for(lambda m: isinstance(m, Picture) and m.kind == 2)
    name, text = file.body[:file.name_size].decode(), file.body[file.name_size:].decode()
    lines = text.splitlines()
    assert file.number == 9 and name == "lights.csv" and lines[0].startswith("rank,name,kind,of,lux,"), lines[0]
    sums = len(kinds) - 1 + 2
    assert len(lines) == 1 + answer["emitters"] + sums, (len(lines), answer["emitters"])
    assert all('"kind"' in line for line in lines[-sums:-2]), lines[-sums:]
    assert answer["emitters"] > len(named)
    assert '"sky"' in lines[-2] and '"windows counted","all"' in lines[-1], lines[-2:]
    listed = [line.split(",") for line in lines[1:-sums]]
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


def test_search_folds_and_offers_the_nearest(p):
    """However a name is spelled; what is not there is answered by the nearest; a lamp is listed once."""
    names = ["Karl-Marx-Straße", "Münchener Str.", "Goethestrasse", "Am Müllerweg"]
    features = [{"type": "Feature", "properties": {"highway": "residential", "name": name},
                 "geometry": {"type": "LineString", "coordinates": [[11.42, 48.76 + 0.001 * i],
                                                                    [11.421, 48.76 + 0.001 * i]]}}
                for i, name in enumerate(names)]
    features.append({"type": "Feature", "id": "node/777", "properties": {"highway": "street_lamp"},
                     "geometry": {"type": "Point", "coordinates": [11.4205, 48.76003]}})
    with client_of(features) as c:

        def found(text):
            answer = ask(c, "find", id=1, text=text)
            return [one["name"] for one in answer["found"] if one["kind"] == "street"]

        for text in ("karl marx str", "KARL-MARX-STR.", "Karl Marx Strasse", "karl\u2013marx\u2013straße"):
            assert found(text) == [names[0]], (text, found(text))
        for text in ("munchener straße", "Muenchener", "MÜNCHENER STR", "mu\u0308nchener strasse"):
            assert found(text) == [names[1]], (text, found(text))
        assert found("Göthestr.") == [names[2]] and found("goethe") == [names[2]]
        assert found("mueller") == [names[3]] and found("str. x") == []
        assert sorted(found("straße")) == sorted(names[:3])
        missed = ask(c, "find", id=2, text="Goethestrase")
        assert missed["found"] == [] and missed["near"][0]["name"] == names[2], missed
        assert ask(c, "find", id=3, text="qqqqqqqqqqqq")["near"] == []
        lamps = ask(c, "find", id=4, text="node/777")["found"]
        assert [one["kind"] for one in lamps] == ["lamp"] and len(lamps[0]["place"]) == 3, lamps
        for text in ("", " ", "-", ".", "\u00c3", "str.str.str." * 8):
            assert "found" in ask(c, "find", id=5, text=text)


def test_long_names_are_whole(p):
    """A street is told from another one however late their names differ."""
    names = ["a" * 1000 + end for end in "bc"]
    roads = [{"type": "Feature", "properties": {"highway": "residential", "name": name},
              "geometry": {"type": "LineString", "coordinates": [[11.42, y], [11.421, y]]}}
             for name, y in zip(names, (48.76, 48.761))]
    with client_of(roads) as c:
        assert sorted(one["name"] for one in ask(c, "find", id=1, text="aaa")["found"]) == names
        places = [ask(c, "name", id=2, street=name)["place"] for name in names]
        assert abs(places[1][1] - places[0][1]) > 50, places
        assert ask(c, "region", id=3, street=names[1])["area"] > 10


def test_regions_have_outlines(p):
    c = enter(p)
    answer = ask(c, "region", id=1, pane=0, rect=[0.4, 0.8, 0.6, 0.95])
    assert len(answer["outline"]) == 1, answer["outline"]
    assert len(answer["outline"][0]) > 30 and all(len(place) == 3 for place in answer["outline"][0])
    x, y = answer["place"][:2]
    square = [[x - 5, y - 5], [x + 5, y - 5], [x + 5, y + 5], [x - 5, y + 5]]
    outline, = ask(c, "region", id=2, polygon=square)["outline"]
    assert all(min(abs(abs(px - x) - 5), abs(abs(py - y) - 5)) < 0.01 for px, py, _ in outline), outline
    c.close()


def test_objects_and_streets_have_outlines(p):
    """Rings around what is asked, in bounds: a building's is around its middle, a street's as wide as its pavements."""
    c = enter(p)
    building = next(one for one in ask(c, "find", id=1, text="building")["found"] if one["kind"] == "object")
    answer = ask(c, "region", id=2, object=building["name"])
    ring, = answer["outline"]
    assert 3 <= len(ring) <= 48 and len({place[2] for place in ring}) == 1, ring
    assert ring[0][2] < answer["place"][2]
    x, y = answer["place"][:2]
    sides = [(a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y) for a, b in zip(ring, ring[1:] + ring[:1])]
    assert all(side > 0 for side in sides), sides  # its middle is to the left of each side
    roof = sum(one["area"] for one in answer["classes"] if one["class"] == "roof")
    assert 0.5 * roof < sum(sides) / 2 < 3 * answer["area"], (sum(sides) / 2, answer["classes"])
    street = ask(c, "region", id=3, street="Ring South")
    assert 1 <= len(street["outline"]) <= 64 and all(4 <= len(ring) <= 200 for ring in street["outline"])
    width = min(((ring[0][0] - ring[-1][0]) ** 2 + (ring[0][1] - ring[-1][1]) ** 2) ** 0.5
                for ring in street["outline"])
    assert 10 < width < 40, width
    c.close()


def carried_away(answer, *inputs):
    """The answer's command, as a shell takes it apart, asks the same."""
    words = shlex.split(answer["command"])
    assert words[:2] == ["nocturne", "influence"] and set(inputs) <= set(words), words
    told = subprocess.run([os.environ["NOC_PROGRAM"], *words[1:], "-q", "--json", "--error", "0.005", "--time", "20"],
                          capture_output=True, text=True, timeout=300)
    assert told.returncode == 0, (words, told.stderr)
    there = json.loads(told.stdout)
    within = 5 * (there["lux_error"] ** 2 + answer["lux_error"] ** 2) ** 0.5 + 1e-4 * there["lux"]
    assert abs(there["lux"] - answer["lux"]) < within, (there["lux"], answer["lux"], within, words)
    return there


def test_commands_ask_the_same(p):
    """A place, a rectangle, an object, a street and a polygon: the command of each brings the same illuminance. The
    windows and the lamps are not as the program says by itself."""
    q = Program(*hand.CITY, "--no-traffic", "--window-lit", "0.6")
    try:
        c = enter(q)
        c.say("world", name="group.lamps", value="0.5,own")
        said(c, "state", lambda m: "group" in m["command"])
        place = ask(c, "pixel", id=1, pane=0, x=0.5, y=0.9)
        x, y = place["place"][:2]
        square = [[x - 4, y - 4], [x + 4, y - 4], [x + 4, y + 4], [x - 4, y + 4]]
        asked = [place, ask(c, "region", id=2, pane=0, rect=[0.4, 0.8, 0.6, 0.95]),
                 ask(c, "region", id=3, street="Ring South"), ask(c, "region", id=4, polygon=square)]
        if "object" in place:
            asked.append(ask(c, "region", id=5, object=place["object"]))
        for answer in asked:
            carried_away(answer, "builtin:city", "--no-traffic", "lamps=0.5,own")
        c.close()
    finally:
        q.end()


def test_commands_speak_the_scenes_crs(p):
    """Where the scene has a CRS, a place and a polygon are said in it, and so is the middle of what was asked."""
    features = [{"type": "Feature", "properties": {"highway": "residential", "name": "Markt-Straße", "lit": "yes"},
                 "geometry": {"type": "LineString", "coordinates": [[11.42, 48.76], [11.421, 48.76]]}},
                {"type": "Feature", "properties": {"highway": "street_lamp", "id": "node/7"},
                 "geometry": {"type": "Point", "coordinates": [11.4205, 48.76003]}}]
    with client_of(features) as c:
        street = ask(c, "region", id=1, street="Markt-Straße")
        assert "EPSG" in street["crs"]["name"] and street["crs"]["place"][1] > 5e6, street["crs"]
        carried_away(street)
        x, y = street["place"][:2]
        square = ask(c, "region", id=2, polygon=[[x - 3, y - 3], [x + 3, y - 3], [x + 3, y + 3], [x - 3, y + 3]])
        assert "POLYGON((" in square["command"] and near(square["crs"]["place"], street["crs"]["place"], 3), square
        there = carried_away(square)
        assert "EPSG" in there["crs"], there["crs"]


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


hand.run(sys.modules[__name__])
