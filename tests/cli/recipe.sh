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
    result "$status" "draws $out of $1"
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
draw wet.exr sub/city.yaml --wet
differ "a wet ground" recipe.exr wet.exr
expect "an unknown camera" 2 'has no camera "nera"; is it near\?' render sub/city.yaml --camera nera -o a.png
expect "a camera without a recipe" 2 'for a recipe among the inputs' render city.gml --camera near -o a.png
expect "a camera and a view" 2 'exclude each other' render sub/city.yaml --camera near --view street -o a.png
expect "two recipes" 2 'both recipes' render sub/city.yaml sub/white.yaml -o a.png
printf 'nocturne: 1\ninputs: [none.gml]\n' >none.yaml
expect "an input that is not there" 1 'none.gml' render none.yaml -o a.png
printf 'nocturne: 1\ninputs: [city.gml]\nlod: 12\n' >bad.yaml
expect "a wrong value" 1 'bad.yaml:3: lod: "12" is outside 0 to 4' render bad.yaml -o a.png

cp city.gml 'a "b" c.gml'
expect "init without files" 2 'which files' init town
expect "init without anything" 2 'which folder' init
expect "init in a file" 2 'is no folder' init city.gml city.gml
expect "init of a file that is not there" 1 'none.gml' init town none.gml
[ ! -e town ]
result $? "what failed leaves no folder"
run init town city.gml 'a "b" c.gml' builtin:single
result $status "init"
printf 'IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n159154.943 159154.943\n' >lamp.ies
printf 'lat,lon\n48.1,11.5\n' >plain.csv
run init files city.gml --lamp-profile lamp.ies --lamps plain.csv
grep -q "^  profile: \"$PWD/lamp.ies\"" files/city.yaml && grep -q "^  files: \[\"$PWD/plain.csv\"\]" files/city.yaml &&
    [ "$(grep -c '^#*lamps:' files/city.yaml)" = 1 ]
result $? "files that init is told are found from the recipe" "$(cat files/city.yaml)"
grep -q "draw it: $program render $PWD/files/city.yaml" out
result $? "init shows the program as it was called" "$(cat out)"
printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\200\100\040\200\040\100\200\201' >sky.hdr
run render city.gml --infer-lamps --lamp-profile lamp.ies --environment sky.hdr \
    --environment-light --environment-lux 12000 --frames 1 --size 48x32 -o a.png
grep -Eq 'lamps 1 \(1,000 klm\), windows 28 \([0-9]\.[0-9]+ klm\)' out &&
    grep -Eq 'profiles  lamp.ies [0-9]+$' out &&
    grep -q 'map       sky.hdr, 2 pixels wide, as background and light: 12,000 lx on open ground' out
result $? "the summary tells flux in whole numbers, and names the files of lamps and of the map" "$(cat out)"
run init said city.gml --lamp-height 8 --lod 2 --window-lit 0.6 --no-windows --wet
draw said.exr said/city.yaml --size 48x32 --view aerial
draw words.exr city.gml --lamp-height 8 --lod 2 --window-lit 0.6 --no-windows --wet --size 48x32 --view aerial
run compare said.exr words.exr
grep -Eq 'all pixels +1,536 +0.000 +0 ' out && grep -q '^  height: 8' said/city.yaml
result $? "what init is told is in the recipe" "$(cat said/city.yaml)"
# beneath the folder, the folder itself, and names that a recipe takes for something else
mkdir -p 'here/a  b'
cp city.gml 'here/a  b/one.gml'
cp city.gml here/builtin:city
run init here 'here/a  b/one.gml' here/builtin:city here
grep -q '^  - "a  b/one.gml"' here/city.yaml && grep -q '^  - "./builtin:city"' here/city.yaml &&
    grep -q '^  - "\."' here/city.yaml
result $? "init names files beneath its folder" "$(grep -A 4 '^inputs' here/city.yaml)"
rm here/city.yaml
run init here here/builtin:city
draw here.png here/city.yaml --size 8x8
odd=$(printf 'of\302\205\177\342\200\250one')
cp city.gml "$odd.gml"
run init "$odd" "$odd.gml"
draw odd.png "$odd/city.yaml" --size 8x8
odd=$(printf 'not\377utf')
cp city.gml "$odd.gml"
expect "init of a name that is no UTF-8" 1 'UTF-8, and this name is not' init latin "$odd.gml"
[ ! -e latin ]; result $? "leaves nothing"
run init "$odd" city.gml
draw latin.png "$odd/city.yaml" --size 8x8
rm -r "$odd" "$odd.gml"
# as many files as may be named
for i in 0 1 2 3; do for k in 0 1 2 3 4 5 6 7; do printf 'l%d%d.csv, ' $i $k; done; done >list
printf 'nocturne: 1\ninputs: [city.gml]\nlamps: { files: [%s] }\n' "$(sed 's/, $//' list)" >many.yaml
printf 'traffic: { tracks: [%s] }\n' "$(sed 's/, $//; s/l/t/g' list)" >>many.yaml
expect "a recipe that names 64 files" 1 'l00.csv: No such file' render many.yaml -o a.png
if "$program" --version | grep -q gdal; then
    cat >map.osm <<'END2'
