#!/bin/sh
# The laboratory: rows, resuming, the reference's cache, report and plots, and what is wrong with a spec.
. "$(dirname "$0")/lib.sh"
cat >spec.json <<'SPEC'
{
  "scene": { "name": "city", "inputs": ["builtin:city"], "city-size": 150 },
  "cameras": [ { "name": "street", "view": "street" },
               { "name": "up <&> \"high\"", "eye": [0, -60, 90], "target": [0, 0, 0], "fov": 60 } ],
  "size": "48x32", "frames": 3, "repetitions": 2,
  "reference": { "rays": 8, "frames": 2 },
  "configurations": [ { "name": "is|", "method": "is" }, { "name": "ris, *", "method": "ris", "candidates": "*" } ]
}
SPEC

# rows FOLDER [FRAMES]: the table without times and memory (Embree's blocks are of the threads that build), sorted;
# fails where a row has not as many fields as the header
rows() {
    python3 -c '
import csv, sys
table = list(csv.reader(open(sys.argv[1] + "/results.csv")))
assert all(len(row) == len(table[0]) for row in table)
drop = [i for i, name in enumerate(table[0]) if name in ("wall_s", "cpu_s", "wall_total_s", "cpu_total_s", "build_s",
                                                         "light_build_s",
        "light_volumes_s", "light_tuning_s", "light_hierarchy_s", "light_boxes_s", "memory_bytes", "scene_bytes")]
frame = table[0].index("frame")
last = int(sys.argv[2]) if len(sys.argv) > 2 else 1 << 30
for row in [table[0]] + sorted(r for r in table[1:] if int(r[frame]) <= last):
    print([v for i, v in enumerate(row) if i not in drop])' "$@"
}

run experiment spec.json -o a --cache cache
choices=$("$program" help render | tr -s '\n ' ' ' | grep -o 'candidates come from: [a-z|-]*' | sed 's/.*: //' |
    tr '|' '\n' | grep -c .)
expected=$((2 * 2 * (1 + choices) * 3 * 2)) # cameras, repetitions, configurations, frames, modes
rows a >a.rows
test $status = 0 && test "$(wc -l <a/results.csv)" = $((expected + 1)) && test "$choices" -ge 2 && test -s a.rows
result $? "one row a configuration, camera, repetition, frame and mode; \"*\" is each choice" \
    "$(wc -l <a/results.csv), not $((expected + 1))"
columns='scene,camera,configuration,repetition,mode,frame,seed,backend,device,reference'
columns="$columns,wall_s,cpu_s,.*relmse_clamped,bias.*,build_s,memory"
head -n 1 a/results.csv | grep -q "^$columns"
result $? "the header names the columns"
python3 - <<'CHECK'
import csv
rows = list(csv.DictReader(open("a/results.csv")))
of = lambda **want: [r for r in rows if all(r[k] == v for k, v in want.items())]
# Times add up, the first frame is its own mean, repetitions differ, and lists beat plain sampling from the first frame
# on.
for r in rows:
    if r["frame"] == "1":
        assert r["cpu_s"] == r["cpu_total_s"]
        other = of(key=r["key"], frame="1", mode="alone")[0]
        assert abs(float(other["relmse"]) - float(r["relmse"])) <= 1e-6 * float(r["relmse"])
    else:
        before = of(key=r["key"], mode=r["mode"], frame=str(int(r["frame"]) - 1))[0]
        assert abs(float(before["cpu_total_s"]) + float(r["cpu_s"]) - float(r["cpu_total_s"])) < 1e-7
one, two = (of(configuration="is|", camera="street", repetition=n, frame="3", mode="accumulated")[0] for n in "12")
assert one["relmse"] != two["relmse"] and one["seed"] != two["seed"]
error = lambda name: sum(float(r["rmse8"]) for r in of(configuration=name, camera="street", frame="1", mode="alone"))
assert error("ris, lists") < 0.8 * error("is|"), (error("ris, lists"), error("is|"))
CHECK
result $? "times add up, repetitions have their own seeds, and the figures tell methods apart"

