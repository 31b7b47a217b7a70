#!/bin/sh
# Specs of experiments: presets, options without effect, and what goes wrong around a folder or a cache.
. "$(dirname "$0")/lib.sh"
export XDG_CACHE_HOME="$work/home"

# spec FILE CONFIGURATIONS [MEMBERS]: one camera before one lamp, one frame, once
spec() {
    cat >"$1" <<SPEC
{ "scene": { "name": "one", "inputs": ["builtin:single"] }, "cameras": [ { "name": "own", "view": "own" } ],
  "size": "32x18", "reference": { "rays": 1, "frames": 1 }, "frames": 1, "repetitions": 1, "shown": [], ${3:-}
  "configurations": [ $2 ] }
SPEC
}

# A run's rows are known by a hash of its name and all of its options: equal options, no new rows.
spec preset.json '{ "name": "*", "preset": "*" }, { "name": "own", "shadow-rays": 2, "preset": "interactive" }'
spec spelled.json '{ "name": "still", "method": "ris", "candidates": "lists", "list": 64, "tail": 128,
    "shadow-rays": 8 },
    { "name": "interactive", "method": "ris", "candidates": "lists", "list": 32, "tail": 64, "shadow-rays": 8 },
    { "name": "quick", "method": "ris", "candidates": "lists", "list": 64, "tail": 128, "shadow-rays": 4 },
    { "name": "own", "method": "ris", "candidates": "lists", "list": 32, "tail": 64, "shadow-rays": 2 }'
run experiment preset.json -o p --cache cache
test $status = 0 && grep -q ': 8 rows, 8 of them made now' out
result $? "\"preset\": \"*\" is a configuration of each preset"
run experiment spelled.json -o p --cache cache
test $status = 0 && grep -q ': 8 rows, 0 of them made now' out
result $? "a preset is the options that it stands for; those beside it win, wherever it stands"
spec shared.json '{ "name": "a" }, { "name": "b", "shadow-rays": 2 }, { "name": "c", "preset": "still" }' \
    '"options": { "tail": 48, "preset": "interactive" },'
run experiment shared.json -o q --cache cache
spec spelled.json '{ "name": "a" }, { "name": "b", "shadow-rays": 2 }, { "name": "c", "method": "ris",
    "list": 64, "tail": 128 }' \
    '"options": { "method": "ris", "list": 32, "tail": 48, "shadow-rays": 8 },'
run experiment spelled.json -o q --cache cache
test $status = 0 && grep -q ': 6 rows, 0 of them made now' out
result $? "one for all configurations is overruled by their own"

# A reference by another method is told by its options, in a sentence; configurations in a table.
spec other.json '{ "name": "a", "method": "is" }'
sed -i 's/"reference": { "rays": 1,/"reference": { "method": "ris", "list": 8,/' other.json
run experiment other.json -o o --cache cache
test $status = 0 &&
    grep -q '^Reference: 1 frame of `[^|]*`method ris`, `candidates lists`, `list 8`, through the centres of pixels.$' \
        o/report.md &&
    grep -q '^| a | `[^|]*`method is` |$' o/report.md; result $? "a reference by ris, in the report"

# What changes nothing is told once, by where it stands; what counts in one configuration of an entry is not.
spec idle.json '{ "name": "is", "method": "is", "draws": 8 }, { "name": "*", "method": "ris",
    "candidates": ["power", "lists"], "draws": 8 },
    { "name": "p", "preset": "interactive", "method": "restir", "spatial": false, "candidates": "influence",
    "uniform-every": 2 }' '"options": { "rays": 4, "list": 8, "passes": 2 },'
sed -i 's/"reference": { /"reference": { "tail": 3, /' idle.json
run experiment idle.json -o i --cache cache
cat >told <<'TOLD'
nocturne: warning: idle.json: options: passes has no effect: it needs spatial true, not false
nocturne: warning: idle.json: reference: tail has no effect: it needs method ris|restir, not reference
nocturne: warning: idle.json: configurations[0]: draws has no effect: it needs method ris|restir, not is
TOLD
test $status = 0 && cmp -s told err; result $? "options that change nothing are warned of"
grep -q '^| is | `jitter false`, `sky 0`, `method is` |$' i/report.md
result $? "and the report does not list them" "$(grep '^| is |' i/report.md)"
run experiment idle.json -o i --cache cache -q
test $status = 0 && test ! -s err; result $? "quiet says nothing of them"
spec wrong.json '{ "name": "fast", "preset": "fast" }'
expect "an unknown preset" 2 'wrong.json: configurations\[0\]: preset: "fast" is none of still\|interactive' \
    experiment wrong.json -o w
