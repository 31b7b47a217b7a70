#!/bin/sh
# nocturne influence: tables, CSV and JSON of who lights a place, and what is said of questions that have no answer.
. "$(dirname "$0")/lib.sh"
cat >map.osm <<'OSM'
<?xml version="1.0"?><osm version="0.6">
<node id="1" lat="52.5000000" lon="13.4000000"/><node id="2" lat="52.5000000" lon="13.4010000"/>
<node id="11" lat="52.5000300" lon="13.4002000">
<tag k="highway" v="street_lamp"/><tag k="lamp_type" v="led"/><tag k="note" v="by, the &quot;well&quot;"/></node>
<node id="12" lat="52.5000300" lon="13.4006000">
<tag k="highway" v="street_lamp"/><tag k="light:lumens" v="9000"/></node>
<way id="21"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/><tag k="name" v="Well Lane"/></way>
</osm>
OSM
ask() { run influence map.osm --map-surfaces -q --sky 0 "$@"; }

: >well.csv && chmod 600 well.csv
ask --region "street:Well Lane" --csv well.csv
test "$(stat -c %a well.csv)" = 600; result $? "a CSV keeps the mode of what it replaces" "$(stat -c %a well.csv)"
grep -q 'node/12, mapped\|node/12, Well Lane, map.osm' out && grep -q '^street:Well Lane: around' out &&
    grep -Eq '^( +[0-9.]+ ±[0-9.]+){3} +[0-9]+  road$' out && tail -n 1 well.csv | grep -q '^,"road","class",' &&
    [ "$(sed -n 's/^1,"\([^"]*\)".*/\1/p' well.csv)" = node/12 ] && [ "$(wc -l <well.csv)" = 8 ]
result $? "a street is lit by its lamps, the stronger one first"
grep -Eq '^ +[0-9.]+ ±[0-9.]+ +100.00 ±0.00 +2 lamps$' out && grep -q '^,"lamp","kind",' well.csv
result $? "and both are told as one kind"

run influence builtin:single -q --sky 0 --region point:-0.0001,-0.0004,0.5
grep -q ': at 0\.000 0\.000 0\.500 ' out; result $? "no place is at -0.000"

head -n 1 well.csv | grep -q ',area,crs,lamps_lux,' && [ "$(grep -c '"EPSG:32633' well.csv)" = 2 ]
result $? "the table names the CRS of its places"

awk -F, 'NR > 1 && $1 != "" { share += $7; lux += $5 } /"all"/ { all = $5 }
    END { exit !(share > .999 && share < 1.001 && lux > .999 * all && lux < 1.001 * all) }' well.csv
result $? "shares sum up to 1, and lux to all"

ask --json --region "street:Well Lane" && python3 - <<'PY'
import json
with open('out') as f:
    j = json.load(f)
rows = j['rows']
assert [r['name'] for r in rows] == ['node/12', 'node/11'], rows
assert rows[0]['street'] == 'Well Lane' and rows[0]['kind'] == 'lamp' and rows[0]['placed'] == 'mapped'
assert rows[0]['share'] > rows[1]['share'] > 0 and 0 < rows[0]['share_error'] <= .011 * rows[0]['share']
assert rows[1]['tags'] == {'highway': 'street_lamp', 'lamp_type': 'led', 'note': 'by, the "well"'} or \
    'note' in rows[1]['tags'], rows[1]
assert [c['class'] for c in j['classes']] == ['road'] and j['classes'][0]['area'] > 100, j
assert abs(j['classes'][0]['lux'] - j['lux']) < 1e-6 * j['lux'] and j['classes'][0]['lux_error'] > 0, j
kinds = {k['kind']: k for k in j['kinds']}
assert list(kinds) == ['lamp', 'window', 'vehicle', 'surface', 'other'] and kinds['window']['lux'] == 0, kinds
assert kinds['lamp']['lights'] == 2 and abs(kinds['lamp']['lux'] - j['lux']) < 1e-6 * j['lux'], kinds
assert kinds['lamp']['lux_error'] > 0 and abs(kinds['lamp']['share'] - 1) < 1e-9, kinds
assert abs(rows[0]['lumens'] - 9000) < 1 and j['lux'] > 0 and j['sky'] == 0
PY
result $? "JSON has names, streets, tags and errors"

# What figures rest on is told by every command that gives some, on standard error and in JSON.
gml=$source_dir/tests/cli/city.gml
printf 'id,x,y,lamp_type\n1,678020,5403004,Glow-worm\n2,678020,5403000,LED\n3,681420,5403000,LED\n' >doubtful.csv
for command in influence measure; do
    run $command "$gml" doubtful.csv --crs EPSG:25832 --region point:678020,5403002 --json
    grep -q '^nocturne: assumed of lamps: 2 without height: 6 m (--lamp-height), 2 without flux' err &&
        grep -q '^nocturne: inputs: left out: 2, guessed at: 1: 1 x lamp more than 2 km outside the city, ' err &&
        grep -q 'warning: doubtful.csv: 1 of 3 lamps is left out: 1 outside the city, the nearest 3.4 km away$' err &&
        grep -q '"lamps_left_out": 1, "assumed": "2 without height: 6 m (--lamp-height), ' out &&
        grep -q '"inputs": "left out: 2, guessed at: 1: .*not understood' out
    result $? "nocturne $command tells what its figures rest on"
done
expect "--strict refuses lamps that are left out" 1 '1 x lamp more than 2 km outside the city' \
    influence "$gml" doubtful.csv --crs EPSG:25832 --region point:678020,5403002 --strict

ask --json --region "street:Well Lane" --threads 1 --time 0 && sed 's/"seconds".*//' out >one &&
    ask --json --region "street:Well Lane" --threads 3 --time 0 && sed 's/"seconds".*//' out | cmp -s - one
result $? "any number of threads gives the same table"

run influence builtin:city -q --region pixel:640,600 --top 3 &&
    [ "$(sed '1,/share .*m away/d' out | grep -c ' ±.* ±')" = 5 ] &&
    awk '/by kind/ { on = 1; next } /m away/ { on = 0 } on { sub("±", " "); sum += $3 }
        END { exit !(sum > 99.9 && sum < 100.1) }' out &&
    grep -q 'cd/m2 .* towards the camera' out && grep -Eq ' [0-9,]+ others$' out
result $? "a pixel has three rows, the others, the sky, its luminance, and kinds that sum up"

# Windows stand beside the sums; --count-windows takes them in.
cat >apart.py <<'PY'
import csv, json, sys
counted = len(sys.argv) > 1
with open('out') as f:
    j = json.load(f)
kinds = {k['kind']: k for k in j['kinds']}
near = lambda a, b: abs(a - b) < 1e-4 * b
assert j['windows_counted'] is counted and near(j['lamps'], kinds['lamp']['lux']), j
assert j['windows'] > .2 and near(j['windows'], kinds['window']['lux']) and j['windows_error'] > 0, j
rest = sum(k['lux'] for k in j['kinds'] if k['kind'] != 'window') + j['sky']
assert near(j['lux'], rest + counted * j['windows']), (j['lux'], rest, j['windows'])
assert sum(k['share'] or 0 for k in j['kinds']) + j['sky_share'] - 1 < 1e-6
assert (kinds['window']['share'] is not None) is counted, kinds
assert any(row['kind'] == 'window' for row in j['rows']) is counted
for c in j['classes']:
    assert c['lamps'] > 0 and c['windows'] > 0 and c['lux'] > c['lamps'] + counted * c['windows'] - 1e-9, c
with open('city.csv') as f:
    rows = list(csv.DictReader(f))
all, = [row for row in rows if row['kind'] == 'all']
assert all['name'] == ('windows counted' if counted else 'without windows'), all
assert near(float(all['lux']), j['lux']) and near(float(all['lamps_lux']), j['lamps']), all
assert near(float(all['windows_lux']), j['windows']) and float(all['windows_lux_error']) > 0, all
assert any(row['kind'] == 'window' for row in rows) is counted
assert [row['name'] for row in rows if row['kind'] == 'kind'][:2] == ['lamp', 'window']
PY
run influence builtin:city -q --json --csv city.csv --region "street:street 1" --top 400 && python3 apart.py
result $? "windows are told beside lamps and not counted"
run influence builtin:city -q --json --csv city.csv --region "street:street 1" --top 400 --count-windows &&
    python3 apart.py counted
result $? "--count-windows counts them"
run influence builtin:city -q --region "street:street 1" --top 1 &&
    sed -n 2p out | grep -Eq '^[0-9.]+ lx ± [0-9.]+ by 13[0-9] lamps$' &&
    sed -n 3p out | grep -Eq '^[0-9.]+ lx ± [0-9.]+ by [0-9]+ windows, not counted below' &&
    sed -n 4p out | grep -Eq '^[0-9.]+ lx ± .* by [0-9]+ lights and the sky, without windows$' &&
    sed '1,/by kind/d' out | sed -n '1s/.* //p;2s/.* //p' | tr '\n' ' ' | grep -qx 'lamps windows '
result $? "lamps come first"

run build builtin:city -o city.noct -q && run influence city.noct -q --region "street:street 1" --top 2 &&
    [ "$(grep -c '  lamp ' out)" -ge 1 ]
result $? "a built city knows its streets"

# Lamps give --maintenance of their flux, in files, by the rule and in builtin:city; windows give all of theirs.
for factor in 1 0.8; do
    ask --json --region "street:Well Lane" --maintenance $factor --time 0 && cp out kept$factor.json
    run influence builtin:city -q --json --region "street:street 1" --error .005 --time 0 --maintenance $factor
    cp out city$factor.json
done
cat >kept.py <<'PY'
import json
load = lambda name: json.load(open(name))
a, b = load('kept1.json'), load('kept0.8.json')
near = lambda x, y, within: abs(x - y) <= within * y
assert a['maintenance'] == 1 and b['maintenance'] == .8, (a, b)
assert near(b['lux'], .8 * a['lux'], 1e-5) and near(b['lamps'], .8 * a['lamps'], 1e-5), (a['lux'], b['lux'])
assert [near(y['lumens'], .8 * x['lumens'], 1e-5) for x, y in zip(a['rows'], b['rows'])] == [True, True]
a, b = load('city1.json'), load('city0.8.json')
assert near(b['lamps'], .8 * a['lamps'], .02), (a['lamps'], b['lamps'])
assert near(b['windows'], a['windows'], .06), (a['windows'], b['windows'])
PY
python3 kept.py
result $? "a maintenance factor scales lamps alone"
upkeep='lamps give 0.8 of their flux (--maintenance); meshes that shine, windows and cars all of theirs'
ask --region "street:Well Lane" --maintenance 0.8 --csv kept.csv && grep -q "^$upkeep\$" out &&
    head -n 1 kept.csv | grep -q ',maintenance,region$' && [ "$(grep -c ',0.8,"street:Well Lane"$' kept.csv)" = 7 ]
result $? "and each answer says so"
run influence builtin:city -q --region pixel:40,50 --width 64 --height 64 --time .1 && head -n 1 out >place1
run influence builtin:city -q --region pixel:40,50 --width 64 --height 64 --time .1 --maintenance 0.3 &&
    head -n 1 out | cmp -s - place1
result $? "the camera does not move with it"
for bad in 0 1.01 -1; do
    expect "no maintenance factor of $bad" 2 'maintenance: .* is outside 0.01 to 1' \
        influence map.osm --region point:0,0 --maintenance=$bad
done
run build builtin:city -o kept.noct -q --maintenance 0.8 && run influence kept.noct -q --json --region pixel:64,64 \
    --time .1 && grep -q '"maintenance": 0.8' out && run info kept.noct --scene --json &&
    grep -q '"maintenance": 0.8' out
result $? "a built city keeps it"
expect "which is decided there" 2 "built already.*--group lamps=0.8" \
    influence kept.noct --region pixel:64,64 --maintenance 0.9

run influence map.osm --map-surfaces -q --lamp node/12 --top 2
grep -q '^node/12: lamp$' out && grep -q '^flux  *9,000 lm of 1 light' out &&
    grep -q '^tags .*highway=street_lamp$' out &&
    grep -q '^ *light:lumens=9000$' out && grep -q '^file .*map.osm$' out && grep -q '^street  *Well Lane$' out &&
    grep -Eq 'm2 get 1 lx or more of it' out && [ "$(grep -c ' lm .* %  ' out)" = 2 ]
result $? "a lamp tells its tags, its flux and what it lights"
run influence map.osm --map-surfaces -q --lamp node/12 --json && python3 -c "
import json
with open('out') as f:
    j = json.load(f)
assert j['tags']['light:lumens'] == '9000' and j['area_1lx'] > 50 and j['far_01lx'] > 10, j
assert j['objects'][0]['lumens'] > 100, j
"
result $? "the same as JSON"
expect "a lamp that is not there, and the nearest" 1 'is it "node/1' influence map.osm -q --lamp node/1
expect "a region or a lamp" 2 'exclude each other' influence map.osm --lamp node/11 --region point:0,0

run influence map.osm --map-surfaces -q --region point:13.4002,52.50003,EPSG:4326 --region "street:Well Lane"
[ $status = 0 ] && grep -q '^point:13.4002,52.50003,EPSG:4326: at ' out && grep -q '^street:Well Lane: around ' out
result $? "two regions have two answers"
run influence map.osm --map-surfaces -q --json --region point:13.4003,52.50000,EPSG:4326 --region "street:Well Lane"
[ $status = 0 ] && python3 -c "
import json
with open('out') as f:
    j = json.load(f)
assert [r['region'][:6] for r in j] == ['point:', 'street'] and all(r['lux'] > 0 for r in j), j
"
result $? "two regions in JSON are an array"
run influence map.osm --map-surfaces -q --json --region point:13.4003,52.50000,EPSG:4326 --region object:none
[ $status = 1 ] && python3 -c "
import json
with open('out') as f:
    assert len(json.load(f)) == 1
"
result $? "of those before one that cannot be answered"
run influence map.osm --map-surfaces -q --csv two.csv --region point:13.4003,52.50000,EPSG:4326 \
    --region "street:Well Lane" && [ "$(grep -c '^rank,' two.csv)" = 1 ] && python3 -c "
import csv
rows = list(csv.DictReader(open('two.csv')))
both = {r['region'] for r in rows}
assert both == {'point:13.4003,52.50000,EPSG:4326', 'street:Well Lane'}, both
assert [r['region'][:6] for r in rows if r['kind'] == 'all'] == ['point:', 'street'], rows
"
result $? "two regions in CSV are told apart by a column"

# A place that is dark says why; shares of no light, and the luminance of a place, are none.
run influence builtin:city -q --region point:10,10,-0.3 --csv dark.csv --sky 0 &&
    grep -q 'below the ground by 0.4 m' out &&
    python3 -c "
import csv
all = [r for r in csv.DictReader(open('dark.csv')) if r['kind'] == 'all'][0]
assert float(all['lux']) == 0 and all['share'] == '', all
"
result $? "below the ground it is dark, which the answer says"
run influence builtin:city -q --region point:10,10,-0.3 --region point:0,0 --region pixel:640,500 --time .1 --json &&
    python3 -c "
import json
dark, lit, seen = json.load(open('out'))
assert dark['note'].startswith('below the ground') and dark['lux'] == 0 and dark['sky_share'] is None, dark
assert lit['note'] == '' and lit['luminance'] is None and lit['luminance_error'] is None, lit
assert seen['luminance'] > 0 and all(r['kelvin'] in (None, round(r['kelvin'] or 0)) for r in lit['rows']), seen
"
result $? "and JSON, too"

expect "which region?" 2 "region is needed" influence builtin:city
expect "which city?" 2 "which city" influence --region point:0,0
expect "a street that is not there, and the nearest" 1 'no street "Well Lone"; is it "Well Lane"' \
    influence map.osm --region "street:Well Lone"
expect "a class that is not there, and the nearest" 2 'is it wall' influence map.osm --region object:x --class wal
expect "a kind of region that is not there" 1 'is it street:' influence map.osm --region stret:x

# Outputs that cannot be are refused before any input is read: this one is not even there.
for bad in /nonexistent/x.csv /tmp /dev/full; do
    expect "no CSV to $bad, before the work" 1 'folder|no ordinary file' \
        influence not-there.gml --region point:0,0 --csv "$bad"
done
cp map.osm kept.osm
expect "an input is not overwritten" 1 'is an input too' influence map.osm --region point:0,0 --csv map.osm
cmp -s map.osm kept.osm
result $? "and stays as it is"
ask --region "street:Well Lane" --csv - && head -n 1 out | grep -q '^rank,name,' && [ "$(wc -l <out)" = 8 ]
result $? "--csv - writes CSV in place of the table"
expect "one of two on standard output" 2 'exclude each other' influence map.osm --region point:0,0 --csv - --json
expect "classes are those of objects" 2 'is for --region object' influence map.osm --region point:0,0 --class wall
expect "and not of lamps" 2 'is for --region object' influence map.osm --lamp node/12 --class wall
if [ -w /dev/full ]; then
    "$program" influence map.osm --map-surfaces -q --region "street:Well Lane" >/dev/full 2>err
    [ $? = 1 ] && grep -q 'No space left' err
    result $? "a full disk is told"
fi
start influence builtin:city --region "street:street 1" --error 1e-6 --time 0
until grep -qs 'asking who lights' err || ! kill -0 $pid 2>/dev/null; do sleep 0.1; done
kill -INT $pid
wait $pid
status=$?
[ $status = 130 ] && grep -q interrupted err && [ ! -s out ]; result $? "Ctrl-C ends it" "$status"
finish