# A figure of the table is what compare says of the pictures that are kept.
key=$(python3 -c 'import csv
print([r["key"] for r in csv.DictReader(open("a/results.csv")) if r["camera"] == "street"][0])')
for reference in cache/*.exr; do "$program" compare --json "a/pictures/$key-frame1.exr" "$reference"; done >compared
python3 -c '
import csv, re
row = [r for r in csv.DictReader(open("a/results.csv")) if r["key"] == "'"$key"'" and r["frame"] == "1"][0]
said = [float(x) for x in re.findall(r"\"no_emitter\": .*?\"relmse\": ([^,]*)", open("compared").read())]
assert any(abs(float(row["relmse"]) - x) < 1e-6 * x for x in said), (row["relmse"], said)'
result $? "its figures are those of nocturne compare"

# The report: its links lead somewhere, plots are XML with a curve for each configuration, crops are whole.
links=$(grep -o '](\([^)]*\))' a/report.md | sed 's/^](//; s/)$//' | sort -u)
missing=
for link in $links; do [ -s "a/$link" ] || missing="$missing $link"; done
test -z "$missing" && test "$(echo "$links" | grep -c '\.svg$')" = 8 && test "$(echo "$links" | grep -c '\.png$')" = 2
result $? "report.md links to eight plots and two sheets of crops, which are there" "$missing $links"
grep -q '^| is\\| | ' a/report.md && grep -q -- 'experiment spec.json -o a --cache cache' a/report.md
result $? "names are escaped in it, and the command is told"
python3 - "$((1 + choices))" a/[0-9]*.svg <<'CHECK'
import sys, xml.etree.ElementTree as tree
svg = "{http://www.w3.org/2000/svg}"
for path in sys.argv[2:]:
    root = tree.parse(path).getroot()
    lines = root.findall(".//" + svg + "polyline")
    assert len(lines) == int(sys.argv[1]), path
    width, height = (float(root.get(k)) for k in ("width", "height"))
    for line in lines:
        points = [tuple(map(float, p.split(","))) for p in line.get("points").split()]
        assert len(points) == 3 and all(0 < x < width and 0 < y < height for x, y in points), (path, points)
    text = "|".join("".join(t.itertext()) for t in root.iter(svg + "text"))
    assert "is|" in text and "ris, lists" in text and ("frame" in text or "seconds" in text), text
CHECK
result $? "plots are well-formed, with a curve and a name for each configuration"
python3 - "$choices" <<'CHECK'
import csv, re, sys, xml.etree.ElementTree as tree
svg, choices = "{http://www.w3.org/2000/svg}", int(sys.argv[1])
bars = tree.parse("a/frame-times.svg").getroot()
widths = [float(r.get("width")) for r in bars.iter(svg + "rect") if (r.get("class") or "")[0] == "m"]
assert len(widths) == 2 * (1 + choices) and all(w > 0 for w in widths), widths
dots = [p for p in tree.parse("a/errors.svg").getroot().iter(svg + "path")
        if re.match("[lm][0-9]( paper)?$", p.get("class") or "")]
assert len(dots) == 2 * 3 * (1 + choices) + 1 + choices, len(dots) # cameras, frames; and the legend
# The table of one option's values: a cell is the errors of the first frame, the last, the mean of all, by the mean of
# seeds.
rows = list(csv.DictReader(open("a/results.csv")))
def error(mode, frame):
    found = [float(r["relmse_clamped"]) for r in rows if r["camera"] == "street" and
             r["configuration"] == "ris, uniform" and
             r["mode"] == mode and r["frame"] == frame]
    assert len(found) == 2
    return "%.2g \u00b1 %.2g" % (sum(found) / 2, abs(found[0] - found[1]) / 2)
line = [l for l in open("a/summary.md") if l.startswith("| ris |")][0]
assert line.split("|")[2].split("\u00b7")[0].strip() == " / ".join((error("alone", "1"), error("alone", "3"),
                                                                    error("accumulated", "3"))), line
CHECK
result $? "charts have a bar and dots for each configuration and camera; summary.md tells the same figures"
if command -v xmllint >/dev/null; then
    xmllint --noout a/*.svg 2>err
    result $? "xmllint agrees"
else
    skip "xmllint agrees" "no xmllint here"
fi
sheet=$(for f in a/*.png; do meta "$f" size; done | sort -u)
panels=$((2 + choices)) rows=$(((2 + choices + 3) / 4)) # of four panels at most, as many in each as can be
columns=$(((panels + rows - 1) / rows))
test "$sheet" = "$((columns * 320 + (columns - 1) * 4)) $((rows * (22 + 220 + 4) - 4))"
result $? "crops: the reference and each configuration, a third of the picture enlarged, each under its name" "$sheet"

grep -q "^With n = 2, 95 % of such means lie within 12.7 standard errors (Student's t): " a/report.md
result $? "two repetitions are told to be few"
grep -q '^| ris, lists | .*`method ris`, `candidates lists` |' a/report.md && grep -q '^| is.*`method is` |' a/report.md
result $? "method and candidates are named, defaults or not" "$(grep '`method' a/report.md | head -n 3)"
grep -Eq "^The reference's own noise is a relMSE of about 0\.[0-9]+, clamped 0\.[0-9]+:" a/report.md
result $? "the reference's own noise is told"

# Its estimate holds: ris of many candidates against a reference that is as good as true.
sed 's/"rays": 8, "frames": 2/"rays": 256, "frames": 40/; s/"repetitions": 2/"repetitions": 1/
    s/"frames": 3/"frames": 8/
    s/{ "name": "is|".*/{ "name": "rays", "method": "reference", "rays": 64 } ]/' spec.json >noise.json
