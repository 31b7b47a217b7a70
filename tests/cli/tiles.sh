#!/bin/sh
# A city in tiles: together they are the city that is built at once, whoever builds them and whoever was killed.
. "$(dirname "$0")/lib.sh"
unset OMPI_COMM_WORLD_RANK OMPI_COMM_WORLD_SIZE PMI_RANK PMI_SIZE JOB_COMPLETION_INDEX NOCTURNE_PARTS
for name in $(env | sed -n 's/^\(SLURM_[A-Z_]*\)=.*/\1/p'); do unset "$name"; done
python3 "$source_dir/bench/blocks.py" 6 --tiles t
{
    echo "id,x,y,height"
    for j in 0 1 2 3 4 5; do
        for i in 0 1 2 3 4 5; do
            echo "lamp-$i-$j,$((690000 + 48 * i + 42)),$((5330000 + 32 * j + 25)),6"
        done
    done
} >lamps.csv
common="--lamps lamps.csv --crs EPSG:25832"
sums() { (cd "$1" && sha256sum -- *.noct index.geojson 2>&1); }

# shellcheck disable=SC2086 # words
run build t/*.gml $common -q -o whole.noct
result $status "the city is built at once"
# shellcheck disable=SC2086
run build --each t/*.gml $common -o built
test "$status" = 0 && grep -q 'built 6 tiles; 0 were there; 0 failed' out &&
    test "$(find built -name '*.noct' | wc -l)" = 6
result $? "and in tiles"
sums built >first.sums
# shellcheck disable=SC2086
run build --each 't/*.gml' $common -o built
test "$status" = 0 && grep -q 'built 0 tiles; 6 were there' out && sums built | cmp -s - first.sums
result $? "which are left where they are there, by a pattern in quotes, too"
for city in whole.noct built; do
    "$program" info $city 2>/dev/null | sed -n '/^scene of/,$p' | grep -E '^  (lights|groups|lamps) ' >$city.facts
done
mv whole.noct.facts whole.facts && mv built.facts tiles.facts
cmp -s whole.facts tiles.facts
result $? "all lamps and windows are there once" "$(diff whole.facts tiles.facts)"
for what in buildings windows; do
    a=$("$program" info whole.noct 2>/dev/null | grep -Eo "[0-9,]+ of them $what|^  $what +[0-9,]+ windows" | tail -1)
    b=$("$program" info built 2>/dev/null | grep -Eo "[0-9,]+ of them $what|^  $what +[0-9,]+ windows" | tail -1)
    test -n "$a" && test "$a" = "$b"
    result $? "and all $what" "$a, in tiles $b"
done

look="--camera-crs scene --eye 690140,5329960,570 --target 690140,5330090,500 --size 96x54 --frames 16 -q"
# shellcheck disable=SC2086
run render whole.noct $look -o whole.exr
# shellcheck disable=SC2086
run render built $look -o tiles.exr
result $status "the folder is drawn as one city"
run compare whole.exr tiles.exr
python3 - out <<'END'
import re, sys
text = open(sys.argv[1]).read()
a, b = map(float, re.search(r"mean luminance (\S+) against (\S+) cd", text).groups())
rmse = float(re.search(r"all pixels\s+\S+\s+(\S+)", text).group(1))
print("#", a, b, rmse)
sys.exit(not (a > 0 and abs(a - b) < .002 * a and rmse < 8))
END
result $? "and looks like it"

for parts in 2 3 5; do
    rm -rf shared
    part=$parts
    while [ $part -ge 1 ]; do
        # shellcheck disable=SC2086
        run build --each t/*.gml $common -q -o shared --part $part/$parts
        part=$((part - 1))
    done
    sums shared | cmp -s - first.sums
    result $? "$parts parts make the same files"
done
rm shared/tile-0003.noct shared/index.geojson
# shellcheck disable=SC2086
SLURM_ARRAY_TASK_ID=1 SLURM_ARRAY_TASK_MIN=0 SLURM_ARRAY_TASK_COUNT=2 \
    "$program" build --each t/*.gml $common -o shared >out 2>err
test $? = 0 && grep -q 'part 2 of 2, by SLURM_ARRAY_TASK_ID' err && grep -q 'built 1 tiles; 2 were there' out &&
    sums shared | cmp -s - first.sums
result $? "parts go by what started them; a file that is missing is made again, and the index"

# killed
rm -rf shared
# shellcheck disable=SC2086
start build --each t/*.gml $common -q -o shared --threads 1
tries=0
until ls shared/tile-0001.noct >/dev/null 2>&1 || [ $tries -ge 3000 ]; do
    tries=$((tries + 1))
    sleep 0.01
done
kill -9 $pid 2>/dev/null
wait $pid 2>/dev/null
rm -f shared/index.geojson
# shellcheck disable=SC2086
run build --each t/*.gml $common -q -o shared
test "$status" = 0 && sums shared | cmp -s - first.sums
result $? "who was killed goes on where it was"

# rectangles
box=690000,5330000,690300,5330020
run info built --bbox $box
test "$status" = 0 && test "$(grep -c '^tile-' out)" = 1
result $? "a rectangle opens what it needs"
run info built/index.geojson --bbox 690000,5330000,690300,5330060
test "$(grep -c '^tile-' out)" = 2
result $? "by the index's name, too"
expect "a rectangle beside all tiles" 1 'none of its 6 tiles meets the bbox' info built --bbox 0,0,1,1
expect "no rectangle" 1 'bbox: "1,2,3" is not X0,Y0,X1,Y1' info built --bbox 1,2,3
if [ -f built/index.gpkg ]; then
    run info built/index.gpkg --bbox $box
    test "$(grep -c '^tile-' out)" = 1
    result $? "and the GeoPackage stands for it"
    python3 - <<'END'
import sqlite3, sys
db = sqlite3.connect("built/index.gpkg")
rows = db.execute('select location, buildings, lamps from tiles order by location').fetchall()
print("#", rows[:2])
sys.exit(not (len(rows) == 6 and rows[0][0] == "tile-0000.noct" and sum(r[1] for r in rows) == 36 and
              sum(r[2] for r in rows) == 36))
END
    result $? "which has a row a tile, with all buildings and lamps"
else
    skip "the GeoPackage" "without GDAL"
fi

# trouble
rm -rf shared && mkdir bad && cp t/*.gml bad/ && head -c 2000 t/tile-0002.gml >bad/tile-0002.gml
# shellcheck disable=SC2086
run build --each bad/*.gml $common -q -o shared
test "$status" = 1 && test "$(grep -c 'bad/tile-0002.gml' err)" -ge 1 &&
    test "$(find shared -name '*.noct' | wc -l)" = 5
result $? "a broken tile is an error, and the others are built"
# shellcheck disable=SC2086
run build --each bad/*.gml $common --window-lit 1 -o shared
grep -q 'built 5 tiles' out
result $? "other options make other tiles"
expect "a halo without tiles" 2 'halo is for --each' build t/tile-0000.gml --halo 5 -o a.noct
expect "tiles of a box" 2 'bbox is not for --each' build --each t/tile-0000.gml --bbox 1,2,3,4 -o shared
expect "a folder that is a file" 1 'lamps.csv: cannot be a folder' build --each t/tile-0000.gml -o lamps.csv
expect "tiles that are built" 2 'is built' build --each built/tile-0000.noct -o shared
expect "no city" 1 'none of the 1 inputs is a city model' build --each lamps.csv --crs EPSG:25832 -o shared
mkdir latin && cp t/tile-0000.gml latin/
# a name that JSON cannot hold
odd=$(printf 'latin/\344.gml')
mv latin/tile-0000.gml "$odd"
expect "a name that is no UTF-8" 1 'which is no UTF-8: rename that tile' build --each "$odd" -o named
test ! -e named/index.geojson && mv "$odd" latin/ä.gml && rm -rf named
run build --each latin/ä.gml -q -o named
run info named --no-scene
result $status "one of letters beyond ASCII is found by the index"
mkdir twice && cp t/tile-0000.gml twice/
expect "two of a name" 1 'would both be tile-0000.noct' build --each t/tile-0000.gml twice/tile-0000.gml -o shared
expect "a tile twice" 1 'is given twice' info built/tile-0000.noct built/tile-0000.noct
finish
