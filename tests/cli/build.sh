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
pixels() { # of a PNG, with nothing beside them
    python3 -c 'import sys
d = open(sys.argv[1], "rb").read()
at, out = 8, b""
while at < len(d):
    n = int.from_bytes(d[at:at + 4], "big")
    out += d[at + 8:at + 8 + n] if d[at + 4:at + 8] in (b"IHDR", b"IDAT") else b""
    at += n + 12
assert len(out) > 100
sys.stdout.buffer.write(out)' "$1"
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
for threads in 1 3; do
    run build city.yaml -q --threads $threads -o again.noct
    test "$status" = 0 && cmp -s city.noct again.noct
    result $? "the same bytes, built again on $threads threads"
done
draw files.exr city.yaml
draw built.exr city.noct
same "a built city is the same picture" files.exr built.exr
draw files.exr city.yaml --camera "near it"
draw built.exr city.noct --camera "near it"
same "with the recipe's cameras" files.exr built.exr
draw files.exr city.yaml --window-lit 0.2 --hour 23
draw built.exr city.noct --window-lit 0.2 --hour 23
same "its windows are switched" files.exr built.exr
# What may be said of a built city does what it does to its inputs, and what may not is refused.
cat >rain.yaml <<'END2'
nocturne: 1
inputs: [city.gml]
materials: { terrain: { albedo: 0.6 }, wall: { albedo: 0.7, f0: 0.1, roughness: 0.3 } }
groups: { warm: { match: { class: window }, kelvin: 2200, scale: 0.5 } }
windows: { lit: 0.8 }
width: 48
height: 32
END2
run build rain.yaml -q -o rain.noct
draw plain.exr rain.noct
set -- '--wet' '--group warm=off' '--group warm=0.2,5000K' '--group warm=own' '--window-lit 1' '--window-lit 0' \
    '--hour 3' '--window-lit 0.5 --hour 19.5' '--wet --hour 23' '--sky 0.4' '--sky 0' '--seed 9' '--no-emitters' \
    '--environment sky.hdr --environment-light' '--environment sky.hdr --environment-lux 5 --environment-rotation 90' \
    '--exposure 3' '--view aerial' '--fov 30' '--method restir' '--show class' '--show group'
printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\200\100\040\200\040\100\200\201' >sky.hdr
for options in "$@"; do
    # shellcheck disable=SC2086
    run render rain.yaml $options -q --frames 2 -o files.png &&
        run render rain.noct $options -q --frames 2 -o built.png
    test "$status" = 0 && pixels files.png >files.sum && pixels built.png | cmp -s - files.sum
    result $? "a built city with $options"
done
run render rain.noct --wet -q --frames 2 -o wet.exr
run compare wet.exr plain.exr
grep -q 'all pixels' out && ! grep -Eq 'all pixels +1,536 +0.000' out
result $? "--wet is seen"
run build rain.noct --wet -q -o wet.noct
run render wet.noct --wet -q --frames 2 -o again.exr
same "rain on a built city is built again, and does not fall twice" wet.exr again.exr
expect "and does not dry" 2 'wet: wet.noct is built already, .*: build it again with this' \
    render wet.noct --no-wet -o a.png
for options in '--window-kelvin 3000' '--no-windows' '--lod 1' '--lamp-lumens 9' '--infer-lamps' '--bbox 0,0,1,1' \
    '--storey-height 4' '--traffic' '--crs EPSG:25832' '--no-textures'; do
    # shellcheck disable=SC2086
    expect "no $options on a built city" 2 'rain.noct is built already, and that has decided it' \
        render rain.noct $options -o a.png
done
expect "nor where it is built again" 2 'lod: rain.noct is built already' build rain.noct --lod 1 -o a.noct
expect "or told of" 2 'lod: rain.noct is built already' info rain.noct --lod 1
expect "nor lamps beside it" 1 'rain.noct: is a built city, and ' \
    render rain.noct --lamps city.gml -o a.png
run render rain.noct --window-kelvin 2900 --window-lit 0.8 --frames 1 -q -o a.png
test "$status" = 0 && test ! -s err
result $? "what is said as it was built"
printf 'nocturne: 1\ninputs: [rain.noct]\nwet: on\nwindows: { lit: 0.3 }\nwidth: 48\nheight: 32\n' >over.yaml
run render rain.yaml --wet --window-lit 0.3 -q --frames 2 -o files.exr
run render over.yaml -q --frames 2 -o built.exr
same "a recipe of a built city switches it, too" files.exr built.exr
printf 'nocturne: 1\ninputs: [rain.noct]\ngroups: { a: { on: off } }\n' >over.yaml
expect "its rules come too late" 2 'groups of a recipe: .*rain.noct is built already' render over.yaml -o a.png
for options in '--hour 3' '--window-lit 0.2 --hour 23.5' '--window-lit 1'; do
    # shellcheck disable=SC2086
    run info rain.yaml --scene $options && sed -n '/^scene of/,$p' out | grep -E 'windows  |groups' >files.told
    # shellcheck disable=SC2086
    run info rain.noct --scene $options && sed -n '/^scene of/,$p' out | grep -E 'windows  |groups' >built.told
    [ "$(wc -l <files.told)" = 2 ] && cmp -s files.told built.told
    result $? "lit windows and their flux are told with $options"
    told=$(sed -n 's/ *windows *\([^;]*lit\),.*/\1/p' files.told)
    # shellcheck disable=SC2086
    run info rain.noct $options && [ -n "$told" ] && grep -qF "$told" out
    result $? "of the file, too"
done
run info city.noct --each-lamp
[ "$(head -n 1 out | cut -d, -f 1-2)" = name,placed ]
result $? "a built city's table of lamps is a table alone"
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
expect "a mesh beside it" 1 'is a built city, and' render city.noct city.gml -o a.png
head -c 5000 city.noct >short.noct
expect "one that is cut short" 1 'short.noct: is damaged: it has 5000 bytes' render short.noct -o a.png
run build nothing.gml -o none.noct
[ "$status" = 1 ] && [ ! -e none.noct ] && [ -z "$(find . -name '*.part')" ]
result $? "a build that fails leaves nothing"
mkdir there
start build builtin:city --city-size 1500 -o there/big.noct
until [ -n "$(ls -A there)" ] || ! kill -0 $pid 2>err; do sleep 0.05; done
kill -INT $pid
wait $pid
status=$?
# a machine that is quicker than that has the whole file
[ $status = 130 ] && grep -q 'nothing was saved' err && [ -z "$(ls -A there)" ] ||
    { [ $status = 0 ] && [ "$(ls -A there)" = big.noct ]; }
result $? "Ctrl-C while it is written leaves nothing" "$status: $(ls -A there)"
finish