sed 's/"rays": 256, "frames": 40/"rays": 64, "frames": 8/' noise.json >noisy.json
run experiment noise.json -o n --cache cache
run experiment noisy.json -o m --cache cache
python3 - <<'CHECK'
import csv, re
rows = [r for r in csv.DictReader(open("n/results.csv")) if r["mode"] == "accumulated" and r["frame"] == "8"]
told = [float(x) for x in re.findall(r"about (\S+), clamped", open("m/report.md").read())]
assert len(rows) == len(told) == 2
for row, estimate in zip(rows, told):
    assert 0.3 < estimate / float(row["relmse"]) < 3, (estimate, row["relmse"])
CHECK
result $? "and it is what the same rays are off from a far better reference"

# Again: nothing is measured, the reference is not made.
before=$(ls -i --full-time cache) table=$(cksum <a/results.csv)
run experiment spec.json -o a --cache cache
test $status = 0 && grep -q ', 0 of them made now' out && test "$(cksum <a/results.csv)" = "$table"
result $? "finished rows are not made again"
test "$(grep -c 'reference from cache/' out)" = 2 && test "$before" = "$(ls -i --full-time cache)"
result $? "nor is the reference"

# Killed while a line was being written, in the middle of a run; a picture deleted.
cp -r a b
head -c $(($(head -n 12 a/results.csv | wc -c) + 70)) a/results.csv >b/results.csv
rm "b/pictures/$key-frame1.exr"
run experiment spec.json -o b --cache cache
rows b >b.rows
test $status = 0 && cmp -s a.rows b.rows && grep -q " $((expected - 11)) of them made now" out &&
    test -s "b/pictures/$key-frame1.exr"
result $? "after a kill the rest is made, and the rows are the same" "$(diff a.rows b.rows | head -n 5 | tr '\n' ' ')"
test "$(head -n 12 a/results.csv)" = "$(head -n 12 b/results.csv)"
result $? "those that were there are kept as they were"

