#!/bin/sh
# No output replaces a file that an input names, nor any other that is read.
. "$(dirname "$0")/lib.sh"

# kept NAME FILE SAYS ARGUMENT...: the command is refused, saying what matches, and the file is as it was
kept() {
    name=$1 of=$2 says=$3
    shift 3
    before=$(cksum <"$of")
    run "$@"
    why=
    [ "$status" = 1 ] || why="status $status"
    grep -Eq -- "$says" err || why="$why; stderr does not say: $says"
    [ "$(cksum <"$of")" = "$before" ] || why="$why; $of is another one"
    [ -z "$why" ]; result $? "$name" "$why"
}
# named NAME FILE BY: a command that writes a table refuses to replace it
named() { kept "$1" "$2" "$2 would overwrite $2, which .*$3" influence $4 -q --region point:0,0 --csv "$2"; }
small='--size 16x9 --frames 1 -q'
lamp_model
printf 'map_Kd wall.png\nmap_Bump maps\\bump.exr\n' >>lamp.mtl
mkdir maps pictures
for file in wall.png maps/bump.exr; do echo "not $file" >$file; done
ln -s ../wall.png pictures/link.png
ln wall.png pictures/hard.png

# ---- OBJ ----
would='would overwrite wall.png, which lamp.obj names'
kept "a texture of an OBJ" wall.png "wall.png $would" render lamp.obj $small -o wall.png
kept "by a path of its own" wall.png "pictures/../wall.png $would" render lamp.obj $small -o pictures/../wall.png
kept "by a symbolic link" wall.png "pictures/link.png $would" render lamp.obj $small -o pictures/link.png
kept "by a hard link" wall.png "pictures/hard.png $would" render lamp.obj $small -o pictures/hard.png
kept "that is not read" wall.png "$would" render lamp.obj --no-textures $small -o wall.png
kept "a texture of a kind that is not read" maps/bump.exr 'maps/bump.exr, which lamp.obj names' \
    render lamp.obj $small -o maps/bump.exr
kept "read in the process itself" wall.png "$would" render lamp.obj --no-isolate $small -o wall.png
named "a material library" lamp.mtl 'lamp.obj names' lamp.obj
kept "the texture of a body" wall.png "$would" render builtin:city --lamp-body lamp.obj $small -o wall.png
kept "no frame is rendered before" wall.png "$would" render lamp.obj --size 16x9 --frames 1000000000 -o wall.png
ln wall.png frame-0003.png
kept "a picture of an animation" wall.png "frame-0003.png $would" \
    render lamp.obj --animate $small --frames 4 --samples 1 --overwrite -o frame-%04d.png
test ! -e frame-0001.png; result $? "and no picture before it"
cp lamp.obj other.obj
ln wall.png city.noct
kept "a built city" wall.png "city.noct $would" build lamp.obj -o city.noct
rm city.noct
ln wall.png table.csv
kept "a table of lights" wall.png "table.csv $would" influence lamp.obj -q --region point:0,0 --csv table.csv
echo '0,0,1' >points.csv
kept "measured points" wall.png "table.csv $would" measure lamp.obj -q --points points.csv -o table.csv
ln wall.png lux.tif
kept "a raster" wall.png "lux.tif $would" measure lamp.obj -q --grid 5 -o lux.tif
kept "a benchmark" wall.png "table.csv $would" bench lamp.obj -q --only floor -o table.csv
mkdir lab
ln wall.png lab/report.md
echo '{"scene": {"name": "a", "inputs": ["lamp.obj"]}, "cameras": [{"name": "b", "view": "street"}], "frames": 1,
"configurations": [{"name": "c"}], "size": "16x9", "reference": {"frames": 1}}' >spec.json
kept "an experiment" wall.png 'lab/report.md would be overwritten.*wall.png, named by .*lamp.obj' \
    experiment spec.json -o lab --cache cache
run render lamp.obj $small -o fresh.png
test $status = 0 && run render lamp.obj $small -o fresh.png && test $status = 0
result $? "what no input names is replaced"

# ---- other formats ----
cat >city.gml <<'GML'
<CityModel xmlns="http://www.opengis.net/citygml/2.0" xmlns:gml="http://www.opengis.net/gml"
 xmlns:app="http://www.opengis.net/citygml/appearance/2.0" xmlns:bldg="http://www.opengis.net/citygml/building/2.0">
