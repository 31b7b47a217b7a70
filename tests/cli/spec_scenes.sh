#!/bin/sh
# Scenes of specs: those left out where data is absent, what the report says they hold, cars that drive, the light view;
# and the specs of Hlavova's chapter 6, made small.
. "$(dirname "$0")/lib.sh"
export XDG_CACHE_HOME="$work/home"

# spec FILE SCENES [MEMBERS]: ris and restir over uniform candidates, one frame, once
spec() {
    cat >"$1" <<SPEC
{ "scenes": [ $2 ], "cameras": [ { "name": "own" } ], "size": "32x18",
  "reference": { "rays": 1, "frames": 1 }, "frames": 1, "repetitions": 1, "accumulate": false, ${3:-}
  "options": { "candidates": "uniform" },
  "configurations": [ { "name": "ris", "method": "ris" }, { "name": "restir", "method": "restir" } ] }
SPEC
}
cp "$source_dir/tests/cli/city.gml" .

# ---- absent inputs ----
one='{ "name": "one", "inputs": ["builtin:single"] }'
spec absent.json "{ \"name\": \"<gone>\", \"optional\": true, \"inputs\": [\"city.gml\", \"gone.gml\"] }, $one"
run experiment absent.json -o absent
test $status = 0 && test "$(cat err)" = \
    'nocturne: warning: absent.json: scenes[0]: "<gone>" is left out: gone.gml: No such file or directory'
result $? "an optional scene without its input is left out, with a warning"
grep -q '^Left out, because an input is absent: &lt;gone&gt; (gone.gml).$' absent/report.md &&
    test "$(cut -d, -f1 absent/results.csv | sort -u | tr '\n' ' ')" = "one scene "
result $? "the report lists it, and the others are measured"
spec lamps.json "{ \"name\": \"l\", \"optional\": true, \"inputs\": [\"city.gml\"], \"lamps\": [\"gone.csv\"] }, $one"
run experiment lamps.json -o lamps
test $status = 0 && grep -q 'is left out: gone.csv: No such' err; result $? "so is one whose lamps are absent"
printf 'nocturne: 1\ninputs: [away.gml]\n' >away.yaml
spec recipe.json "{ \"name\": \"r\", \"optional\": true, \"inputs\": [\"away.yaml\"] }, $one"
run experiment recipe.json -o recipe
test $status = 0 && grep -Eq 'is left out: (\./)?away.gml: No such' err
result $? "and one whose recipe names an absent input"
sed 's/"optional": true/"optional": false/' absent.json >wrong.json
expect "a scene that is not optional is an error" 1 '^nocturne: gone.gml: No such file' experiment wrong.json -o w
sed 's/gone.gml/./' absent.json >wrong.json
expect "an optional scene's folder, too" 1 '^nocturne: \.: Is a directory' experiment wrong.json -o w
spec all.json '{ "name": "gone", "optional": true, "inputs": ["gone.gml"] }'
expect "a spec whose scenes are all left out" 1 'nocturne: all.json: inputs of all its scenes are absent$' \
    experiment all.json -o w
test ! -e w; result $? "nothing is written after these errors"

# ---- what scenes hold ----
"$program" info --scene --json city.gml >info.json 2>err
"$program" info --scene --json builtin:city --city-size 200 --traffic >builtin.json
spec held.json '{ "name": "city", "inputs": ["city.gml"] },
    { "name": "built-in", "inputs": ["builtin:city"], "city-size": 200, "traffic": true }'
run experiment held.json -o held
python3 - <<'CHECK'
import json, re
report = open("held/report.md").read()
head = "| Scene | Buildings | Triangles | Windows | lit | Lamps | Cars | Lights | Memory |"
assert head in report
rows = {r[0]: r[1:] for r in ([c.strip() for c in l.split("|")[1:-1]] for l in report.splitlines()
                              if re.match(r"\| (city|built-in) \| [\d,]+ \| [\d,]+ \|", l))}
for name, path in ("city", "info.json"), ("built-in", "builtin.json"):
    s = json.load(open(path))["scene"]
    lamps = s["lamps_mapped"] + s["lamps_inferred"]
    assert name == "city" or lamps == next(g["lights"] for g in s["groups"] if g["name"] == "lamps") > 0
    want = [s["buildings"], s["triangles"] + s["instance_triangles"], s["windows"], s["windows_lit"], lamps, s["cars"],
            s["lights"]]
    got = [int(c.replace(",", "")) for c in rows[name][:7]]
    assert got == want, (name, got, want)
    assert want[1] and want[2] and want[6]
assert int(rows["built-in"][5]) > 1 and int(rows["city"][0]) >= 1, rows
CHECK
result $? "the report says what scenes hold, as info does"

# ---- cars ----
# Cars arrive in the last frame where cars at rest are: a method without history makes the same picture of both, and
# one with history does not.
for cars in rest drive; do
    fps=
    test $cars = drive && fps=', "fps": 30'
    spec $cars.json "{ \"name\": \"cars\", \"inputs\": [\"builtin:city\"], \"city-size\": 200, \"traffic\": true,
        \"cameras\": [ { \"name\": \"street\", \"view\": \"street\", \"path\": { \"frames\": 4$fps } } ] }"
    sed -i 's/32x18/96x54/' $cars.json
    run experiment $cars.json -o $cars
    cp err $cars.err