# stop SIGNAL COMMAND ARGUMENT...: starts an experiment, sends it the signal once the command succeeds; its status in
# $status
stop() {
    signal=$1 reached=$2
    shift 2
    start experiment "$@"
    tries=0
    until eval "$reached" || ! kill -0 $pid 2>/dev/null; do
        tries=$((tries + 1))
        [ $tries -gt 15000 ] && break # against hangs alone
        sleep 0.02
    done
    kill -"$signal" $pid 2>/dev/null
    wait $pid 2>/dev/null
    status=$?
}
# more_rows FOLDER N: its table has more lines than that
more_rows() { [ "$(cat "$1/results.csv" 2>/dev/null | wc -l)" -gt "$2" ]; }

# Ctrl-C in the middle of 20000 frames.
sed 's/"frames": 3/"frames": 20000/; s/"repetitions": 2/"repetitions": 1/' spec.json >long.json
mkdir c
stop INT 'more_rows c 12' long.json -o c --cache cache
told=$(sed -n 's/.*interrupted: \([0-9,]*\) rows in c.results.csv; the same command goes on there/\1/p' err | tr -d ,)
test $status = 130 && test "$told" = $(($(wc -l <c/results.csv) - 1)) && test ! -e c/report.md
result $? "Ctrl-C keeps the rows, and says how to go on"
sed 's/"repetitions": 2/"repetitions": 1/' spec.json >short.json
run experiment short.json -o c --cache cache
rows c 3 >c.rows
run experiment short.json -o d --cache cache
rows d 3 >d.rows
cmp -s c.rows d.rows; result $? "and it does, to the same rows" "$(diff c.rows d.rows | head -n 5 | tr '\n' ' ')"

# Ctrl-C while a reference is made: what is lost is told.
sed 's/"rays": 8, "frames": 2/"rays": 64, "frames": 100000/' short.json >endless.json
stop INT "grep -qs 'reference, about' out" endless.json -o lost --cache cache
test $status = 130 && grep -Eq 'goes on there, but begins this reference anew: the [0-9,]+ frames? of 100000 that' err
result $? "Ctrl-C in a reference says that its frames are lost" "$(cat err)"

# Other settings under the same names: their rows are not mixed.
sed 's/"method": "is"/"method": "is", "emitters": false/' short.json >other.json
run experiment other.json -o d --cache cache
test $status = 0 && grep -q '12 rows of results.csv came from other settings' err &&
    test "$(wc -l <d/results.csv)" = $((expected / 2 + 1)) &&
    test "$(wc -l <d/results.old.csv)" = $((expected / 2 + 13))
