#!/bin/sh
# What nocturne bench prints holds together. No test asks for a time.
. "$(dirname "$0")/lib.sh"
tables='floor passes candidates lights windows triangles resolution threads isa memory'

: >all.json && chmod 600 all.json && ln -s all.json link.json
run bench --quick -q -o link.json
test $status = 0 && test ! -s err; result $? "a quick run of everything"
test -L link.json && test "$(stat -c %a all.json)" = 600
result $? "into a file that keeps its mode, behind a link" "$(stat -c '%n %a' ./*.json)"
why=
for name in $tables; do grep -Eq "^$name(:|\$)" out || why="$why $name"; done
[ -z "$why" ]; result $? "has every table" "$why"
test "$(awk 'length($0) > 120' out | wc -l)" = 0 && ! grep -q ' $' out; result $? "of lines that fit"
cat >look.py <<'PY'
import json, sys
d = json.load(open("all.json"))
methods = ["still", "interactive", "restir-uniform", "restir-influence", "restir-bias-rays", "restir-lists"]
t = d["tables"]
assert d["complete"] and d["inputs"] == ["builtin:city"] and d["scene"]["triangles"] > 1000 and d["nocturne"]
assert (d["width"], d["height"]) == (96, 54)
assert [(r["view"], r["name"]) for r in t["floor"]] == [(v, m) for v in ("street", "aerial") for m in methods]
every = [r for rows in t.values() for r in rows]
for r in every:
    assert r["frames"] >= 1 and r["wall_s"] > 0 and r["cpu_s"] > 0 and r["first_wall_s"] > 0, r
    assert abs(sum(p["share"] for p in r["passes"]) - 1) < 1e-9 and min(p["thread_s"] for p in r["passes"]) > 0, r
    assert r["rays_primary"] == r["width"] * r["height"] and r["picture_bytes"] > 16 * r["rays_primary"], r
    assert r["structure_bytes"] > r["triangles"] and r["scene_bytes"] > r["structure_bytes"], r
for r in t["floor"] + t["lights"] + t["windows"] + t["triangles"]:
    assert abs(r["floor_ratio"] - r["cpu_s"] / r["floor_cpu_s"]) < 1e-6 * r["floor_ratio"], r
    assert abs(r["floor_ratio_wall"] - r["wall_s"] / r["floor_wall_s"]) < 1e-6 * r["floor_ratio_wall"], r
for r in t["floor"]:
    for ratio in "floor_ratio", "floor_ratio_wall":
        assert d[ratio][r["view"]][r["name"]] == r[ratio]
    assert r["rays_shadow"] > 0 and ("list" in r["name"] or r["name"] in methods)
names = {r["name"]: {p["pass"] for p in r["passes"]} for r in t["floor"]}
assert "trace shared" in names["still"] and "spatial" in names["restir-uniform"], names
assert "spatial" not in names["interactive"] and "find lights" in names["restir-influence"], names
assert [r["name"] for r in t["candidates"]] == ["uniform", "power", "influence", "light-bvh"]
assert all(r["rays_shadow"] == 0 and r["candidates_per_thread_s"] > 1e3 for r in t["candidates"])
assert [r["lights"] for r in t["lights"]] == [1000, 10000]
off, on = t["windows"]
assert off["lights"] < on["lights"] == d["scene"]["lights"] and off["triangles"] == on["triangles"]
assert t["triangles"][0]["triangles"] > 5e4 and t["triangles"][1]["triangles"] > 2e5
assert t["resolution"][1]["rays_primary"] == 4 * t["resolution"][0]["rays_primary"]
assert [r["threads"] for r in t["threads"]][0] == 1
assert [r["name"] for r in t["isa"]][0] == "scalar" and t["isa"][0]["path"] == "scalar"
assert all(r["candidates_per_thread_s"] > 1e3 for r in t["isa"])
m = d["memory"]
assert m["peak_bytes"] > 1e7 and m["bytes_per_pixel"] > 16 and m["structure_bytes_per_triangle"] > 8
left = [(l["table"], l["why"]) for l in d["left_out"]]
assert all(table == "isa" for table, why in left), left
PY
python3 look.py 2>why; result $? "and its JSON holds together" "$(tail -n 1 why)"

# figures of the table are those of the JSON
python3 - <<'PY' 2>why
import json, re
d = json.load(open("all.json"))
text = open("out").read().split("\n\n")
floor = [part for part in text if part.startswith("floor:")][0]
told = [(m[1], float(m[2]), float(m[3])) for m in
        re.finditer(r"^    (\S+) +\S+ +\S+ +\S+ +\S+ +(\S+) +(\S+) .* 1\*$", floor, re.M)]
wanted = [(r["name"], r["floor_ratio"], r["floor_ratio_wall"]) for r in d["tables"]["floor"]]
near = lambda a, b: a[0] == b[0] and max(abs(a[i] - b[i]) for i in (1, 2)) < .006
assert len(told) == 12 and all(near(a, b) for a, b in zip(told, wanted)), told
assert "*: of fewer than three frames" in floor
for part in text:  # no two columns of a table have one name
    grows = re.match(r"(lights|windows|triangles|resolution|threads|isa):", part)
    head = re.split(r"  +", part.split("\n")[1].strip()) if grows else []
    assert len(head) == len(set(head)), head
PY
result $? "the table tells the same" "$(tail -n 1 why)"

