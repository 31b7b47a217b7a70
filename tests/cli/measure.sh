#!/bin/sh
# nocturne measure: lux of the ground as a GeoTIFF, at points as CSV, and figures of regions.
. "$(dirname "$0")/lib.sh"
cat >map.osm <<'OSM'
<?xml version="1.0"?><osm version="0.6">
<node id="1" lat="52.5000000" lon="13.4000000"/><node id="2" lat="52.5000000" lon="13.4010000"/>
<node id="11" lat="52.5000300" lon="13.4002000"><tag k="highway" v="street_lamp"/></node>
<node id="12" lat="52.5000300" lon="13.4006000"><tag k="highway" v="street_lamp"/></node>
<way id="21"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/><tag k="name" v="Well Lane"/></way>
</osm>
OSM
gdal=true
"$program" --version | grep -qi 'gdal' || gdal=false

if $gdal; then
    run measure map.osm --map-surfaces -q --sky 0 --on road -o lux.tif --threads 1
    [ "$status" = 0 ] && grep -Eq '^[0-9]+ x [0-9]+ pixels of 1: lux.tif: [0-9,]+ readings in ' out &&
        grep -Eq '^  mean +[0-9.]+ lx ± [0-9.e-]+$' out && [ "$(head -c 2 lux.tif)" = II ]
    result $? "the ground of a map as a raster"
    cp out first
    run measure map.osm --map-surfaces -q --sky 0 --on road -o again.tif --threads 2
    cmp -s lux.tif again.tif && [ "$(sed -n 2,6p out)" = "$(sed -n 2,6p first)" ]
    result $? "the same bytes for any number of threads"

    run measure map.osm --map-surfaces -q --sky 0 --on road -o lux.tif --json --grid 2 --t-srs EPSG:25833
    cp out raster.json
    run measure map.osm --map-surfaces -q --sky 0 --region "street:Well Lane" --json && cp out street.json
    run influence map.osm --map-surfaces -q --sky 0 --region "street:Well Lane" --json && cp out who.json
    python3 - <<'PY'
import json
raster, street, who = (json.load(open(name + '.json')) for name in ('raster', 'street', 'who'))
assert raster['windows_counted'] is False and raster['sky'] == 0 and street['area'] == who['area'], street
near = lambda a, ea, b, eb: abs(a - b) <= 4 * (ea * ea + eb * eb) ** .5 + .01 * b
assert near(street['mean'], street['mean_error'], who['lux'], who['lux_error']), (street, who['lux'])
assert near(raster['mean'], raster['mean_error'], who['lux'], who['lux_error']), (raster, who['lux'])
for j in raster, street:
    assert 0 < j['least_reading'] < j['percentile_5'] < j['median'] < j['percentile_95'] < j['maximum'], j
low, least, high = (street['minimum' + k] for k in ('_low', '', '_high'))
assert low <= least + 3 * street['minimum_error'] and least - 3 * street['minimum_error'] <= high, street
assert 0 < least < street['percentile_5'] and street['minimum_error'] > 0 and street['uniformity_error'] > 0, street
assert abs(street['uniformity'] - least / street['mean']) < 1e-6
assert street['minimum_resolved'] is (street['minimum_candidates'] == 1) and street['minimum_x'] > 1e3, street
assert raster['minimum'] is None and raster['uniformity'] is None and 'minimum_resolved' not in raster, raster
PY
    result $? "raster, street and nocturne influence agree"

    sed '/<\/osm>/d' map.osm >two.osm
    cat >>two.osm <<'OSM'
<node id="31" lat="52.5004000" lon="13.4000000"/><node id="32" lat="52.5004000" lon="13.4004000"/>
<way id="22"><nd ref="31"/><nd ref="32"/><tag k="highway" v="residential"/>
<tag k="name" v="Old &quot;Quay&quot;"/></way>
</osm>
OSM
    run measure two.osm --map-surfaces -q --sky 0 --streets streets.geojson && cp out said
    run measure two.osm --map-surfaces -q --sky 0 --region "street:Well Lane" --json && cp out street.json
    run measure two.osm --map-surfaces -q --sky 0 --streets - && cmp out streets.geojson &&
        grep -q '^streets.geojson: 2 streets$' said && python3 - <<'PY'