spec wrong.json '{ "name": "a" }' '"equal-time": 3,'
expect "one time that is no array" 2 'wrong.json: equal-time: this must be an array of CPU seconds, such as' \
    experiment wrong.json -o w
spec moving.json '{ "name": "a" }' '"equal-time": [1],'
sed 's/"view": "own"/"view": "own", "path": { "frames": 2, "pan": 1 }/' moving.json >wrong.json
expect "equal time of cameras that all move" 2 'wrong.json: equal-time: this needs a camera at rest' experiment \
    wrong.json -o w

spec far.json '{ "name": "a", "frames": 5 }, { "name": "b" }' '"measured": [1, 5],'
run experiment far.json -o f --cache cache
test $status = 0 && test "$(grep -c '^one,own,a,' f/results.csv)" = 4 &&
    test "$(grep -c '^one,own,b,' f/results.csv)" = 2
result $? "measured frames are those of the configurations that come to them"
sed 's/"measured": \[1, 5\]/"measured": [1, 6]/' far.json >wrong.json
expect "a measured frame after the last of all" 2 'wrong.json: measured: frame 6 is after the last, 5' experiment \
    wrong.json -o w
sed 's/"shown": \[\]/"shown": [6]/' far.json >wrong.json
expect "and one to be shown" 2 'wrong.json: shown: frame 6 is after the last, 5' experiment wrong.json -o w
sed 's/"view": "own"/"view": "own", "path": { "frames": 2, "speed": 1 }/' far.json >wrong.json
expect "an unknown option like no other" 2 \
    'wrong.json: cameras\[0\]: path: no option "speed"; there are frames, dolly, orbit, pan, fps, cut, before$' \
    experiment wrong.json -o w
sed 's/"view": "own"/&, "path": { "frames": 3, "cut": 2, "before": { &, "path": { "frames": 2, "pan": 1 } } }/' \
    moving.json >wrong.json
expect "a path of the camera before the cut" 2 'wrong.json: cameras\[0\]: path: before: no option "path"' experiment \
    wrong.json -o w

# What a spec asks for is limited, and told by the limit.
# asks NAME PATTERN TEXT N: refuses base.json with N times what Python makes of TEXT in the place of LIST
asks() {
    python3 -c '
import sys
items = [eval(sys.argv[1]) for i in range(int(sys.argv[2]))]
print(open("base.json").read().replace("LIST", ", ".join(items)))' "$3" "$4" >wrong.json
    expect "$1" 2 "wrong.json: $2\$" experiment wrong.json -o w
}
spec base.json 'LIST'
asks "too many configurations" 'it asks for more than 1000 configurations' "'{ \"name\": \"%d\" }' % i" 1001
spec base.json '{ "name": "*", "shadow-rays": [LIST] }'
asks "and as an array of values" 'it asks for more than 1000 configurations' "'1'" 1001
spec base.json '{ "name": "a" }'
sed -i 's/\[ { "name": "own", "view": "own" } \]/[LIST]/' base.json
asks "too many cameras" 'it asks for more than 1000 cameras' "'{ \"name\": \"%d\", \"view\": \"own\" }' % i" 1001
spec base.json '{ "name": "a" }'
sed -i 's/"builtin:single"/LIST/' base.json
asks "too many inputs" 'scene: it asks for more than 10000 inputs' "'\"a\"'" 10001
spec base.json '{ "name": "a" }'
sed -i 's/"view": "own"/"eye": [LIST], "target": [0, 0, 0]/' base.json
asks "an eye of a thousand numbers" 'cameras\[0\]: eye: it asks for more than 64 numbers' "'1'" 65
asks "and one of 64" 'cameras\[0\]: eye and target are three numbers each, \[x, y, z\]' "'1'" 64
spec wrong.json '{ "name": "a" }'
head -c 1100000 /dev/zero | tr '\0' ' ' >>wrong.json
expect "a spec of a megabyte" 2 'wrong.json: it is larger than 1048576 bytes$' experiment wrong.json -o w

