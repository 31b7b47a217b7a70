#!/bin/sh
# Inputs that are no use: status 1, one line that names the file, no picture, no crash. And one that is.
. "$(dirname "$0")/lib.sh"
gml=$source_dir/tests/cli/city.gml
mkdir folder
: >empty.gml
head -c 3000 /dev/urandom >noise.gml
printf '\211PNG\r\n\032\n and nothing more' >picture.gml
printf '\037\213\010\000' >cut.gml.gz
printf 'PK\003\004' >cut.zip
printf '<?xml version="1.0"?><html><body>no city</body></html>' >page.gml
printf '{"type": "Feat' >cut.geojson
head -c 900 "$gml" >cut.gml
gzip -c "$gml" >whole.gml.gz && head -c 400 whole.gml.gz >half.gml.gz
long=$(head -c 10000 /dev/zero | tr '\0' x)
bytes=$(printf 'caf\351\377.gml')

for input in missing.gml folder empty.gml noise.gml picture.gml cut.gml.gz cut.zip page.gml cut.geojson cut.gml \
    half.gml.gz /dev/zero \
    /dev/null builtin:town "$bytes" "$long"; do
    shown=$(printf '%.40s' "$input" | tr -cd '\40-\176')
    for command in "render -o x.png" info; do
        run $command "$input"
        test $status = 1 && test "$(grep -vc warning err)" = 1 && test ! -e x.png
        result $? "$command of $shown" "status $status"
    done
done
run render "$gml" missing.gml -o x.png
test $status = 1 && grep -q missing.gml err && test ! -e x.png; result $? "one missing file of two"

grep -v surfaceMember "$gml" >bare.gml
expect "a city without surfaces" 1 'no surface that can be drawn' render bare.gml -o x.png

run info "$gml"
test $status = 0 && grep -q 'CityGML 2.0' out && grep -q 'EPSG:25832' out && grep -Eq 'wall +4$' out &&
    grep -Eq 'roof +1$' out &&
    grep -Eq 'skipped +1 x .*(two-points|stump)' out && grep -q '1 in LOD2' out
result $? "info of a house"
run info whole.gml.gz "$gml"
test $status = 0 && test "$(grep -c '^  format' out)" = 2; result $? "info of two files, one packed"
printf '%s\n' IESNA:LM-63-2002 '[LUMINAIRE] ball' TILT=NONE '1 1000 1 3 1 1 2 0 0 0' '1 1 10' '0 90 180' 0 \
    '100 100 100' >ball.ies
run info ball.ies "$gml"
test $status = 0 && grep -q '^  flux  *1257 lm' out && grep -q 'upward  *50.00%' out &&
    grep -q '26 % more than the 1000' err && test "$(grep -c '^  format' out)" = 2
result $? "info of a luminaire, which makes more light than its lamps"
run info --json ball.ies
grep -q '"flux_error": 0.256637' out && python3 -m json.tool <out >/dev/null; result $? "info of a luminaire as JSON"
sed 's/^1 1000/1 0/' ball.ies >none.ies
run info none.ies
test $status = 0 && grep -q '1257 lm; its lamps 0 lm$' out && ! grep -Eqi 'nan|inf[^o]' out
result $? "a luminaire whose lamps state 0 lm" "$(grep flux out)"
sed 's/^0 90/0 -90/' ball.ies >bad.ies
run info bad.ies
test $status = 1 && grep -q 'bad.ies:6: a vertical angle is out of its range' err
result $? "a luminaire's angle that is none"
run info missing.gml "$gml"
test $status = 1 && grep -q 'CityGML 2.0' out && grep -q missing.gml err
result $? "a missing file does not hide the next"
run info --json "$gml" missing.gml builtin:city --city-size 150
python3 - out >err <<'END'
import json, sys
files = json.load(open(sys.argv[1]))["files"]
assert len(files) == 3, files
house, missing, city = files
assert house["polygons_by_class"] == {"wall": 4, "roof": 1, "ground": 1}, house
assert house["extent_min"] == [678000, 5403000, 400] and house["extent_max"] == [678010, 5403008, 406], house
assert house["buildings_by_lod"] == [0, 0, 1, 0, 0], house
assert any(i["action"] == "skipped" and i["count"] == 1 for i in house["issues"]), house
assert "missing.gml" in missing["error"], missing
assert city["triangles"] > 1000 and city["lights"] > 10, city
END
result $? "info as JSON"

