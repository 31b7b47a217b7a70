#!/bin/sh
# Recipes: the same picture as by the same words, and the words win.
. "$(dirname "$0")/lib.sh"
cp "$source_dir/tests/cli/city.gml" .
mkdir -p sub
cat >sub/city.yaml <<'END'
nocturne: 1
inputs: [../city.gml]
width: 48
height: 32
seed: 7
ev100: 2
auto-exposure: false
lamps: { lumens: 9000 }
cameras:
  air: { view: aerial }
  near: { eye: [20, -20, 30], target: [0, 0, 0] }
END
say="--size 48x32 --seed 7 --exposure 2 --lamp-lumens 9000 --view aerial"
same() { cmp -s "$2" "$3"; result $? "$1"; }
differ() { ! cmp -s "$2" "$3"; result $? "$1"; }
draw() {
    out=$1
    shift
    run render "$@" -q --frames 2 -o "$out"
    result "$status" "draws $out"
}
# shellcheck disable=SC2086 # a list of words
draw words.exr city.gml $say
draw recipe.exr sub/city.yaml
same "a recipe is the same picture as its words" words.exr recipe.exr
draw brighter.exr sub/city.yaml --lamp-lumens 18000
differ "a word wins over the recipe" recipe.exr brighter.exr
draw size.exr sub/city.yaml --size 24x16
differ "--size wins over width and height" recipe.exr size.exr
draw near.exr sub/city.yaml --camera near
differ "a camera by name" recipe.exr near.exr
draw eye.exr sub/city.yaml --eye 20,-20,30 --target 0,0,0
run compare near.exr eye.exr
grep -Eq 'all pixels +1,536 +0.000 +0 ' out
result $? "an eye wins over the recipe's cameras"
printf 'materials: { ground: { albedo: 0.9 }, terrain: { albedo: 0.9 } }\n' | cat sub/city.yaml - >sub/white.yaml
draw white.exr sub/white.yaml
differ "materials of a class" recipe.exr white.exr
expect "an unknown camera" 2 'has no camera "nera"; is it near\?' render sub/city.yaml --camera nera -o a.png
expect "a camera without a recipe" 2 'for a recipe among the inputs' render city.gml --camera near -o a.png
expect "a camera and a view" 2 'exclude each other' render sub/city.yaml --camera near --view street -o a.png
expect "two recipes" 2 'both recipes' render sub/city.yaml sub/white.yaml -o a.png
printf 'nocturne: 1\ninputs: [none.gml]\n' >none.yaml
expect "an input that is not there" 1 'none.gml' render none.yaml -o a.png
printf 'nocturne: 1\ninputs: [city.gml]\nlod: 12\n' >bad.yaml
expect "a wrong value" 1 'bad.yaml:3: lod: "12" is outside 0 to 4' render bad.yaml -o a.png
run info sub/city.yaml
grep -q 'CityGML' out
result $? "info tells of a recipe's inputs"
finish