# What structures are is told of the camera at rest in a scene, else of those that move; not what nobody saw.
spec volumes.json '{ "name": "v", "candidates": "influence", "influence": 100 }'
sed -i 's/"scene": \(.*\) }, "cameras": .*\],$/"scenes": [ \1, "cameras": [ REST, MOVES, SKY ] }, TWO ],/
    s/TWO/{ "name": "two", "inputs": ["builtin:single"], "cameras": [ MOVES ] }/
    s/REST/{ "name": "own", "view": "own" }/
    s/MOVES/{ "name": "turn", "view": "own", "path": { "frames": 2, "pan": 1 } }/g
    s/SKY/{ "name": "sky", "eye": [0, 0, 50], "target": [0, 0, 90] }/' volumes.json
run experiment volumes.json -o z --cache cache
sed -n '/^| Light structure /,$s/^| v | \([a-z, ]*\) | .* | \([0-9-]*\) | \([0-9-]*\) |$/\1: \2 \3/p' z/summary.md >told
printf '%s\n' 'one, own: 1 1' 'one, sky: - -' 'two, turn: 1 1' >want
test $status = 0 && cmp -s want told
result $? "structures: a row for each scene, and nothing of what no pixel saw" "$(cat told)"
python3 - <<'CHECK'
import csv
for r in csv.DictReader(open("z/results.csv")): # S_r is set: no time goes into finding it
    assert float(r["light_tuning_s"]) == 0 and float(r["light_volumes_s"]) > 0 and float(r["light_boxes_s"]) == 0, r
CHECK
test $? = 0 && grep -q '^| v | one, own | [0-9.e-]* | [0-9.e-]* | 0 | [0-9.e-]* | 0 |' z/summary.md
result $? "the steps of building them, without the search for what is given"
run experiment volumes.json -o z --cache cache
test $status = 0 && grep -q ' 0 of them made now' out && grep -q '^| v | one, sky |.*| - | - | - |$' z/summary.md
result $? "and when its rows are read again"

# What is not named is named after the spec, and an entry of several values as the spec has it.
spec named.json '{ "name": "ris, * rays", "shadow-rays": [1, 2] }, { "name": "draws *", "candidates": "power",
    "draws": [1, 2] }, { "name": "*", "preset": "*" }'
run experiment named.json -o e --cache cache
test $status = 0 && test "$(head -n 1 e/report.md)" = "# named" && test "$(head -n 1 e/summary.md)" = "# named"
result $? "no title: the spec's name"
grep -q '^| ris, \\\* rays | ' e/summary.md && grep -q '^| draws | ' e/summary.md && grep -q '^| preset | ' e/summary.md
result $? "summary.md names entries of several values by what they share"
spec titled.json '{ "name": "=1+1" }' '"title": "A <b>title</b> & *more*",'
sed -i 's/"shown": \[\]/"shown": [1]/; s/"view": "own"/"view": "own", "path": { "frames": 2, "pan": 1 }/' titled.json
run experiment titled.json -o g --cache cache
test "$(head -n 1 g/report.md)" = "# A &lt;b&gt;title&lt;/b&gt; &amp; \\*more\\*" &&
    grep -q '^Shown is the last frame of each configuration, row by row ("reference", "=1+1"): the part of [0-9]* x ' \
    g/report.md
result $? "a title is the heading, as it reads; what is shown of a camera that moves is said"
python3 -c 'import csv; assert [r["configuration"] for r in csv.DictReader(open("g/results.csv"))] == ["\x27=1+1"]' &&
    grep -q '^| =1+1 |' g/report.md
result $? "a name that a spreadsheet would run is text in the table"
run experiment titled.json -o g --cache cache
test $status = 0 && grep -q ' 0 of them made now' out; result $? "and its rows are found again"

# A spec may say what candidates were called before; reports tell the names of today.
spec former.json '{ "name": "r, *", "method": "ris", "candidates": ["bvh", "tree"] }'
run experiment former.json -o former --cache cache
python3 -c 'import csv
assert {r["configuration"] for r in csv.DictReader(open("former/results.csv"))} == {"r, influence", "r, light-bvh"}'
result $? "former names of candidates are taken"