# Formats that are known, but not read.
refused() { # name, part of the message; the file is "stranger"
    run render stranger -o x.png
    test $status = 1 && test "$(wc -l <err)" = 1 && grep -q "stranger.*$2" err && ! grep -q 'none of the formats' err &&
        test ! -e x.png
    result $? "refused by name: $1" "$(cat err)"
}
printf 'nocturne: 1\ninputs: [stranger]\n' >stranger; refused "a recipe that names itself" 'this is a recipe'
printf 'IESNA:LM-63-2002\r\n[TEST] 1\r\nTILT=NONE\r\n1 1000 1 5 1 1 2 0 0 0\r\n' >stranger; refused IES '(IES)'
printf 'ACME\r\n1\r\n2\r\n36\r\n10\r\n37\r\n2,5\r\nREPORT\r\n' >stranger; refused EULUMDAT '(EULUMDAT)'
printf '<?xml version="1.0"?>\n<OpenDRIVE>\n<header revMajor="1"/></OpenDRIVE>' >stranger
refused OpenDRIVE 'OpenDRIVE.*CityGML'
printf '<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"><Document/></kml>' >stranger
refused KML 'KML.*GeoJSON'
python3 - <<'END'
import zipfile
with zipfile.ZipFile("stranger", "w") as z:
    z.writestr("[Content_Types].xml", '<?xml version="1.0"?>'
                                      '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"/>')
    z.writestr("xl/workbook.xml", "<workbook/>")
END
refused XLSX 'XLSX.*CSV'
printf 'ACME\n1\n2\n36\nten\n' >stranger
expect "anything else is told what is read" 1 'none of the formats.*GeoJSONSeq, ArcGIS JSON, GML, GeoPackage' \
    render stranger -o x.png

# Ids are whole, for a part of one cannot be searched for; and causes of lamps come first.
python3 - >many.csv <<'END'
print("lat,lon,lamp_type,id,height,lumens,cct")
for i in range(9):
    print(f"48.7546,11.422{i},LED,UUID_{i:040d},99999,5000,3000")
END
run info many.csv
grep -Eq '9 x height of a lamp.*: UUID_0{40} and 8 more$' out
result $? "info shows whole ids, and how many more there are"
run render "$gml" many.csv --frames 1 --size 32x18 -o x.png
test $status = 0 && grep -A1 'features skipped' out | grep -Eq '9 x height of a lamp.*: UUID_0{40} and 8 more$'
result $? "so does the summary, with lamps first"
rm -f x.png
sed 's/,99999,5000,3000$/,99999,1,5/; s/cct$/cct,watts/; s/,5$/,5,1e9/' many.csv >worse.csv
cp "$gml" house.gml
run render house.gml worse.csv --strict --frames 1 --size 32x18 -o x.png
test $status = 1 && grep -Eq 'UUID_0{40}, ' err &&
    ! grep -Eq 'UUID_[0-9]{0,39}([^0-9]|$)' err &&
    grep -Eq '(height of a lamp|colour temperature) not understood or implausible(: "[^"]*")?(;|$)' err
result $? "and --strict, where there is room"
python3 - "$gml" >twin.gml <<'END'
import re, sys
text = open(sys.argv[1]).read()
roof = re.search(r'<gml:surfaceMember><gml:Polygon gml:id="p2">.*?</gml:surfaceMember>', text, re.S).group(0)
solid = ("<bldg:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface>%s</gml:CompositeSurface></gml:exterior>"
         "</gml:Solid>")
again = "</bldg:lod2Solid><bldg:lod2MultiSurface><gml:MultiSurface>%s</gml:MultiSurface></bldg:lod2MultiSurface>"
link = '<gml:surfaceMember xlink:href="#p2"/>'
building = '<bldg:Building gml:id="house">%s</bldg:Building>' % (solid % (roof + link) + again %
                                                                 roof.replace("p2", "p2b"))
print(re.sub("<bldg:Building.*</bldg:Building>", lambda m: building, text, flags=re.S))
END
run info -v twin.gml
grep -q '1 given twice, 1 named again' err && grep -q ' 1 x polygon given twice: p2b$' out
result $? "a polygon that is given twice is counted alike by -v and in the report"

# Outlines of buildings: counted, told, and nothing that --strict lets pass.
if [ "$("$program" --version | grep -ci gdal)" != 0 ]; then
    cat >outlines.geojson <<'END'
{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"a": 1}, "geometry": {"type": "Polygon",
    "coordinates": [[[8, 50], [8.5, 50], [8.5, 50.25], [8, 50]]]}},
{"type": "Feature", "properties": {"a": 2}, "geometry": {"type": "Polygon",
    "coordinates": [[[8, 50], [8.5, 50], [8.5, 50.25], [8, 50]]]}}]}
END
    run info outlines.geojson
    grep -q 'CRS .*WGS 84' out && grep -q 'x 8.000000 to 8.500000, y 50.000000 to 50.250000' out &&
        grep -q 'features  *2 polygons' out &&
        ! grep -q objects out
    result $? "info of outlines tells their CRS, extent and number"
    run render "$gml" outlines.geojson --frames 1 --size 32x18 -o x.png
    test $status = 0 &&
        grep -q '2 polygons are not read: of maps only lamps and roads are read, and with --footprints' err &&
        grep -q '2 x polygon that is not read' out
    result $? "outlines are told of by render"
    rm -f x.png
    expect "outlines are refused by --strict" 1 '2 x polygon that is not read' render "$gml" outlines.geojson --strict \
        --size 32x18 -o x.png