import json
layer, alone = json.load(open('streets.geojson')), json.load(open('street.json'))
assert [f['properties']['street'] for f in layer['features']] == ['Old "Quay"', 'Well Lane'], layer
quay, lane = layer['features']
assert all(lane['properties'][k] == v for k, v in alone.items() if k in lane['properties']), (lane, alone)
assert {'mean', 'minimum', 'uniformity', 'area', 'percentile_95'} <= set(lane['properties'])
for f, east, lat in (quay, 13.4004, 52.5004), (lane, 13.401, 52.5):
    assert f['geometry']['type'] == 'MultiLineString'
    (a, b), = f['geometry']['coordinates']
    assert abs(a[0] - 13.4) < 1e-6 and abs(b[0] - east) < 1e-6 and a[1] == b[1] == lat, f
PY
    result $? "figures of all streets as a layer"

    start measure map.osm --map-surfaces --sky 0 --grid 0.02 --error 0.0001 -o never.tif
    sleep 1
    kill -INT "$pid"
    wait "$pid"
    [ $? = 130 ] && [ ! -e never.tif ] && [ -z "$(find . -name '*never*')" ]
    result $? "interrupted, it leaves nothing"
else
    for what in "the ground of a map as a raster" "the same bytes for any number of threads" \
        "raster, street and nocturne influence agree" "figures of all streets as a layer" \
        "interrupted, it leaves nothing"; do
        skip "$what" "without GDAL"
    done
fi

# A lamp of 1 x 1 m of 100 cd/m2, 2 m over a floor: form factor to a parallel rectangle, four of .5 x .5 m
lamp_model
cat >points.txt <<'TXT'
# x y z nx ny nz
0 0 0.001 0 0 1
0,0,0.001

	0 0 0.001  0 0 -1
TXT
run measure lamp.obj -q --sky 0 --points points.txt -o - && cp out readings.csv
run influence lamp.obj -q --sky 0 --region point:0,0,0.001 --json && cp out who.json
python3 - <<'PY'
import csv, json
rows = list(csv.DictReader(open('readings.csv')))
who = json.load(open('who.json'))
assert len(rows) == 3 and list(rows[0]) == 'x y z nx ny nz lux error samples note'.split(), rows
lux, error = (float(rows[0][k]) for k in ('lux', 'error'))
off = abs(lux - who['lux'])
assert off <= 4 * (error ** 2 + who['lux_error'] ** 2) ** .5 + 1e-3 * lux and lux > 1, (rows[0], who['lux'])
assert rows[1]['nz'] == '1' and abs(float(rows[1]['lux']) - lux) <= 6 * error + 1e-3 * lux, rows[1]
assert float(rows[2]['lux']) == 0, rows[2]
PY
result $? "points in, readings out"
printf '0 0 0.001\n' | "$program" measure lamp.obj -q --points - --response hemisphere >out 2>err &&
    [ "$(wc -l <out)" = 2 ]
result $? "points come by a pipe"

# A byte order mark, normals of any length, and points inside a body
printf '\357\273\277' >points.txt
printf '0 0 0.001 0 0 1e-200\n0 0 0.001 0 0 1e200\n' >>points.txt
run measure lamp.obj -q --sky 0 --points points.txt && cp out readings.csv
python3 - <<'PY'
import csv
rows = list(csv.DictReader(open('readings.csv')))
lux = [float(r['lux']) for r in rows]
assert [r['nz'] for r in rows] == ['1', '1'] and [r['note'] for r in rows] == ['', ''], rows
assert lux[0] > 1 and abs(lux[1] - lux[0]) < 0.05 * lux[0], rows
PY
result $? "normals of any length"
printf '10 10 -0.3\n' | "$program" measure builtin:city -q --points - >out 2>err &&
    sed -n 2p out | grep -q ',8,"below the ground by 0.4 m"$'
result $? "why a point is dark"

# Regions tell the least with its error.
run measure builtin:city -q --region "street:street 1"
grep -Eq '^  minimum +[0-9.e-]+ lx ± [0-9.e-]+( at |, between )' out &&
    grep -Eq '^  Uo +[0-9.e-]+ ± [0-9.e-]+, minimum over mean$' out &&
    grep -Eq '^  left out +[0-9,]+ points: something stands on the ground there$' out
