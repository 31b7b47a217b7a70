#!/bin/sh
# Built cities: the same picture as their inputs, with the recipe's cameras, and what is decided stays so.
. "$(dirname "$0")/lib.sh"
cp "$source_dir/tests/cli/city.gml" .
cat >city.yaml <<'END2'
nocturne: 1
name: "A \"city\""
inputs: [city.gml]
width: 48
height: 32
seed: 7
ev100: 2
auto-exposure: false
preset: interactive
windows: { lit: 0.9 }
cameras:
  air: { view: aerial }
  "near it": { eye: [20, -20, 30], target: [0, 0, 0], fov: 70 }
paths:
  flight:
    loop: on
    keys: [{ camera: air }, { eye: [20, -20, 30], target: [0, 0, 0], seconds: 2, hour: 23 }]
END2
same() { # "what" A B: all pixels are equal
    run compare "$2" "$3"
    grep -Eq 'all pixels +1,536 +0.000 +0 ' out
    result $? "$1"
}
draw() {
    out=$1
    shift
    run render "$@" -q --frames 2 -o "$out"
    result "$status" "draws $out of $1"
}
run build city.yaml -o city.noct
result "$status" "builds a city of a recipe"
grep -q 'scene .* triangles, .* lights, .* windows' out
result $? "and tells what is in it"
draw files.exr city.yaml
draw built.exr city.noct
same "a built city is the same picture" files.exr built.exr
draw files.exr city.yaml --camera "near it"
draw built.exr city.noct --camera "near it"
same "with the recipe's cameras" files.exr built.exr
draw files.exr city.yaml --window-lit 0.2 --hour 23
draw built.exr city.noct --window-lit 0.2 --hour 23
same "its windows are switched" files.exr built.exr
run render city.noct --animate --path flight --frames 2 --samples 1 -q -o 'f-%d.png'
result "$status" "with the recipe's paths"
run build city.noct --window-lit 0.2 -o again.noct -q
result "$status" "is built again of itself"
draw files.exr city.yaml --window-lit 0.2
draw built.exr again.noct
same "with windows as they were switched" files.exr built.exr
run render city.noct --frames 1 -q -o meta.png
python3 "$source_dir/tests/cli/png_text.py" meta.png >out
grep -q '^built-from: city.gml$' out && grep -q '^window-lit: 0.9$' out
result $? "metadata tell what it is built from, and how"
expect "a built city without a map" 2 '--environment-light needs a map around the city' render city.noct -o x.png \
    --environment-light
run render city.yaml --size 32x16 --frames 1 -q -o map.exr
run build city.yaml --environment map.exr -o sky.noct -q
draw sky.exr sky.noct --environment-light
expect "what is decided" 0 'warning: --lod has no effect: city.noct is built already' \
    render city.noct --lod 1 --frames 1 -o a.png
run info city.noct
grep -q 'built city, version 1' out && grep -q '^city.gml$' out && grep -q 'house\|two-points' out
result $? "info tells what it is built from"
run info --json city.noct
python3 -c 'import json
f = json.load(open("out"))["files"]
assert f[0]["format"] == "built city" and len(f) == 2' 
result $? "info tells it in JSON"
expect "another ending" 2 'must end in .noct' build city.yaml -o city.bin
expect "no output" 2 'where to' build city.yaml
expect "an input alone" 2 'both recipes, or built' render city.noct city.yaml -o a.png
expect "a mesh beside it" 1 'which is an input alone' render city.noct city.gml -o a.png
head -c 5000 city.noct >short.noct
expect "one that is cut short" 1 'short.noct: is damaged: it has 5000 bytes' render short.noct -o a.png
run build nothing.gml -o none.noct
[ "$status" = 1 ] && [ ! -e none.noct ] && [ -z "$(find . -name '*.part')" ]
result $? "a build that fails leaves nothing"
finish