else
    skip "outlines of buildings" "no GDAL"
fi

# What begins like a formula is text to spreadsheets.
printf 'id,lon,lat\n=1+1,8,50\n' >formula.csv
run info --each-lamp --lamps formula.csv
test $status = 0 && grep -q "^\"'=1+1\",mapped," out
result $? "names of lamps are no formulas"

# Degrees of three digits: a building is a point.
cat >coarse.city.json <<'END'
{"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[0,0,0]},
"metadata":{"referenceSystem":"https://www.opengis.net/def/crs/OGC/1.3/CRS84"},"CityObjects":{"b":{"type":"Building",
"geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2,3]]]}]}},
"vertices":[[4300,52070,9000],[4300,52070,9000],[4300,52070,9000],[4300,52070,9000]]}
END
run render coarse.city.json --size 16x9 -o coarse.png
grep -q 'coarse.city.json: nothing of it is drawn: 1 of its surfaces collapse' err
result $? "a model whose surfaces collapse is told of"

# A line a lamp, mapped or inferred.
cat >lit.osm <<'END'
<osm version="0.6"><node id="1" lat="50" lon="8"/><node id="2" lat="50" lon="8.002"/>
<node id="3" lat="50.01" lon="8"><tag k="highway" v="street_lamp"/></node>
<way id="4"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/><tag k="lit" v="yes"/></way></osm>
END
if [ "$("$program" --version | grep -ci gdal)" != 0 ]; then
    run info --each-lamp --infer-lamps lit.osm
    test $status = 0 && head -n 1 out | grep -q '^name,placed,x,y,z,lumens,shape,group,kelvin,.*,crs,tags$' &&
        test "$(wc -l <out)" = 8 &&
        grep -q '^"node/3",mapped,.*,5000,disc,"lamps",3000,.*,"highway=street_lamp"$' out &&
        test "$(grep -c '^"inferred/way/4/[1-6]",inferred,' out)" = 6
    result $? "info of each lamp"
    run info --each-lamp --infer-lamps --json lit.osm
    test $status = 0 && test "$(grep -c '"placed": "inferred".*"group": "lamps"' out)" = 6 &&
        grep -q '"lumens": 1650,.*"kelvin": 3000, "watts": null,.*"road": "residential",.*"lon": 8.00' out
    result $? "info of each lamp as JSON"
    run build --infer-lamps lit.osm -o lit.noct && run info --each-lamp lit.noct
    test $status = 0 && test "$(wc -l <out)" = 8 &&
        grep -q '^"node/3",mapped,.*"lamps",3000,,"","","","",6.00,,0.0,"","",7.99999[0-9]*,50.00999' out
    result $? "info of each lamp of a built city"
    run render --infer-lamps --map-surfaces lit.osm --size 64x36 --frames 2 --show placed -o placed.png
    test $status = 0 && grep -q '2 inferred lamps [0-9.]*%' out && ! grep -q other out
    result $? "a view of where inferred lamps lead"
else
    skip "info of each lamp" "no GDAL"
fi

# A file whose CRS is the wrong one: its lamps land where they should, and no others move.
lamp_of() { # NAME X Y of a GeoJSON's lamp; in which CRS: its "crs" member
    printf '{"type":"FeatureCollection",%s"features":[{"type":"Feature","properties":{"highway":"street_lamp"},
"geometry":{"type":"Point","coordinates":[%s,%s]}}]}' "$4" "$2" "$3" >"$1"
}
member='"crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::'
lamp_of other.geojson 11.4225 48.7549 ''
where() { # the lamp's easting and northing by the file's name, without its arm
    python3 - "$1" <<'END'
import csv, sys
for row in csv.DictReader(open("out")):
    if row["file"] == sys.argv[1]:
        print(round(float(row["x"]) / 5) * 5, round(float(row["y"]) / 5) * 5)
END
}
if [ "$("$program" --version | grep -ci gdal)" != 0 ]; then
    run info --each-lamp "$gml" other.geojson
    other=$(where other.geojson)
    for named in 25833 4326; do
        lamp_of wrong.geojson 678020 5403020 "$member$named\"}},"
        run info --each-lamp "$gml" wrong.geojson other.geojson --file-crs wrong.geojson=EPSG:25832
        test $status = 0 && test "$(where wrong.geojson)" = "678020 5403020" && test "$other" &&
            test "$(where other.geojson)" = "$other" &&
            grep -q "wrong.geojson: its coordinates are taken as EPSG:25832 (.*what it names, EPSG:$named (" err
        result $? "lamps under the name of another CRS, EPSG:$named" "$(cat err)"
    done
    run info --json wrong.geojson --file-crs wrong.geojson=EPSG:25832
    grep -q '"crs_from": "option"' out && grep -q '"crs_given": "EPSG:4326"' out
    result $? "and info tells both"
    printf 'nocturne: 1\ninputs: [%s, sub/wrong.geojson]\nfile-crs: sub/wrong.geojson=EPSG:25832\n' "$gml" >wrong.yaml
    mkdir sub && cp wrong.geojson sub
    run info --each-lamp wrong.yaml
    test $status = 0 && test "$(where sub/wrong.geojson)" = "678020 5403020"
    result $? "and so does a recipe" "$(cat err)"
    run init made "$gml" sub/wrong.geojson --file-crs wrong.geojson=EPSG:25832
    run info --each-lamp made/city.yaml
    test $status = 0 && test "$(where made/../sub/wrong.geojson)" = "678020 5403020"
    result $? "and one that init makes" "$(cat err)"