result $? "the minimum has its error, and what is left out is counted"

mean() {
    "$program" measure builtin:city -q --json --region "street:street 1" "$@" | sed -n 's/.*"mean": \([0-9.]*\),/\1/p'
}
lamps=$(mean --no-count-windows) all=$(mean --count-windows)
awk "BEGIN { exit !($lamps > 1 && $all > 1.02 * $lamps) }"; result $? "windows are dark unless they count" "$lamps $all"

expect "nothing is asked for" 2 'what is to be measured\? -o lux.tif, --points FILE' measure builtin:city
expect "a raster is a GeoTIFF" 2 'lux.png must end in .tif' measure builtin:city -o lux.png
expect "a GeoTIFF is a file" 2 'a GeoTIFF is a file' measure builtin:city -o -
expect "an extent has four numbers" 2 '"1,2,3", must be west,south,east,north' measure builtin:city -o a.tif --te 1,2,3
expect "an extent has an inside" 2 'west is less than east' \
    measure builtin:city -o a.tif --te 1,2,0,5
expect "classes have names" 2 '--on: no class "raod"; is it road\?' measure builtin:city -o a.tif --on raod
expect "objects have surfaces" 2 "nocturne influence has their mean" measure builtin:city --region object:x
expect "responses are for points" 2 '--response is for --points' measure builtin:city -o a.tif --response cylinder
expect "a raster has an end" 1 'a smaller extent, or larger pixels' \
    measure builtin:city -q -o a.tif --te=-1e6,-1e6,1e6,1e6
expect "a scene without a CRS has no other one" 1 'has no CRS' \
    measure builtin:single -q -o a.tif --t-srs EPSG:25832
for option in "--on road" "--te 0,0,9,9" "--grid 2"; do
    expect "${option%% *} is for a raster" 2 "${option%% *} is for a raster" \
        measure builtin:single --region point:0,0 $option
    expect "${option%% *} is not for points" 2 "${option%% *} is for a raster" \
        measure builtin:single --points points.txt -o a.csv $option
done
expect "a city without streets" 1 'the city has no street with a name: add the map of its roads' \
    measure builtin:single -q --streets a.tif
expect "streets are not points" 2 '--points and --streets exclude each other' \
    measure builtin:single --points points.txt --streets a.tif
expect "one thing goes to standard output" 2 '--streets - writes to standard output' \
    measure builtin:single --streets - --region point:0,0
expect "streets are not written over an input" 1 'map.osm is an input too .map.osm.; it would be overwritten' \
    measure map.osm --streets ./map.osm
expect "points have their heights" 2 '--meter-height is for a raster' \
    measure builtin:single --points points.txt --meter-height 1
expect "points are not written over" 1 'points.txt has the points of --points' \
    measure builtin:single --points points.txt -o ./points.txt
expect "a half cylinder faces somewhere" 1 'points.txt:1: the normal has no azimuth' \
    measure builtin:single --points points.txt --response semicylinder
expect "points are read before the city" 1 'points.txt:1: the normal has no azimuth' \
    measure nowhere.gml --points points.txt --response semicylinder
if $gdal; then
    expect "a raster without ground" 1 'none.tif: not written: no pixel of the raster has such ground' \
        measure builtin:single -q --on water -o none.tif
    [ ! -e none.tif ]; result $? "and it is not written"
fi
printf '1 2\n' >bad.txt
expect "a point has three numbers" 1 'bad.txt:1: "1 2 ?" is not x y z' measure builtin:single -q --points bad.txt
printf '1 2 3\n1 2 3 0 0 0\n' >bad.txt
expect "a normal is not 0" 1 'bad.txt:2: the normal is 0' measure builtin:single -q --points bad.txt
printf '# none\n' >bad.txt
expect "there are points" 1 'there are no points in it' measure builtin:single -q --points bad.txt
expect "points are there" 1 'nowhere.txt: cannot be read: No such file' measure builtin:single -q --points nowhere.txt
[ ! -e a.tif ]; result $? "what fails writes nothing"
finish
