#!/bin/sh
# Scenes of specs: what the report says they hold.
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
    lamps = s["lamps_mapped"] + s["lamps_inferred"] or next(g["lights"] for g in s["groups"] if g["name"] == "lamps")
    want = [s["buildings"], s["triangles"] + s["instance_triangles"], s["windows"], s["windows_lit"], lamps, s["cars"],
            s["lights"]]
    got = [int(c.replace(",", "")) for c in rows[name][:7]]
    assert got == want, (name, got, want)
    assert want[1] and want[2] and want[6]
assert int(rows["built-in"][5]) > 1 and int(rows["city"][0]) >= 1, rows
CHECK
result $? "the report says what scenes hold, as info does"
finish