done
python3 - <<'CHECK'
import csv
rows = {(cars, r["configuration"]): r for cars in ("rest", "drive")
        for r in csv.DictReader(open(cars + "/results.csv"))}
same = lambda name: all(rows["rest", name][c] == rows["drive", name][c] for c in ("rmse8", "relmse", "rmse8_all"))
assert len(rows) == 4 and {r["frame"] for r in rows.values()} == {"4"}
assert same("ris") and not same("restir"), rows
CHECK
result $? "cars of a path arrive where the load has them, and were elsewhere before" "$(cat rest.err drive.err)"
sed 's/"traffic": true/"traffic": false/' drive.json >none.json
run experiment none.json -o none
test $status = 0 && test "$(cat err)" = \
    "nocturne: warning: cars, street: fps has no effect: the scene has no cars that drive"
result $? "fps without cars is warned of"
sed 's/"fps": 30/"fps": 0/' drive.json >wrong.json
expect "no frames a second" 2 'wrong.json: scenes\[0\]: cameras\[0\]: path: "?fps' experiment wrong.json -o w

# ---- the light view ----
spec light.json "$one" '"light-view": true, "shown": [1], "crop": [0, 0, 32, 18],'
run experiment light.json -o light
grep -q '^!\[Lights of frame 1\](1-one-own-light1.png)$' light/report.md &&
    grep -q "^Lights are those that .* reservoirs hold, .*; grey: none. The reference, " light/report.md
result $? "the light view of shown frames is in the report"
export PYTHONPATH="$source_dir/tests/cli" PYTHONDONTWRITEBYTECODE=1
cat >sheet.py <<'CHECK'
import glob
from png_rows import read
sheet = read("light/1-one-own-light1.png")
pictures = [read(path) for path in glob.glob("light/pictures/*-light1.png")]
assert len(pictures) == 2
panels = [[[sheet[22 + 10 * y][left + 10 * x] for x in range(32)] for y in range(18)] for left in (324, 648)]
assert sorted(pictures) == sorted(panels)
seen = [row[:320] for row in read("light/1-one-own-frame1.png")]
assert [row[:320] for row in sheet] == seen and len({c for row in seen[22:] for c in row}) > 2, "the reference, as seen"
# One light alone: its colour, and grey where nothing was chosen.
assert len({c for p in pictures for row in p for c in row}) == 2
CHECK
python3 sheet.py; result $? "a panel a configuration, in the colours of the view"
rm light/pictures/*-light1.png
run experiment light.json -o light
test $status = 0 && grep -q ': 2 rows, 0 of them made now' out && python3 sheet.py
result $? "views that were removed are made again, without new rows"

# ---- Hlavova's chapter 6 ----
# Each spec, at 32 x 18 px in a small built-in city, makes its table and its pictures.
: >file
for file in "$source_dir"/experiments/hlavova-*.json; do
    name=$(basename "$file" .json)
    python3 - "$file" $name.json <<'SMALL'
import json, sys
spec = json.load(open(sys.argv[1]))
spec["scenes"] = [dict(s, **{"city-size": 200}) for s in spec["scenes"] if s["inputs"] == ["builtin:city"]]
assert spec["scenes"] and all(s.get("optional") for s in json.load(open(sys.argv[1]))["scenes"]
                              if s["inputs"] != ["builtin:city"])
spec.update({"size": "32x18", "repetitions": 1, "reference": {"rays": 1, "frames": 1}})
if "crop" in spec:
    spec["crop"] = [0, 0, 32, 18]
json.dump(spec, open(sys.argv[2], "w"))
SMALL
    run experiment $name.json -o $name
    test $status = 0 && test ! -s err && python3 - $name <<'CHECK'
import csv, json, os, sys
name = sys.argv[1]
spec = json.load(open(name + ".json"))
rows = list(csv.DictReader(open(name + "/results.csv")))
configs = sum(max([1] + [len(v) for v in c.values() if isinstance(v, list)]) for c in spec["configurations"])
cameras = sum(len(s.get("cameras", spec.get("cameras"))) for s in spec["scenes"])
assert len({(r["scene"], r["camera"], r["configuration"]) for r in rows}) == cameras * configs, (cameras, configs)
sheets = [f for f in os.listdir(name) if f.endswith(".png")]
moving = any("path" in c for s in spec["scenes"] for c in s.get("cameras", []))
shown = 1 if moving else len(spec.get("shown", [1]))
assert len(sheets) == cameras * shown * (1 + bool(spec.get("light-view"))), sheets
CHECK
    result $? "$name makes its rows and pictures" "$(cat err)"
    run experiment "$file" -o file/w
    grep -v 'is left out: .*: No such file or directory$' err >said
    test $status = 1 && test "$(cat said)" = "nocturne: file/w: this folder cannot be used: Not a directory"
    result $? "$name is right as it is, and none of its options is without effect" "$(cat said)"
done
finish