# Colours and markers follow the values, wherever in an entry's array they stand; where values are more than colours,
# all differ.
spec arrays.json '{ "name": "alone", "method": "is" }, { "name": "ris, *", "method": "ris",
    "candidates": ["uniform", "power", "influence", "light-bvh"] },
    { "name": "restir, *", "method": "restir", "candidates": ["lists", "influence", "uniform"] }'
spec many.json '{ "name": "S_r *", "candidates": "influence", "influence": [0, 0.25, 0.5, 1, 2, 4, 8, 16, 32] },
    { "name": "M *", "candidates": "influence", "influence": [32, 0] }'
for f in arrays many; do
    sed -i 's/"frames": 1, "repetitions": 1/"frames": 2, "repetitions": 2/' $f.json
    run experiment $f.json -o $f --cache cache
done
python3 - <<'CHECK'
import csv, re, xml.etree.ElementTree as tree
svg = "{http://www.w3.org/2000/svg}"
def look(path):
    """The style of each name of a legend, and the markers elsewhere, with their places."""
    root, names, marks, last = tree.parse(path).getroot(), {}, [], None
    for e in root.iter():
        shape = re.match(r"M([-\d.]+) ([-\d.]+)(.*z)$", e.get("d") or "")
        if shape:
            last = (e.get("class"), shape.group(3))
            marks.append((last, float(shape.group(1)), float(shape.group(2))))
        elif e.tag == svg + "text" and last:
            names["".join(e.itertext())] = last
            last = None
    return names, marks, root
mean = lambda rows, name: sum(float(r["relmse_clamped"]) for r in rows if r["configuration"] == name and
                              r["frame"] == "1" and r["mode"] == "accumulated")
for folder, groups, values in (("arrays", ("ris", "restir"), ("uniform", "power", "influence", "light-bvh", "lists")),
                               ("many", ("S_r", "M"), ("0", "0.25", "0.5", "1", "2", "4", "8", "16", "32"))):
    names, marks, root = look(folder + "/errors.svg")
    styles = [names[v] for v in values]
    assert len(set(styles)) == len(values), names
    assert {style for style, x, y in marks} == set(names.values()), (names, marks) # every series has an entry
    texts = {"".join(t.itertext()): float(t.get("y")) for t in root.iter(svg + "text")}
    configs = {r["configuration"] for r in csv.DictReader(open(folder + "/results.csv"))}
    for group in groups:
        here = {style for style, x, y in marks if abs(y - texts[group]) < 12}
        want = {names[v] for v in values if any(c.startswith(group) and c.split()[-1] == v for c in configs)}
        assert here == want, (folder, group, here, want)
    # Of the plots over frames, each configuration's own: no two are drawn alike.
    names, marks, root = look(folder + "/1-one-own-mean-frames.svg")
    lines = [(l.get("class"), l.get("stroke-dasharray")) for l in root.iter(svg + "polyline")]
    assert len({(names[c], line) for c, line in zip(names, lines)}) == len(configs), names
# Both ends of every axis have a tick and its number.
for path in ("arrays/errors.svg", "arrays/1-one-own-mean-frames.svg", "arrays/1-one-own-mean-cpu.svg",
             "many/1-one-own-mean-frames.svg"):
    root = tree.parse(path).getroot()
    numbers = [(float(t.get("x")), float(t.get("y"))) for t in root.iter(svg + "text")
               if re.fullmatch(r"[\d.e-]+", "".join(t.itertext()))]
    boxes = [[float(r.get(k)) for k in ("x", "y", "width", "height")] for r in root.iter(svg + "rect")
             if r.get("class") == "frame"]
    assert boxes
    # Along the axes of one box, numbers are those of 1, 2, 5, ... without a gap, or powers of ten; the end of frames is
    # what it is.
    for place in range(2):
        axes = {}
        for t in root.iter(svg + "text"):
            text = "".join(t.itertext())
            if re.fullmatch(r"[\d.e-]+", text) and (t.get("text-anchor") == "middle") == (place == 0):
                x, y, w, h = min(boxes, key=lambda b: abs(b[1] + b[3] + 18 - float(t.get("y"))) +
                                 (abs(b[0] + b[2] / 2 - float(t.get("x")))))
                axes.setdefault((x, y), []).append(float(text))
        for numbers_there in axes.values():
            v = sorted(numbers_there)
            steps = [round(b / a, 3) for a, b in zip(v, v[1:])]
            steps = steps[:-1] if "frames" in path and place == 0 else steps
            assert set(steps) <= {2, 2.5} or len(set(steps)) == 1, (path, v)
    for x, y, w, h in boxes:
        for end in (x, x + w):
            assert any(abs(at - end) < 0.2 and abs(down - (y + h + 18)) < 0.2 for at, down in numbers), (path, end)
        for end in (y, y + h) if "errors" not in path else ():
            assert any(abs(at - (x - 8)) < 0.2 and abs(down - end - 4.5) < 0.2 for at, down in numbers), (path, end)