result $? "rows of other settings are put aside"
test "$(ls d/pictures | wc -l)" = $((expected / 12)); result $? "and their pictures deleted" "$(ls d/pictures | wc -l)"
for f in cache/*.exr; do head -c 300 "$f" >cut && cp cut "$f"; done
run experiment short.json -o e --cache cache
rows e >e.rows
test $status = 0 && test "$(grep -c 'reference made' out)" = 2 && cmp -s d.rows e.rows && test ! -s err
result $? "a damaged reference is made again"

# Killed outright: in the reference, then among the rows of a run that CPU seconds end. It goes on to the same end.
cat >kill.json <<'SPEC'
{
  "scenes": [ { "name": "single", "inputs": ["builtin:single"], "cameras": [ { "name": "own", "view": "own" } ] },
              { "name": "city", "inputs": ["builtin:city"], "city-size": 150 } ],
  "cameras": [ { "name": "at rest", "view": "street", "path": { "frames": 4 } },
               { "name": "walk", "view": "street", "path": { "frames": 4, "dolly": [0, 1, 0], "pan": 10 } },
               { "name": "cut", "view": "street", "path": { "frames": 4, "cut": 3, "before": { "view": "aerial",
               "fov": 30 } } } ],
  "size": "48x32", "seconds": 0.3, "repetitions": 1, "shown": [1, 3],
  "reference": { "rays": 64, "frames": 4 },
  "configurations": [ { "name": "ris", "method": "ris", "learn": false }, { "name": "restir, M *",
  "method": "restir", "candidates": "power", "draws": [1, 8] },
                      { "name": "two frames", "frames": 2, "seconds": 0 } ]
}
SPEC
stop KILL '[ -d kcache ]' kill.json -o k --cache kcache
stop KILL 'more_rows k 5' kill.json -o k --cache kcache
before=$(($(wc -l <k/results.csv) - 1))
head -n $before k/results.csv >k.before
stop KILL 'more_rows k 90' kill.json -o k --cache kcache
run experiment kill.json -o k --cache kcache
test $status = 0 && test "$before" -ge 5 && test "$(head -n $before k/results.csv | cksum)" = "$(cksum <k.before)"
result $? "killed outright, three times: rows stay, and the rest is made"
run experiment kill.json -o k --cache kcache
test $status = 0 && grep -q ' 0 of them made now' out; result $? "and then there is no more to make" "$(cat out)"
run experiment kill.json -o l --cache kcache
python3 - <<'CHECK'
import csv
read = lambda folder: list(csv.DictReader(open(folder + "/results.csv")))
k, l = read("k"), read("l")
of = lambda rows, **want: [r for r in rows if all(r[n] == v for n, v in want.items())]
telling = ("scene", "camera", "configuration", "mode", "frame")
assert len({tuple(r[n] for n in telling) for r in k}) == len(k), "a row twice"
for name in ("ris", "restir, M 1", "restir, M 8"):
    for mode in ("alone", "accumulated"):
        mine = of(k, scene="single", configuration=name, mode=mode)
        spent = [float(r["cpu_total_s"]) for r in mine]
        assert spent == sorted(spent) and spent[-1] >= 0.3 and all(t < 0.3 for t in spent[:-1]), (name, mode, spent)
        frames = [int(r["frame"]) for r in mine]
        assert frames[:16] == list(range(1, 17)), frames
assert {r["frame"] for r in of(k, scene="single", configuration="two frames")} == {"1", "2"}
# Moving cameras: the last frame alone, the same to the last digit in both folders; ris takes nothing from before,
# restir does.
moving = of(k, scene="city")
assert len(moving) == 3 * 4 and all(r["frame"] == "4" and r["mode"] == "alone" for r in moving), len(moving)
for r in moving:
    other = of(l, **{n: r[n] for n in telling})
    assert len(other) == 1 and other[0]["relmse"] == r["relmse"] and other[0]["key"] == r["key"], r
error = lambda camera, name: [r["relmse"] for r in moving if r["camera"] == camera and r["configuration"] == name]
assert error("at rest", "ris") == error("walk", "ris") == error("cut", "ris")
assert len({error(camera, "restir, M 8")[0] for camera in ("at rest", "walk", "cut")}) == 3
assert float(error("at rest", "restir, M 1")[0]) < float(error("cut", "restir, M 1")[0])
CHECK
result $? "runs end with their CPU seconds, sweeps have their values, and motion ends at the camera's place"
test "$(ls kcache/*.exr | wc -l)" = 2; result $? "all motions share one reference" "$(ls kcache)"
grep -q '^| restir, M |' k/summary.md && grep -q '(2-city-at-rest-frame4.png)' k/report.md &&
    grep -q '(1-single-own-frame3.png)' k/report.md
result $? "summary.md has a column a value, report.md the frames shown"
python3 - <<'CHECK'
import csv, re
rows = [r for r in csv.DictReader(open("k/results.csv")) if r["scene"] == "single"]
report = open("k/report.md").read().split("\n## ")[1]
tables = re.findall(r"^\| relMSE, frame \|(.*)\n\|[-:|]*\n((?:\|.*\n)*)", report, re.M)
assert len(tables) == 2
for mode, (head, body) in zip(("accumulated", "alone"), tables):
    columns = [c.strip() for c in head.split("|")[:-1]]
    cells = {line[0].strip(): [c.strip() for c in line[1:]]
             for line in (row.split("|")[1:-1] for row in body.splitlines())}
    assert columns[:2] == ["1", "2"] and columns[-1] == "last" and len(cells) == 4, (columns, cells)
    told = lambda name, frame: ["%.3g" % float(r["relmse"]) for r in rows
                                if (r["configuration"], r["mode"], r["frame"]) == (name, mode, frame)]
    for name, values in cells.items():
        last = max(int(r["frame"]) for r in rows if (r["configuration"], r["mode"]) == (name, mode))
        assert values[-1] == "%s (%d)" % (told(name, str(last))[0], last), (name, values)
        for frame, value in zip(columns[:-1], values):
            assert [value] == (told(name, frame) or ["-"]), (name, frame, value)
    assert all(any(v[i] != "-" for v in cells.values()) for i in range(len(columns))), cells
assert report.count("\nlast: each configuration's own last frame, its number in brackets. -: the run had ended") == 2
CHECK
result $? "report.md tells each run's own last frame, and has no column of nothing"
sed 's/48x32/32768x32768/' kill.json >huge.json
if (ulimit -v 20000000 && "$program" --version) >out 2>err; then
    (ulimit -v 20000000; "$program" experiment huge.json -o w --cache kcache) >out 2>err
    test $? = 1 && grep -q '^nocturne: no memory for pictures of 32768 x 32768' err && test "$(wc -l <err)" = 1
    result $? "an absurd size is one error at once"
else
    skip "an absurd size is one error at once" "address space cannot be limited for this build"
fi

# wrong NAME PATTERN SED: the spec with one thing wrong
wrong() {
    sed "$3" spec.json >wrong.json
    expect "$1" 2 "^nocturne: wrong.json$2" experiment wrong.json -o w --cache cache
}
wrong "JSON that breaks off, with its line" ':5:' 's/"size": /"size" /'
wrong "a member given twice" ':5:.*duplicate' 's/"frames": 3/"frames": 3, "frames": 4/'
wrong "an unknown option, with the nearest" ': configurations\[1\]: no option "candidatse"; is it "candidates"\?' \
    's/"candidates"/"candidatse"/'
wrong "an unknown member" ': no option "framse"; is it "frames"\?' 's/"frames": 3/"framse": 3/'
wrong "an unknown choice" ': configurations\[0\]: method: "iss" is none of reference' 's/"is" }/"iss" }/'
wrong "a number out of range" ': reference: rays: "0" is outside 1 to 1024' 's/"rays": 8/"rays": 0/'
wrong "an array that is none of the choices" ': configurations\[1\]: candidates: "of" is none of uniform' \
    's/"candidates": "\*"/"candidates": ["lists", "of"]/'
wrong "two options of several values" ': configurations\[1\]: one option may have several values' \
    's/"candidates": "\*"/"candidates": "*", "bias": "*"/'
wrong "what is no value" ': configurations\[0\]: method: this cannot be its value' 's/"is" }/{} }/'
wrong "a size that is none" ': size: "48" is not' 's/48x32/48/'
wrong "two configurations of one name" ': configurations: the name "is\|" is given twice' \
    's/"ris, \*", "method": "ris", "candidates": "\*"/"is|", "method": "ris"/'
wrong "a configuration without a name" ': configurations\[0\]: it needs a name' 's/"name": "is|",//'
wrong "a camera with eye alone" ': cameras\[1\]: eye and target' 's/, "target": \[0, 0, 0\]//'
wrong "no scene" ': it needs one of scene' '/"scene"/d'
wrong "options of a city that is not drawn" ': scene: city-size is for' 's/builtin:city/city.gml/'
wrong "configurations that are no list" ': it needs scenes and configurations' \
    's/"configurations".*/"configurations": 3/'