else
    skip "lamps under the name of another CRS" "no GDAL"
fi
expect "a file that is no input" 1 '"lost.gml=EPSG:25832": no input is called so' render "$gml" -o x.png \
    --file-crs lost.gml=EPSG:25832

# GDAL is loaded where a map is read, and only there: one that is none stands in its way.
if [ "$("$program" --version | grep -ci 'gdal [0-9]')" != 0 ] && ! ldd "$program" | grep -q lib[at]san; then
    library=$(sed -n 's/#define NOC_GDAL_LIBRARY "\(.*\)"/\1/p' "$NOC_BUILD/noc_config.h")
    mkdir broken && echo "no library" >"broken/$library"
    export LD_LIBRARY_PATH="$work/broken"
    run info "$gml"
    result $status "a CityGML is read without GDAL"
    for how in "" --no-isolate; do
        expect "a map without it${how:+, in the process itself}" 1 \
            "^nocturne: lit.osm: OpenStreetMap XML needs GDAL, which cannot be loaded: .*$library" info $how lit.osm
    done
    unset LD_LIBRARY_PATH
else
    skip "a missing GDAL" "no GDAL, or a sanitizer"
fi
# PROJ, where a CRS is read; Assimp, where an OBJ is.
if ! ldd "$program" | grep -q lib[at]san; then
    library=$(sed -n 's/#define NOC_PROJ_LIBRARY "\(.*\)"/\1/p' "$NOC_BUILD/noc_config.h")
    mkdir without && echo "no library" >"without/$library"
    export LD_LIBRARY_PATH="$work/without"
    run info builtin:single
    result $status "a built-in scene needs no PROJ"
    expect "a CityGML without it" 1 "the CRS .* cannot be read: PROJ cannot be loaded: .*$library" info "$gml"
    expect "--crs without it" 1 "^nocturne: --crs: no CRS can be read: PROJ cannot be loaded: .*$library" info \
        "$gml" --crs EPSG:25832
    library=$(sed -n 's/#define NOC_ASSIMP_LIBRARY "\(.*\)"/\1/p' "$NOC_BUILD/noc_config.h")
    if [ "$library" ]; then
        echo "no library" >"without/$library"
        printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >triangle.obj
        for how in "" --no-isolate; do
            expect "an OBJ without Assimp${how:+, in the process itself}" 1 \
                "^nocturne: triangle.obj: OBJ needs Assimp, which cannot be loaded: .*$library" info $how triangle.obj
        done
    else
        skip "a missing Assimp" "no Assimp"
    fi
    unset LD_LIBRARY_PATH
else
    skip "missing PROJ and Assimp" "a sanitizer"
fi

# Tables of which nothing tells that they are lamps: the user says so, and what their columns mean.
printf 'lat,lon,power\n48.76,11.42,70\n48.7601,11.4201,100\n' >plain.csv
printf 'ASSET,HT,XX,YY\nA,30,11.4202,48.7602\nB,,11.4203,48.7603\n' >strange.csv
expect "a table of points is offered --lamps" 1 'plain.csv.* --lamps plain.csv' render plain.csv -o x.png
expect "beside a city, too" 1 'plain.csv.* --lamps plain.csv' render "$gml" plain.csv -o x.png
ln -sf plain.csv linked.csv
for other in ./plain.csv "$PWD/plain.csv" linked.csv; do
    run info plain.csv --lamps "$other"
    test $status = 0 && grep -q 'lamps *2$' out
    result $? "a file that is named as lamps by another spelling is lamps" "$other"
    run render plain.csv --lamps "$other" --lamps plain.csv --size 16x16 --frames 1 -o twice.png
    test $status = 0 && test "$(meta twice.png lamps-mapped)" = 2 && test "$(meta twice.png lamps-repeated)" = 0
    result $? "and counts once" "$other"
