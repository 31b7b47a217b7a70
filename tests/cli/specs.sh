#!/bin/sh
# Specs of experiments: presets, options without effect, and what goes wrong around a folder or a cache.
. "$(dirname "$0")/lib.sh"

# spec FILE CONFIGURATIONS [MEMBERS]: one camera before one lamp, one frame
spec() {
    cat >"$1" <<SPEC
{ "scene": { "name": "one", "inputs": ["builtin:single"] }, "cameras": [ { "name": "own", "view": "own" } ], "size": "32x18",
  "reference": { "rays": 1, "frames": 1 }, "frames": 1, "shown": [], ${3:-}
  "configurations": [ $2 ] }
SPEC
}

# A run's rows are known by a hash of its name and all of its options: equal options, no new rows.
spec preset.json '{ "name": "*", "preset": "*" }, { "name": "own", "shadow-rays": 2, "preset": "interactive" }'
spec spelled.json '{ "name": "still", "method": "ris", "candidates": "lists", "list": 64, "tail": 128, "shadow-rays": 8 },
    { "name": "interactive", "method": "ris", "candidates": "lists", "list": 32, "tail": 32, "shadow-rays": 4 },
    { "name": "own", "method": "ris", "candidates": "lists", "list": 32, "tail": 32, "shadow-rays": 2 }' 
run experiment preset.json -o p --cache cache
test $status = 0 && grep -q ': 6 rows, 6 of them made now' out; result $? "\"preset\": \"*\" is a configuration of each preset"
run experiment spelled.json -o p --cache cache
test $status = 0 && grep -q ': 6 rows, 0 of them made now' out; result $? "a preset is the options that it stands for; those beside it win, wherever it stands"
spec shared.json '{ "name": "a" }, { "name": "b", "shadow-rays": 2 }, { "name": "c", "preset": "still" }' '"options": { "tail": 48, "preset": "interactive" },'
run experiment shared.json -o q --cache cache
spec spelled.json '{ "name": "a" }, { "name": "b", "shadow-rays": 2 }, { "name": "c", "list": 64, "tail": 128, "shadow-rays": 8 }' \
    '"options": { "list": 32, "tail": 48, "shadow-rays": 4 },'
run experiment spelled.json -o q --cache cache
test $status = 0 && grep -q ': 6 rows, 0 of them made now' out; result $? "one for all configurations is overruled by their own"

# What changes nothing is told once, by where it stands; what counts in one configuration of an entry is not.
spec idle.json '{ "name": "is", "method": "is", "draws": 8 }, { "name": "*", "method": "ris", "candidates": ["power", "lists"], "draws": 8 },
    { "name": "p", "preset": "interactive", "candidates": "bvh", "uniform-every": 2 }' '"options": { "rays": 4, "list": 8, "passes": 2 },'
sed -i 's/"reference": { /"reference": { "tail": 3, /' idle.json
run experiment idle.json -o i --cache cache
cat >told <<'TOLD'
nocturne: warning: idle.json: options: passes has no effect: it needs method restir, not ris
nocturne: warning: idle.json: reference: tail has no effect: it needs method ris|restir, not reference
nocturne: warning: idle.json: configurations[0]: draws has no effect: it needs method ris|restir, not is
nocturne: warning: idle.json: configurations[2]: preset has no effect: it needs candidates lists, not bvh
TOLD
test $status = 0 && cmp -s told err; result $? "options that change nothing are warned of"
run experiment idle.json -o i --cache cache -q
test $status = 0 && test ! -s err; result $? "quiet says nothing of them"
spec wrong.json '{ "name": "fast", "preset": "fast" }'
expect "an unknown preset" 2 'wrong.json: configurations\[0\]: preset: "fast" is none of still\|interactive' experiment wrong.json -o w
spec wrong.json '{ "name": "a" }' '"equal-time": 3,'
expect "one time that is no array" 2 'wrong.json: equal-time: this must be an array of CPU seconds, such as' experiment wrong.json -o w
spec moving.json '{ "name": "a" }' '"equal-time": [1],'
sed 's/"view": "own"/"view": "own", "path": { "frames": 2, "pan": 1 }/' moving.json >wrong.json
expect "equal time of cameras that all move" 2 'wrong.json: equal-time: this needs a camera at rest' experiment wrong.json -o w
finish