CHECK
result $? "plots tell values apart by what they are, and axes end in ticks"

# Insets: parts of the picture below it, enlarged and framed, each in a colour of its own, under their names; and names
# above pictures.
spec insets.json '{ "name": "a" }'
sed -i 's/"shown": \[\]/"shown": [1]/; s/32x18/320x180/
    s/"view": "own"/&, "insets": [ { "name": "top", "box": [0, 0, 40, 30] }, KNOT ]/
    s/KNOT/{ "name": "<knot>", "box": [140, 60, 40, 30] }/' insets.json
run experiment insets.json -o insets --cache cache
grep -q 'red is top, 40 x 30 px at (0, 0); green is &lt;knot&gt;, 40 x 30 px at (140, 60). All have' insets/report.md &&
    PYTHONPATH="$source_dir/tests/cli" PYTHONDONTWRITEBYTECODE=1 python3 - <<'CHECK'
import sys
from png_rows import read
sheet = read("insets/1-one-own-frame1.png")
inset = 158 * 30 // 40 + 1 # two of 158 px, 4 apart
assert len(sheet[0]) == 2 * 320 + 4 and len(sheet) == 22 + 180 + 4 + inset + 14, (len(sheet[0]), len(sheet))
red, green, top = (235, 70, 60), (70, 200, 90), 22 + 180 + 4
for left in (0, 324):
    # the frame in the picture, outside its box
    assert sheet[22 + 60 - 1][left + 140] == green and sheet[22 + 95 - 4][left + 140] == green
    assert sheet[top][left] == red and sheet[top][left + 162] == green and sheet[top + inset - 1][left + 319] == green
    x, y = left + 162 + 80, top + 60 # in the middle of the second: what the picture shows in the middle of its box
    assert sheet[y][x] == sheet[22 + 60 + 60 * 30 // inset][left + 140 + 80 * 40 // 158], "enlarged"
    assert any(c == red for row in sheet[top + inset + 3:top + inset + 10] for c in row[left:left + 60]), "its name"
# Names: the letter a, of 5 x 7 pixels enlarged twice, above the second panel.
glyph = [".....", ".....", ".###.", "....#", ".####", "#...#", ".####"]
for y in range(7):
    for x in range(5):
        assert (sheet[2 + 2 * y][324 + 2 + 2 * x] == (235, 235, 235)) == (glyph[y][x] == "#"), (x, y)
CHECK
result $? "insets are enlarged, framed and named, and pictures carry their names" "$(cat err)"
sed 's/\[0, 0, 40, 30\]/[300, 0, 40, 30]/' insets.json >wrong.json
expect "an inset outside the picture" 2 \
    'wrong.json: cameras\[0\]: insets\[0\]: box must be .* inside the picture of 320 x 180 px' experiment wrong.json \
    -o w
sed 's/{ "name": "top", "box"/{ "box"/' insets.json >wrong.json
expect "an inset without a name" 2 'wrong.json: cameras\[0\]: insets\[0\]: it needs a name' experiment wrong.json -o w
sed 's/"insets": \[/&{}, {}, {}, /' insets.json >wrong.json
expect "five insets" 2 'wrong.json: cameras\[0\]: insets must be an array of up to 4' experiment wrong.json -o w

# A reference says ahead that it is made; options that change nothing in it make no other of it.
spec said.json '{ "name": "a" }'
sed -i 's/"reference": { "rays": 1/"reference": { "method": "ris", "candidates": "lists"/' said.json
run experiment said.json -o said --cache said-cache
test $status = 0 && grep -q '^one, own: making the reference, 1 frame of 32 x 18 px$' out
result $? "a reference is announced"
sed 's/"frames": 1, "repet/"options": { "neighbours": 3, "radius": 4, "influence": 2, "rays": 7 }, &/' said.json \
    >again.json
run experiment again.json -o said --cache said-cache
test $status = 0 && grep -q 'reference from' out
result $? "and shared with a spec whose other options do not concern it" "$(cat out)"
sed 's/"candidates": "lists"/&, "list": 7/' said.json >again.json
run experiment again.json -o said --cache said-cache
test $status = 0 && grep -q 'reference made' out; result $? "but not where one does"

# What a spec says nothing of is repeated, and its spread told: the standard error of the mean, in tables and as bands.
spec spread.json '{ "name": "a", "candidates": "power" }, { "name": "b", "method": "is" }'
sed -i 's/ "repetitions": 1,//; s/32x18/64x36/
    s/"frames": 1,/"frames": 3, "accumulate": true, "equal-time": [0.001],/' spread.json
run experiment spread.json -o spread --cache cache
python3 - <<'CHECK'
import csv, re, statistics, xml.etree.ElementTree as tree
rows = list(csv.DictReader(open("spread/results.csv")))
seeds = {r["seed"] for r in rows}
number = lambda digits, v: "%.0f" % v if abs(v) >= 100 else "%.*g" % (digits, v)
assert len(seeds) == 4 and len(rows) == 2 * 4 * 3, (seeds, len(rows))
report = open("spread/report.md").read()
def cells(what, name):
    table = re.search(r"^\| %s, frame \|.*\n\|[-:|]*\n((?:\|.*\n)*)" % re.escape(what), report, re.M).group(1)
    return [c.strip() for c in next(l for l in table.splitlines() if l.startswith("| %s |" % name)).split("|")[2:-1]]
for name in "ab":
    for frame in (1, 2, 3):
        of = lambda column: [float(r[column]) for r in rows if r["configuration"] == name and r["frame"] == str(frame)]
        error = lambda v: statistics.stdev(v) / len(v) ** 0.5
        v, b = of("relmse"), [100 * (x - 1) for x in of("bias")]
        assert cells("relMSE", name)[frame - 1] == "%s ± %s" % (number(3, statistics.mean(v)),
                                                                number(2, error(v))), (cells("relMSE", name), v)
        assert cells("Bias, %", name)[frame - 1] == "%+.2f ± %s" % (statistics.mean(b),
                                                                    number(2, error(b))), (cells("Bias, %", name), b)
assert "4 repetitions with different seeds" in report
assert re.search(r"^Its mean has a standard error of [\d.]+ %", report, re.M) is None # one frame tells nothing of it
assert re.search(r"^\| a \| [\d.e-]+ ± [\d.e-]+ / [\d.e-]+ ± [\d.e-]+ · [\d.e-]+ ± [\d.e-]+ ms \|$",
                 open("spread/summary.md").read(), re.M)
svg = "{http://www.w3.org/2000/svg}"
bands = tree.parse("spread/1-one-own-mean-frames.svg").getroot().findall(".//" + svg + "polygon")
assert len(bands) == 2 and all(len(b.get("points").split()) == 6 for b in bands)
whiskers = [p for p in tree.parse("spread/errors.svg").getroot().iter(svg + "path")
            if "whisker" in (p.get("class") or "")]
assert len(whiskers) == 4, len(whiskers) # configurations, the first frame and the last
CHECK
result $? "four repetitions where a spec says nothing, and standard errors in tables and plots" "$(cat err)"

# A weak reference leaves pixels black that pictures light: they are counted, and told of, also when all rows are read
# again.
spec weak.json '{ "name": "rays", "method": "reference", "rays": 8 }'
sed -i 's/"reference": { "rays": 1/"reference": { "method": "is"/; s/"frames": 1, "repet/"frames": 2, "repet/' weak.json
for again in "" ", again"; do
    run experiment weak.json -o weak --cache weak-cache
    cp out told
    "$program" compare --json "$(ls weak-cache/*.exr)" "$(ls weak-cache/*.exr)" >itself
    python3 - <<'CHECK'
import csv, json, re
rows = list(csv.DictReader(open("weak/results.csv")))
pattern = (r"nlit in the reference: (\d+) pixels that a picture lights are ([\d.]+) % of its relMSE "
           r"\(rays, (mean of|frame) (\d), .*reference, or one of ris")
part = lambda r: float(r["relmse_unlit"]) / float(r["relmse"])
most = max(rows, key=part)
assert len(rows) == 4 and 1 < float(most["unlit"]) < 32 * 18 and most["unlit"] == most["unlit_all"], rows
mode = "mean of" if most["mode"] == "accumulated" else "frame"
for path, before in ("told", "one, own: u"), ("weak/report.md", "\nU"):
    text = open(path).read()
    said = re.search(before + pattern, text).groups()
    assert said[:2] == (most["unlit"], "%.3g" % (100 * part(most))), (path, text)
assert json.load(open("itself"))["all"]["unlit"] == 0
CHECK
    result $? "pixels that the reference leaves black are counted$again" "$(cat told)"
done
sed 's/"method": "is", "frames": 1/"frames": 400/' weak.json >strong.json
run experiment strong.json -o strong --cache weak-cache
test $status = 0 && ! grep -q 'nlit in the reference' out strong/report.md
result $? "nothing is said where there are none" "$(cat out)"

# What is wrong is one line, before any work and before any folder is made.
spec wrong.json '{ "name": "a", "draws": [[1]] }'
expect "an array in an array" 2 'wrong.json: configurations\[0\]: draws: this cannot be its value' experiment \
    wrong.json -o w
spec wrong.json '{ "name": "a" }' '"seed": [1],'
expect "an array where one value is meant" 2 'wrong.json: seed: this cannot be its value' experiment wrong.json -o w
spec wrong.json '{ "name": "a", "width": 3 }'
expect "what the spec says for all" 2 'wrong.json: configurations\[0\]: width: the spec says it for all pictures' \
    experiment wrong.json -o w
spec one.json '{ "name": "a" }'
sed 's/"scene": \(.*\) }, "cameras"/"scenes": [ \1 }, { "name": "two", "inputs": ["INPUT"] } ], "cameras"/' one.json \
    >late.json
sed 's/INPUT/gone.gml/' late.json >wrong.json
expect "an input of the second scene that is not there" 1 '^nocturne: gone.gml: No such file' experiment wrong.json -o w
sed 's/INPUT/./' late.json >wrong.json
expect "a folder as input" 1 '^nocturne: \.: Is a directory' experiment wrong.json -o w
sed 's/INPUT/builtin:nowhere/' late.json >wrong.json
expect "a built-in scene that there is not" 2 'wrong.json: scenes\[1\]: builtin:nowhere: no such' experiment \
    wrong.json -o w
expect "a spec that is not there" 1 '^nocturne: gone.json: No such file or directory$' experiment gone.json
test ! -e w && test ! -e gone; result $? "nothing was written"

# Inputs are named as seen from the spec, wherever it is started.
mkdir -p there
cp "$source_dir/tests/cli/city.gml" there/
sed 's/builtin:single/city.gml/' one.json >there/one.json
run experiment there/one.json -o r --cache cache
test $status = 0 && (cd there && "$program" experiment one.json -o ../r --cache ../cache -v) >out 2>err &&
    grep -q ': 2 rows, 0 of them made now' out
result $? "a spec in another folder, and from within"

# A reference belongs to what was read, not to the files that were named: a change of an MTL or of a glTF's buffer makes
# it anew, one of a comment does not, and two specs share it. Against a stale one the bias of half the light would be
# 0.5.
lamp_model
python3 - <<'MAKE'
import json, struct
def quad(h, y, up):
    c = [(-h, y, -h), (h, y, -h), (h, y, h), (-h, y, h)]
    c = c[::-1] if up else c
    return b"".join(struct.pack("<3f", *c[i]) for i in (0, 1, 2, 0, 2, 3))
def make(name, height):
    data = quad(5, 0, True) + quad(.5, height, False)
    open(name, "wb").write(data)
    return data
make("high.bin", 4)
data = make("lamp.bin", 2)
view = lambda at: {"buffer": 0, "byteOffset": at, "byteLength": 72}
part = lambda i: {"bufferView": i, "componentType": 5126, "type": "VEC3", "count": 6, "min": [-5, 0, -5],
                  "max": [5, 4, 5]}
json.dump({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
           "buffers": [{"uri": "lamp.bin", "byteLength": len(data)}], "bufferViews": [view(0), view(72)],
           "accessors": [part(0), part(1)],
           "materials": [{}, {"emissiveFactor": [1, 1, 1],
                              "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 40}}}],
           "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0},
                                      {"attributes": {"POSITION": 1}, "material": 1}]}]},
          open("lamp.gltf", "w"))