done
rm linked.csv
expect "a table without coordinates is offered columns" 1 'strange.csv.*--lamps.*--lamp-columns' render strange.csv \
    -o x.png
expect "a column that is not there" 1 'no input has.*"HEIGHT".* lat, lon, power' render --lamps plain.csv \
    --lamp-columns height=HEIGHT -o x.png
for command in 'info' 'render -o x.png'; do
    expect "two columns for one field: $command" 1 \
        'strange.csv: lamp-columns: both "[A-Za-z]*" and "[A-Za-z]*" are mapped to height' \
        $command --lamps strange.csv --lamp-columns lon=XX,lat=YY,height_ft=ht,height=ASSET
done
expect "a field that is none" 1 'no field "heigth".*height, lumens' render --lamps plain.csv \
    --lamp-columns heigth=power -o x.png
expect "a city is no table of lamps" 1 'this is CityGML, and --lamps is for' render --lamps "$gml" -o x.png
expect "a built-in scene is no file of lamps" 1 'builtin:city is no file of lamps' render --lamps builtin:city -o x.png
test ! -e x.png; result $? "none of them leaves a picture"
run render "$gml" --lamps plain.csv --lamps strange.csv --lamp-columns lon=XX,lat=YY --lamp-columns height_ft=ht \
    --crs EPSG:25832 \
    --frames 1 --size 16x16 --no-windows -o x.png
test $status = 0 && grep -q ', 4 lights' out && test "$(meta x.png lamps)" = "plain.csv, strange.csv" &&
    test "$(meta x.png lamp-columns)" = "lon=XX,lat=YY,height_ft=ht"
result $? "named as lamps, with columns mapped"
run info plain.csv
test $status = 0 && grep -Eq 'points +2, and nothing tells' out && grep -Eq 'power +watts, W +70$' out
result $? "info shows columns and offers --lamps"
printf 'lat,lon,H\303\266he,Height,note\n48.76,11.42,8,9,x\n' >umlaut.csv
run info umlaut.csv
python3 - out >err <<'END'
import sys
rows = [line for line in open(sys.argv[1], encoding="utf-8") if " height, m " in line]
assert len(rows) == 2 and rows[0].index("height") == rows[1].index("height"), rows
END
result $? "info pads columns by characters" "$(cat err)"
run info --json --lamps strange.csv --lamp-columns lon=XX,lat=YY,height_ft=HT
python3 - out >err <<'END'
import json, sys
f = json.load(open(sys.argv[1]))["files"][0]
c = {x["name"]: x for x in f["columns"]}
assert (f["lamps"], f["points"], list(c)) == (2, 2, ["ASSET", "HT", "XX", "YY"]), f
assert (c["HT"]["field"], c["HT"]["unit"], c["HT"]["example"], c["HT"]["values"],
        c["HT"]["mapped"]) == ("height", "ft", "30", 1, True), c
assert (c["ASSET"]["field"], c["ASSET"]["mapped"]) == ("", False), c
assert abs(f["lamp_height_max"] - 9.144) < 1e-6, f
END
result $? "info as JSON tells of columns"

# What lamps tell of themselves: two heads, 8 m and sodium on one; nothing on the other.
printf '{"type": "FeatureCollection", "features": [{"type": "Feature", "id": "a",
    "properties": {"highway": "street_lamp",
    "height": "8", "lamp_count": "2", "light:method": "high_pressure_sodium", "light:count": "2"},
    "geometry": {"type": "Point", "coordinates": [11.42, 48.76]}}, {"type": "Feature", "id": "b",
    "properties": {"highway": "street_lamp"}, "geometry": {"type": "Point",
    "coordinates": [11.421, 48.76]}}]}' >lamps.geojson
run info lamps.geojson
grep -q 'lamps  *2 with 3 heads' out && grep -Eq 'height  *1, 50.0%: 8 to 8 m' out && grep -Eq 'sodium  *1, 50.0%' out
result $? "info tells what is known of lamps"
run info --json lamps.geojson
python3 - out <<'END'
import json, sys
f = json.load(open(sys.argv[1]))["files"][0]
assert (f["lamps"], f["lamp_heads"], f["lamps_with_height"], f["lamps_with_watts"]) == (2, 3, 1, 0), f
assert f["lamps_by_source"] == {"unknown": 1, "sodium": 1} and f["lamp_height_max"] == 8, f
END
result $? "and so as JSON"

# A camera in the file's coordinates is the same as one in the scene's frame, which the metadata places in the world.
view='--size 48x27 --frames 1'
run render "$gml" $view --camera-crs EPSG:25832 --eye 678030,5402980,412 --target 678005,5403004,403 -o a.png
test $status = 0; result $? "a camera in CRS coordinates"
case "$(meta a.png given-crs-name)" in "EPSG:25832 "*) true ;; *) false ;; esac &&
    test "$(meta a.png given-origin)" = "$(meta a.png scene-origin)" &&
    grep -q ', EPSG:25832 ' out && grep -q 'origin  *678[0-9.]*,5403' out