printf 'v -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nf 4 3 2 1\n' >floor.obj
lamp_model
run bench lamp.obj --quick --json --only floor,windows,threads --threads 1 --size 32x16 --frames 2
python3 - <<'PY' 2>why
import json
d = json.load(open("out"))
assert set(d["tables"]) == {"floor", "windows", "threads"} and "memory" not in d and not d["tables"]["windows"]
assert [(l["table"], l["why"]) for l in d["left_out"]] == [("windows", "there are none")]
assert [r["threads"] for r in d["tables"]["threads"]] == [1] and d["inputs"] == ["lamp.obj"]
assert all(r["frames"] == 2 and (r["width"], r["height"]) == (32, 16) for r in d["tables"]["floor"])
PY
result $? "a model of one's own, some tables of it" "$(tail -n 1 why)"
run bench lamp.obj --quick --only windows --threads 1 --size 32x16
test $status = 0 && grep -q 'left out: windows: there are none' out && ! grep -q 'floor ms' out
result $? "a table without a row is a line"
run bench lamp.obj --only threads --threads 1 --size 32x16 --frames 4 --time 0
test $status = 0 && grep -Eq '^  1 .* 4$' out && ! grep -q 'fewer than three' out
result $? "rows say of how many frames"
run bench floor.obj --quick --only floor,candidates,memory
test $status = 0 && grep -q '^memory' out; result $? "a scene without a light"
run bench --quick --only passes
test $status = 0 && test "$(grep -cE '^[a-z]+: ' out)" = 1 && grep -q '^passes: ' out; result $? "passes alone"
run bench --quick --only lights,resolution --max-memory 0.000001 --json
python3 -c '
import json
d = json.load(open("out"))
assert [(l["table"], l["what"]) for l in d["left_out"]] == [("lights", "1,000 lights"), ("resolution", "96 x 54")]
assert all("memory" in l["why"] for l in d["left_out"]) and d["complete"]' 2>why
result $? "what has no room is left out, and told" "$(tail -n 1 why)"
run bench --only passes,lights --time 0.001
test $status = 0 && grep -q '^Pictures of 160 x 90, since time is short' out && ! grep -q '^  1,000 ' out &&
    test "$(grep -c 'left out: all of it: --time is over' out)" = 2
result $? "and what has no time"
run bench --only triangles --size 64x36 --time 1.5 --frames 1
test $status = 0 && grep -Eq 'left out: (.* triangles: would take about .* of|all of it:) --time' out # busy: the latter
result $? "or too little"
if [ -w /dev/full ]; then
    "$program" bench --quick --only isa >/dev/full 2>err
    test $? = 1 && grep -q 'standard output: cannot be written' err; result $? "a full disk is told"
fi

# Ctrl-C: tables that were complete are there, the one at work is not.
start bench --quick --only threads,isa --threads 1 --size 32x18 --frames 1000 --time 0 -o cut.json
until grep -qs '^threads' out || ! kill -0 $pid 2>/dev/null; do sleep 0.1; done
kill -INT $pid
wait $pid
status=$?
test $status = 130 && grep -q 'interrupted: ' err && ! grep -q '^isa' out; result $? "Ctrl-C ends it"
python3 -c '
import json
d = json.load(open("cut.json"))
assert not d["complete"] and list(d["tables"]) == ["threads"] and d["tables"]["threads"][0]["frames"] == 1000' 2>why
result $? "with what was complete" "$(tail -n 1 why)"
ls | grep -q new$; test $? = 1; result $? "and nothing half-written"
echo kept >kept.json
start bench --only floor --size 320x180 --frames 1000 --time 0 -o kept.json
until grep -qs '^Pictures' out || ! kill -0 $pid 2>/dev/null; do sleep 0.1; done
kill -INT $pid
wait $pid
status=$?
test $status = 130 && grep -q 'interrupted: ' err && test "$(cat kept.json)" = kept && ! ls kept.json.* 2>why
result $? "and leaves a file alone that it has nothing for"

expect "a table that is not there" 2 '^nocturne: --only: no table "flor"; is it floor' bench --only flor
expect "none at all" 2 'no table ""' bench --only floor,
expect "a size that is none" 2 'size: "big"' bench --size big
expect "and one that is too large" 2 'a side is 1 to' bench --size 1x9999999
expect "a method that is not there" 2 '^nocturne: --method' bench --method fast
expect "frames" 2 '^nocturne: --frames' bench --frames 0
expect "an option of an input that is not there" 2 'city-size is for the input builtin:city' bench lamp.obj \
    --city-size 200
expect "an input that is not there" 1 'gone.gml' bench gone.gml
expect "a folder for the figures that is not there" 1 'its folder no is not there' bench --quick -o no/a.json
expect "an input as output" 1 'is an input too' bench lamp.obj -o lamp.obj
: >empty.obj
run bench empty.obj
test $status = 1 && test ! -s out && grep -q '^nocturne: ' err; result $? "an input without a surface"

# ---- the Vulkan backend ----
if "$program" devices | grep -Eq '^vulkan [0-9]+ [a-z]+, [^:]*$'; then
    run bench builtin:city --city-size 150 --backend vulkan --only candidates --size 32x18 --frames 1 --json
    test $status = 0 && python3 - 2>why <<'CHECK'
import json
d = json.load(open("out"))
assert [r["name"] for r in d["tables"]["candidates"]] == ["uniform", "power", "influence", "light-bvh"], d["tables"]
assert all(r["candidates_per_thread_s"] > 0 for r in d["tables"]["candidates"]), d["tables"]
CHECK
    result $? "candidates of every kind are measured on the Vulkan device" "$(tail -n 1 why)"
else
    skip "candidates of every kind are measured on the Vulkan device" "no Vulkan device traces rays here"
fi
finish