MAKE
for kind in obj gltf; do
    spec side-$kind.json '{ "name": "rays", "method": "reference", "rays": 64 }'
    sed -i "s/builtin:single/lamp.$kind/; s/\"view\": \"own\"/\"eye\": [4, -4, 1], \"target\": [0, 0, 0]/
        s/\"rays\": 1, \"frames\": 1/\"rays\": 256, \"frames\": 4/" side-$kind.json
    run experiment side-$kind.json -o side-$kind --cache sides
    test $status = 0 && grep -q 'reference made' out && ! grep -q warning err; result $? "$kind: a reference is made"
    case $kind in obj) echo '# a comment' >>lamp.mtl && echo '# a comment' >>lamp.obj ;; gltf) touch lamp.bin ;; esac
    sed "s/\"one\"/\"another\"/" side-$kind.json >shared-$kind.json
    run experiment shared-$kind.json -o shared-$kind --cache sides
    test $status = 0 && grep -q 'reference from' out; result $? "$kind: another spec of the same takes it"
    case $kind in obj) sed -i 's/Ke.*/Ke 20 20 20/' lamp.mtl ;; gltf) cp high.bin lamp.bin ;; esac
    run experiment side-$kind.json -o side-$kind --cache sides
    test $status = 0 && grep -q 'reference made' out && python3 - side-$kind <<'CHECK'
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1] + "/results.csv")))
assert rows and all(abs(float(r["bias_all"]) - 1) < 0.1 for r in rows), [r["bias_all"] for r in rows]
CHECK
    result $? "$kind: what it names beside itself changed: the reference is made anew" "$(cat out)"