result $? "the metadata and the summary tell CRS and origin"
grep -q 'features skipped: 1, repaired: 0' out; result $? "the summary tells that something was skipped"
grep -Eq '^ +1 x .*(two-points|stump)' out; result $? "and why"
printf '{"type": "FeatureCollection", "features": [{"type": "Feature", "id": "far",
    "properties": {"highway": "street_lamp"},
    "geometry": {"type": "Point", "coordinates": [11.6, 48.76]}}]}' >far.geojson
expect "lamps that are all of no use are an error" 1 'far.geojson: none of 1 lamp is of use, 1 outside the city' \
    render "$gml" far.geojson $view -o far.png
test ! -e far.png; result $? "and no picture is written"
run render "$gml" far.geojson --infer-lamps $view -o far.png
grep -q '1 x lamp more than 2 km outside the city: far' out; result $? "the summary tells why a lamp is not there"
grep -q 'lamps  *1 inferred, 1 dropped' out &&
    test "$(meta far.png lamps-mapped) $(meta far.png lamps-dropped) $(meta far.png lamps-inferred)" = "0 1 1" &&
    test "$(meta far.png infer-lamps) $(meta far.png features-skipped)" = "true 2"
result $? "and the metadata how many there are"
printf 'lamp_id,lon,lat,lamp_type\na,48.7591,11.4226,LED\nb,48.7592,11.4227,LED\n' >swapped.csv
run render "$gml" swapped.csv $view -o s.png
test $status = 0 && grep -q 'lamps  *2 mapped' out &&
    grep -q 'swapped.csv: lies where the other inputs do only with latitude and longitude exchanged: done' err
result $? "exchanged axes of a table are put right, and told"
sed 's/^\([ab]\),\([0-9.]*\),\([0-9.]*\)/\1,\3,\2/' swapped.csv >right.csv
run render "$gml" right.csv $view -o s.exr
test $status = 0 && grep -q 'lamps  *2 mapped' out && grep -aq 'lamps-mapped' s.exr &&
    grep -aq 'features-repaired' s.exr
result $? "the right way round they light the city, and an EXR tells how many"
assumed='2 without height: 6 m (--lamp-height), '
assumed=$assumed'2 without flux: 5000 lm each, 500 at most below 1.5 m (--lamp-lumens), 2 without colour: 3000 K'
grep -q "assumed  *$assumed" out &&
    grep -aq 'lamps-colour-assumed' s.exr
result $? "what they do not tell, and what is taken for it, is told"
printf 'id,lon,lat,lamp_height,lumens\na,11.4226,48.7591,5,900\nb,11.4227,48.7592,,900\n' >told.csv
run render "$gml" told.csv $view --lamp-kelvin 2700 -o told.png
test "$(meta told.png lamps-height-assumed) $(meta told.png lamps-flux-assumed) $(meta told.png lamps-colour-assumed)" \
    = "1 0 2" && test "$(meta told.png lamps-direction-assumed)" = 2 &&
    grep -q 'assumed  *1 without height: 6 m (--lamp-height), 2 without colour: 2700 K (--lamp-kelvin), 2' out &&
    grep -q ', 2 without direction: by chance$' out
result $? "and in the metadata"
printf '%s\n' 'id;lon;lat;lamp_height;lumens;watts;cct' 'a;11,4226;48,7591;5;1.200;20;2700' \
    'b;11,4227;48,7592;1.200;9.000;70;4000' >comma.csv
run info comma.csv
grep -q 'lumens  *2, 100.0%: 1200 to 9000 lm' out && grep -q 'watts  *2, 100.0%: 20 to 70 W' out &&
    grep -q 'colour  *2, 100.0%: 2700 to 4000 K' out
result $? "info tells the ranges that were understood"
grep -q "decimals  *behind ','; a '.' before three digits" out &&
    grep -q 'guessed  *1 x height of a lamp not understood or implausible: b' out
result $? "and the decimal sign, and that no lamp is 1200 m high"
run info --json comma.csv
python3 -c 'import json; f = json.load(open("out"))["files"][0]
assert f["decimal_sign"] == "," and f["lamp_lumens_max"] == 9000 and f[
    "lamp_watts_min"] == 20 and f["lamp_kelvin_max"] == 4000, f
assert [i["action"] for i in f["issues"]] == ["guessed"] and f["crs_given"] == "" and f["crs_from"] == "format", f'
result $? "in JSON, too"
run info told.csv
grep -q 'CRS .*, taken as such: the file names none$' out; result $? "a CRS that no file names is not said to be given"
grep -q 'assumed  *1 without height: 6 m (--lamp-height), 2 without colour: 3000 K (--lamp-kelvin)$' out
result $? "and info tells it"
expect "--strict refuses what the user did not say" 1 \
    'guessed at: 1; 1 x lamp without height .--lamp-height 6 takes that.$' \
    info told.csv --strict --lamp-kelvin 3000