<app:appearanceMember><app:Appearance><app:surfaceDataMember><app:ParameterizedTexture>
<app:imageURI> wall.png
</app:imageURI><app:target uri="#p"><app:TexCoordList><app:textureCoordinates ring="#r">0 0 1 0 1 1 0 1 0 0
</app:textureCoordinates></app:TexCoordList></app:target></app:ParameterizedTexture></app:surfaceDataMember>
</app:Appearance></app:appearanceMember>
<cityObjectMember><bldg:Building><bldg:lod1MultiSurface><gml:MultiSurface><gml:surfaceMember>
<gml:Polygon gml:id="p"><gml:exterior><gml:LinearRing gml:id="r"><gml:posList>0 0 0 9 0 0 9 9 3 0 9 3 0 0 0
</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
</gml:surfaceMember></gml:MultiSurface></bldg:lod1MultiSurface></bldg:Building></cityObjectMember></CityModel>
GML
cat >city.json <<'JSON'
{"type": "CityJSON", "version": "1.1", "transform": {"scale": [1, 1, 1], "translate": [0, 0, 0]},
"appearance": {"textures": [{"type": "PNG", "image": "wall.png"}], "vertices-texture": [[0, 0], [1, 0], [1, 1]]},
"vertices": [[0, 0, 0], [9, 0, 0], [9, 9, 3]], "CityObjects": {"b": {"type": "Building", "geometry": [
{"type": "MultiSurface", "lod": "1", "boundaries": [[[0, 1, 2]]]}]}}}
JSON
cat >city.gltf <<'JSON'
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "images": [{"uri": "wall.png"}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "the%20numbers.bin", "byteLength": 36}]}
JSON
python3 - <<'PY'
import struct
open('the numbers.bin', 'wb').write(struct.pack('<9f', 0, 0, 0, 9, 0, 0, 9, 0, 9))
head = lambda words: struct.pack('>i5ii', 9994, 0, 0, 0, 0, 0, words) + struct.pack('<2i8d', 1000, 1, *[0] * 8)
open('lamps.shp', 'wb').write(head(64) + struct.pack('>2i', 1, 10) + struct.pack('<i2d', 1, 4, 4))
open('lamps.shx', 'wb').write(head(54) + struct.pack('>2i', 50, 10))
field = b'height'.ljust(11, b'\0') + b'N' + bytes(4) + bytes([4, 0]) + bytes(14)
open('lamps.dbf', 'wb').write(struct.pack('<4BIHH20x', 3, 99, 1, 1, 1, 65, 5) + field + b'\r' + b'    6')
PY
for file in city.gml city.json city.gltf; do
    kept "an image of $file" wall.png "wall.png, which $file names" render $file $small -o wall.png
    kept "which is not read" wall.png "wall.png, which $file names" render $file --no-textures $small -o wall.png
done
named "a buffer" 'the numbers.bin' 'city.gltf names' city.gltf
# where maps can be read
if "$program" info --lamps lamps.shp >out 2>err; then
    named "a part of a Shapefile" lamps.dbf 'lamps.shp names' 'lamp.obj --lamps lamps.shp'
else
    skip "a part of a Shapefile" "no maps are read here"
fi

# ---- files of options and recipes ----
printf 'IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n1000 800 0\n' >lamp.ies
printf 'lamp.obj\n' >list
printf 'nocturne: 1\ninputs: [lamp.obj]\nluminaires:\n  - { profile: lamp.ies }\n' >city.yaml
echo 'POLYGON ((0 0, 9 0, 9 9, 0 0))' >place.wkt
kept "points that are measured" points.csv 'points.csv has the points of --points' \
    measure lamp.obj -q --points points.csv -o points.csv
named "a list of inputs" list 'the city is made of' @list
named "a profile of a recipe" lamp.ies 'city.yaml.* names' city.yaml
table='influence -q --region point:0,0'
kept "a recipe" city.yaml 'city.yaml is an input too' $table city.yaml --csv city.yaml
kept "a profile of all lamps" lamp.ies 'lamp.ies is an input too' \
    $table lamp.obj --lamp-profile lamp.ies --csv lamp.ies
kept "a polygon that is asked for" place.wkt 'polygon:place.wkt' \
    influence lamp.obj -q --region polygon:place.wkt --csv place.wkt
test -z "$(ls -A . pictures maps | grep part$)"; result $? "no temporary file is left"
finish