<?xml version='1.0'?><osm version='0.6'><node id='1' lat='48.1' lon='11.5'/><node id='2' lat='48.1' lon='11.5004'/>
<node id='3' lat='48.1003' lon='11.5004'/><way id='1'><nd ref='1'/><nd ref='2'/><nd ref='3'/><nd ref='1'/>
<tag k='building' v='yes'/></way><way id='2'><nd ref='1'/><nd ref='3'/><tag k='highway' v='residential'/></way></osm>
END2
    run init map map.osm
    grep -Eq 'map.osm".* 1 outline of buildings, 1 road \(0.0 km\)' map/city.yaml &&
        grep -q '^footprints: true .*1 outline of buildings become blocks' map/city.yaml
    result $? "outlines of a map alone are drawn" "$(cat map/city.yaml)"
    run init both map.osm city.gml
    grep -q '^#footprints: false' both/city.yaml
    result $? "beside a city model they wait" "$(cat both/city.yaml)"
else
    skip "init of a map" "no GDAL"
fi
expect "init does not overwrite" 1 'is left alone: remove it for another' init town city.gml
[ "$(find town | wc -l)" = 2 ]
result $? "init leaves its recipe alone" "$(ls -a town)"
grep -q '"../city.gml" # CityGML' town/city.yaml
result $? "paths are seen from the recipe's folder" "$(cat town/city.yaml)"
draw town.exr town/city.yaml --size 48x32 --view aerial
draw direct.exr city.gml 'a "b" c.gml' builtin:single --size 48x32 --view aerial
run compare town.exr direct.exr
grep -Eq 'all pixels +1,536 +0.000 +0 ' out
result $? "its picture is that of the files"
sed -e 's/^#\([a-z]\)/\1/' -e 's/^#\(  [-a-z]\)/\1/' -e '/\.\.\./d' -e '/^crs:/d' town/city.yaml >town/all.yaml
run render town/all.yaml -q --size 48x32 --frames 1 -o all.exr
result $status "every key that waits to be used can be used"
for city in "$source_dir"/cities/*.yaml; do
    name=$(basename "$city")
    if grep -q "are not a part of Nocturne" "$city"; then
        run render "$city" -o none.png
        [ "$status" = 1 ] && grep -q "/cities/[a-z]*: .*No such file" err && [ ! -e none.png ]
        result $? "$name says which folder its files are missing from" "$(cat err)"
        continue
    fi
    if [ -d "$source_dir/../shared/data" ]; then
        draw real.exr "$city" --size 32x18 --frames 1
    else
        skip "draws $name" "shared/data is not here"
    fi
done
run info sub/city.yaml
grep -q 'CityGML' out && grep -q '^scene of 1 input' out && grep -q '^  objects     1, 1 of them buildings' out &&
    grep -q '^  windows     28 windows, 14 lit, 13.0 on 100 m2 of wall, 6.5 lit' out && grep -Eq '^    wall +24$' out &&
    grep -q '^  lamps       0 mapped, 1 inferred' out && grep -q '^  skipped     1 x ring with too few points' out
result $? "info tells of a recipe's inputs, and of the scene that they make"
{ cat sub/city.yaml && echo 'sky: bortle:4'; } >sub/dark.yaml
run info --json sub/dark.yaml
python3 -c 'import json
scene = json.load(open("out"))["scene"]
assert abs(scene["sky"] - 5.169e-4) < 1e-6 and abs(scene["sky_sqm"] - 20.8) < 1e-9, scene'
result $? "and of its sky"
run info sub/city.yaml
grep -q '^  sky         0.0032 cd/m2 at the zenith, 18.82 mag/arcsec2' out; result $? "and of the sky that is assumed"
mv out first.txt
run info sub/city.yaml
same "what it tells is the same each time" first.txt out
run info --timing sub/city.yaml
grep -q 'read in' out && grep -q '^  import ' out && grep -Eq '^  memory .* at most, .* of them the scene' out
result $? "but for --timing"
run info --no-scene sub/city.yaml
! grep -q '^scene' out && grep -q CityGML out
result $? "--no-scene tells of its inputs alone"
cat >lamps.csv <<'END'
id,lon,lat,lamp_type
a,11.421884,48.754457,LED
END
run info --json --scene city.gml lamps.csv
python3 - out >err <<'END'
import json, sys
told = json.load(open(sys.argv[1]))
assert len(told["files"]) == 2 and "seconds" not in told["files"][0], told
scene = told["scene"]
expected = {"files": 2, "objects": 1, "buildings": 1, "windows": 28, "windows_lit": 14, "lamps_mapped": 1,
            "lamps_inferred": 0, "lamps_dropped": 0, "features_skipped": 1, "instances": 1, "tracks": 0, "cars": 0}
wrong = {k: (scene.get(k), v) for k, v in expected.items() if scene.get(k) != v}
assert not wrong, wrong
END
result $? "a scene as JSON"
# Materials of a class that nothing is of.
cp "$source_dir/tests/cli/city.gml" idle.gml
printf 'nocturne: 1\ninputs: [idle.gml]\nmaterials: { road: W3, roof: { albedo: 0.3 } }\n' >idle.yaml
run influence idle.yaml --region point:678020,5403002
[ "$status" = 0 ] && grep -q 'materials: nothing in the scene is of the class road$' err && ! grep -q 'class roof' err
result $? "materials of a class that nothing is of are told"

finish