run info told.csv --strict --lamp-kelvin 3000 --lamp-height 6
test $status = 0; result $? "and takes what the user did"
expect "--strict refuses what is left out" 1 'strict: features left out: 1, .*city.gml: 1 x .*(two-points|stump)' \
    render "$gml" right.csv --strict $view -o strict.png
test ! -e strict.png; result $? "without a picture"
run info --strict "$gml"
test $status = 1 && grep -q 'skipped  *1 x' out && grep -q 'strict: features left out: 1' err
result $? "and info, which tells it all the same"
set -- $(meta a.png scene-origin)
test $# = 3 && run render "$gml" $view -o b.png \
    --eye "$(echo "678030 5402980 412 $*" | awk '{printf "%.3f,%.3f,%.3f", $1-$4, $2-$5, $3-$6}')" \
    --target "$(echo "678005 5403004 403 $*" | awk '{printf "%.3f,%.3f,%.3f", $1-$4, $2-$5, $3-$6}')"
run compare a.png b.png --json
grep -q '"all": {.*"rmse8": 0,' out; result $? "is the same as in the scene's frame"
run render "$gml" $view --camera-crs EPSG:nonsense --eye 0,0,0 --target 1,1,1 -o c.png
test $status = 1 && test ! -e c.png; result $? "a camera in no known CRS"
run render builtin:city --city-size 150 $view --camera-crs EPSG:25832 --eye 0,0,0 --target 1,1,1 -o c.png
test $status = 1 && test ! -e c.png; result $? "a camera in a CRS where the scene has none"

# Pictures that succeed and show nothing: said, with the likely cause.
rm -f d.png
expect "a camera in map coordinates" 1 '^nocturne: the camera is .*km away from a scene .*--camera-crs scene' \
    render "$gml" $view --eye 678030,5402980,412 --target 678005,5403004,403 -o d.png
test ! -e d.png; result $? "and nothing is written"
expect "a camera with its axes exchanged" 1 'with the first two numbers of --eye exchanged it is 0.0 km away' \
    render "$gml" $view --camera-crs EPSG:4326 --eye 48.75436,11.42222,412 --target 48.75458,11.42189,403 -q -o d.png
test "$(wc -l <err)" = 1; result $? "in one line, also with -q"
expect "a camera in another country" 1 'km away from a scene .*are eye and --camera-crs right' \
    render "$gml" $view --camera-crs EPSG:4326 --eye 2.35,48.85,412 --target 2.36,48.85,403 -o d.png
expect "a camera that is merely far away" 0 'warning: the camera is .*km away from a scene' \
    render "$gml" $view --eye 50000,0,412 --target 0,0,0 -o d.png
expect "a camera that looks at the sky" 0 'sees nothing that a lamp could light' \
    render "$gml" $view --eye 20,-20,430 --target 20,-20,1000 -o d.png
expect "a camera inside a building" 0 'inside a building' \
    render "$gml" $view --camera-crs scene --eye 678005,5403004,402 --target 678006,5403004,402 -o d.png
run render "$gml" $view --camera-crs EPSG:25832 --eye 678030,5402980,412 --target 678005,5403004,403 -o d.png
test "$(grep -c 'warning' err)" = 1 && grep -q 'placed by a rule' err; result $? "and a good one brings no such warning"
run render "$gml" $view --camera-crs EPSG:25832 --eye 678030,5402980,412 --target 678005,5403004,403 --exposure 17 \
    -o d.exr
test $status = 0 && grep -q 'automatic exposure would be' out && ! grep -q '17.00' out
result $? "the automatic exposure of an EXR is not the one given"

# A mesh: metres, in the CRS that --crs says; the file of which nothing is read is asked for none.
printf 'v 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n' >ground.obj
run info ground.obj
grep -q 'CRS  *none (to put it in place' out && grep -q 'x 0.00 to 1.00, y 0.00 to 1.00' out; result $? "info of an OBJ"
run info --crs EPSG:32618 ground.obj
grep -q 'CRS  *EPSG:32618' out && grep -q 'x 0.00 to 1.00,' out; result $? "info of an OBJ with --crs"

# A lamp whose face is wound to shine up lights no floor below it; the other way round it does. A floor has no street.
printf 'newmtl glow\nKe 100 100 100\nnewmtl grey\nKd 0.5 0.5 0.5\n' >lamp.mtl
printf '%s\n' 'mtllib lamp.mtl' 'v -3 0 -3' 'v 3 0 -3' 'v 3 0 3' 'v -3 0 3' 'v -1 3 -1' 'v 1 3 -1' 'v 1 3 1' \
    'v -1 3 1' 'usemtl grey' 'f 1 2 3 4' 'usemtl glow' 'f 8 7 6 5' >up.obj