done

# The reference's cache: what is not a whole picture of this size is made again; what cannot be written costs nothing.
run experiment one.json -o s --cache cold
file=$(ls cold/*.exr)
sed 's/32x18/16x9/' one.json >small.json
run experiment small.json -o t --cache other
for damage in 'head -c 200 "$file" >cut; mv cut "$file"' ': >"$file"' 'cp other/*.exr "$file"'; do
    eval "$damage"
    run experiment one.json -o s --cache cold
    test $status = 0 && grep -q 'reference made' out && grep -q ' 0 of them made now' out && test ! -s err
    result $? "damaged by $damage"
done
rm "$file" && mkdir "$file"
run experiment one.json -o u --cache cold
test $status = 0 && grep -q ': 2 rows, 2 of them' out && grep -q 'warning: the reference is not kept' err
result $? "a reference that cannot be kept"

# A picture of nothing, a report that cannot be: told, and no half of it is left.
sed 's/"view": "own"/"eye": [0, 0, 50], "target": [0, 0, 90]/' one.json >black.json
run experiment black.json -o v --cache cache
test $status = 0 && grep -q '^nocturne: warning: one, own: the reference is black' err
result $? "a reference that is black is told"
mkdir -p x/1-one-own-alone-frames.svg
expect "a plot that cannot be written" 1 '^nocturne: x/1-one-own-alone-frames.svg: cannot be written: it is a dir' \
    experiment one.json -o x --cache cache
test ! -e x/report.md && test -z "$(ls -A x | grep '^\.')"; result $? "leaves no half of a report"

# Two at once in one cache; the second in one folder gives way.
for i in 1 2 3; do "$program" experiment one.json -o "at-once-$i" --cache shared >/dev/null 2>"err$i" </dev/null & done
wait
test "$(ls shared/*.exr | wc -l)" = 1 && test "$(ls shared | wc -l)" = 2 && ! cat err? | grep -q . &&
    ls at-once-[123]/report.md >/dev/null
result $? "three at once in one cache" "$(cat err?)"
if command -v flock >/dev/null; then
    mkdir busy
    flock busy "$program" experiment one.json -o busy --cache shared >out 2>err
    test $? = 1 && test "$(cat err)" = "nocturne: busy: another experiment is writing there"
    result $? "and not in one folder"
else
    skip "and not in one folder" "no flock here"
fi
finish