wrong "measured frames that fall" ': measured: frames are whole' 's/"frames": 3,/"frames": 3, "measured": [4, 2],/'
wrong "shown frames that are no list" ': shown: this must be an array' 's/"frames": 3,/"frames": 3, "shown": 4,/'
wrong "a path without frames" ': cameras\[0\]: path: it needs frames' \
    's/"view": "street"/"view": "street", "path": { "orbit": 3 }/'
wrong "a cut from nowhere" ': cameras\[0\]: path: cut and before' \
    's/"view": "street"/"view": "street", "path": { "frames": 3, "cut": 2 }/'
wrong "a cut after the last frame" ': cameras\[0\]: path: cut: frames' \
    's/"view": "street"/"view": "street", "path": { "frames": 3, "cut": 3, "before": {} }/'
wrong "a dolly that is none" ': cameras\[0\]: path: dolly is' \
    's/"view": "street"/"view": "street", "path": { "frames": 3, "dolly": [1, 2] }/'
wrong "no cameras" ': it needs cameras' '/"cameras"/,/fov/d'
wrong "too many rows" ': it asks for more than' 's/"frames": 3/"frames": 100000/'
echo '[1]' >wrong.json
expect "a spec that is no object" 2 'one object' experiment wrong.json -o w
: >wrong.json
expect "an empty spec" 2 'wrong.json:1:' experiment wrong.json -o w
expect "a spec that is not there" 1 '^nocturne: .*missing.json.*No such file' experiment missing.json -o w
expect "a folder as spec" 1 'not a regular file' experiment . -o w
expect "no spec" 2 'one spec' experiment -o w
test ! -e w; result $? "nothing is written after an error"
sed 's/"builtin:city"\], "city-size": 150/"gone.gml"]/' spec.json >gone.json
expect "an input that is not there" 1 'gone.gml' experiment gone.json -o w --cache cache
: >file
expect "a folder that cannot be" 1 'file/w: this folder cannot be used: Not a directory' experiment spec.json \
    -o file/w --cache cache