sed 's/^f 8 7 6 5/f 5 6 7 8/' up.obj >down.obj
below="--eye 0,-4,1 --target 0,0,0 --sky 0 --size 32x18 --frames 1 -o room.png"
run render up.obj $below
black='the picture is black: the camera sees nothing that a lamp could light; surfaces shine from one side'
test $status = 0 && grep -q "^nocturne: warning: $black\$" err
result $? "a black picture below a lamp that shines up is told"
run render down.obj $below
quiet() { ! grep -v 'warning: Landlock is not here' err; } # which depends on the kernel
test $status = 0 && quiet; result $? "one that shines down lights it"
run render down.obj --size 32x18 --frames 1 -o out.png
test $status = 0 && quiet; result $? "a mesh is seen from outside"
run render down.obj --view street --size 32x18 --frames 1 -o out.png
test $status = 0 && grep -q '^nocturne: warning: view street: the scene has none, so it is seen from outside$' err
result $? "and where its street was asked for, that is said"
# A city whose degrees are in either order, with a lamp beside it, whose order is GeoJSON's: they are put together.
for order in city.lon-first city.lat-first; do
    python3 - $order <<'PY'
import json, sys
def corner(x, y, z):
    lon, lat = 11.42 + x / 73300, 48.75 + y / 111200
    return "%.7f %.7f %g" % ((lon, lat, z) if "lon" in sys.argv[1] else (lat, lon, z))
def face(points):
    return ("<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>%s</gml:posList>"
            "</gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>" %
            " ".join(corner(*p) for p in points + points[:1]))
a, b, c, d = (0, 0), (10, 0), (10, 8), (0, 8)
faces = [[p + (0,) for p in (a, d, c, b)], [p + (6,) for p in (a, b, c, d)]]
faces += [[p + (0,), q + (0,), q + (6,), p + (6,)] for p, q in ((a, b), (b, c), (c, d), (d, a))]
open(sys.argv[1] + ".gml", "w").write(
    '<CityModel xmlns="http://www.opengis.net/citygml/2.0" xmlns:gml="http://www.opengis.net/gml" '
    'xmlns:bldg="http://www.opengis.net/citygml/building/2.0"><gml:boundedBy><gml:Envelope srsName="EPSG:4326"/>'
    '</gml:boundedBy><cityObjectMember><bldg:Building><bldg:lod1MultiSurface><gml:MultiSurface>' +
    "".join(map(face, faces)) + '</gml:MultiSurface></bldg:lod1MultiSurface></bldg:Building></cityObjectMember>'
    '</CityModel>')
json.dump({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"highway": "street_lamp"},
           "geometry": {"type": "Point", "coordinates": [11.4198, 48.7499]}}]}, open("beside.geojson", "w"))
PY
    run render $order.gml beside.geojson --size 64x36 --frames 1 --show class -o order.png
    warned=$(grep -c 'only with latitude and longitude exchanged: done' err)
    test $status = 0 && grep -q 'EPSG:32632' out && grep -q '^  lamps  *1 mapped' out &&
        test "$warned" = "$(echo $order | grep -c lon)"
    result $? "degrees of $order beside a lamp" "$(cat err)"
done
# Where the lamps are exchanged, they are named and the city stays; a map that names lat and lon is never exchanged.
sed 's/11.4198, 48.7499/48.7499, 11.4198/' beside.geojson >turned.geojson
printf '<osm version="0.6"><node id="1" lat="48.7499" lon="11.4199"><tag k="highway" v="street_lamp"/></node></osm>' \
    >l.osm
for others in turned.geojson "turned.geojson l.osm" "l.osm turned.geojson"; do
    run render city.lat-first.gml $others --size 64x36 --frames 1 --show class -o order.png
    lamps=$(echo $others | wc -w)
    test $status = 0 && grep -q 'EPSG:32632' out && grep -q "^  lamps  *$lamps mapped" out &&
        grep -q '^nocturne: warning: turned.geojson: .*latitude and longitude exchanged: done' err &&
        test "$(grep -c 'exchanged: done' err)" = 1
    result $? "lamps in the other order: $others" "$(cat err)"
done
run render city.lat-first.gml turned.geojson --strict --size 64x36 --frames 1 -o order.png
test $status = 1 && grep -q 'axes exchanged to meet the other inputs' err; result $? "which --strict refuses"

lamp_model
sed -i '/^newmtl floor/a d .4' lamp.mtl
run info --scene lamp.obj
grep -q '^  transparent  *2 triangles through which light goes$' out && run info --scene --json lamp.obj &&
    grep -q '"transparent_triangles": 2' out
result $? "what lets light through is told"
finish