expect "a cache that cannot be" 1 'file: this folder cannot be used' experiment spec.json -o w --cache file
for spec in "$source_dir"/experiments/*.json; do
    # The ready specs are right up to their folder, which cannot be made; one wants an input to be made first.
    test "$(basename "$spec")" != obj-city.json || test -e "$source_dir/build/city.obj" || continue
    if grep -q '/cities/' "$spec" && ! test -d "${NOC_SHARED:-}/data"; then
        skip "$(basename "$spec") is right" "shared/data is not here"
        continue
    fi
    expect "$(basename "$spec") is right" 1 'file/w: this folder' experiment "$spec" -o file/w
done

# ---- lamps in files of their own ----
mkdir town
cp "$source_dir/tests/cli/city.gml" town/city.gml
printf 'lat,lon,power\n48.76,11.42,70\n48.7601,11.4201,100\n' >town/plain.csv
cat >town/lamps.json <<'SPEC'
{ "scene": { "name": "town", "inputs": ["city.gml"], "lamps": ["plain.csv"], "lamp-columns": ["watts=power"],
             "windows": false },
  "cameras": [ { "name": "a", "view": "aerial" } ], "size": "32x16", "frames": 1, "repetitions": 1,
  "reference": { "rays": 2, "frames": 1 }, "configurations": [ { "name": "is", "method": "is" } ] }
SPEC
run experiment town/lamps.json -o town/results --cache cache
test $status = 0 && grep -Eq '^\| town .*\| 2 \|' town/results/report.md
result $? "a spec's lamps are read beside its folder's city, with their columns" \
    "$(grep '^| town' town/results/report.md | head -1)"

finish
