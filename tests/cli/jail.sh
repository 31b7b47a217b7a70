#!/bin/sh
# What a file's author may not do: reach a network, open files elsewhere, make the program wait, have it write.
. "$(dirname "$0")/lib.sh"
here=$source_dir/tests/cli

# Whatever waits for a pipe is ended, and its status is 124.
real=$program
program=$work/patient
printf '#!/bin/sh\nexec timeout -s KILL 300 "%s" "$@"\n' "$real" >"$program"
chmod +x "$program"

mkdir -p in/sub out_there
cp "$here/city.gml" in/city.gml
printf 'newmtl glow\nKd 0.5 0.5 0.5\nKe 1000 1000 1000\n' >out_there/secret.mtl
cp out_there/secret.mtl in/sub/fine.mtl
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077\0\0\0\0' >out_there/triangle.bin
cp out_there/triangle.bin in/sub/triangle.bin
mkfifo in/pipe

# obj NAME: in/model.obj with materials of that name
obj() { printf 'mtllib %s\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl glow\nf 1 2 3\n' "$1" >in/model.obj; }
# gltf URI: in/model.gltf with its buffer there
gltf() {
    cat >in/model.gltf <<END
{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"byteLength": 36, "uri": "$1"}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
 "max": [1, 1, 0]}]}
END
}
# lamps CRS: in/lamps.geojson with that "crs" member
lamps() {
    printf '{"type": "FeatureCollection", "crs": %s, "features": [{"type": "Feature",
        "properties": {"highway": "street_lamp"},
"geometry": {"type": "Point", "coordinates": [11.42, 48.76]}}]}' "$1" >in/lamps.geojson
}
# fine NAME ARGUMENT...: goes well
fine() {
    name=$1
    shift
    run "$@"
    test $status = 0; result $? "$name" "status $status"
}
lights() { sed -n 's/^ *lights *\([0-9]*\).*/\1/p' out; }

# ---- no network ----
python3 "$here/listen.py" >heard &
listener=$!
trap 'kill $listener; rm -rf "$work"' EXIT
until [ -s heard ]; do sleep 0.05; done
url=http://127.0.0.1:$(head -n 1 heard)/x
lamps "{\"type\": \"link\", \"properties\": {\"href\": \"$url\", \"type\": \"proj4\"}}"
expect "a CRS that is a link is not followed, and that is said" 0 'link .*not followed' info in/lamps.geojson
grep -q 'lamps *1$' out; result $? "and the lamp is read"
for crs in "$url" "/vsicurl/$url" "@$work/in/pipe" "$work/in/pipe"; do
    lamps "{\"type\": \"name\", \"properties\": {\"name\": \"$crs\"}}"
    run info in/lamps.geojson
    [ $status -lt 2 ] || echo "$crs: $status" >>slow
done
test ! -e slow; result $? "nor is one that names an address or a file" "$(cat slow 2>&1)"
obj "$url"
expect "materials on a network are not fetched" 0 'No such file' info in/model.obj
gltf "$url"
expect "nor are buffers" 1 'network' info in/model.gltf
for entity in "$url" "file://$work/in/pipe"; do
    { printf '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY e SYSTEM "%s">]>' "$entity"; tail \
        -n +2 in/city.gml; } >in/entity.gml
    expect "nor entities of XML ($(echo "$entity" | cut -c 1-4))" 1 'entit' info in/entity.gml
    { printf '<?xml version="1.0"?><!DOCTYPE osm [<!ENTITY e SYSTEM "%s">]>' "$entity"
      echo '<osm version="0.6"><node id="1" lat="48.7" lon="11.4" version="1"><tag k="highway" v="street_lamp"/>'
      echo '<tag k="name" v="&e;"/></node></osm>'; } >in/entity.osm
    run info in/entity.osm
    test $status -lt 2; result $? "nor those of OpenStreetMap ($(echo "$entity" | cut -c 1-4))" "status $status"
done
sleep 0.2
test "$(wc -l <heard)" = 1; result $? "nothing was heard on the network" "$(cat heard)"

# ---- other files ----
obj sub/fine.mtl
run info in/model.obj
test $status = 0 && ! grep -q default err && test "$(lights)" = 1; result $? "materials below the folder are read"
for name in ../out_there/secret.mtl sub/../../out_there/secret.mtl \
    "$work/out_there/secret.mtl" link.mtl linked/secret.mtl; do
    ln -sfn ../out_there/secret.mtl in/link.mtl
    ln -sfn ../out_there in/linked
    obj "$name"
    expect "materials elsewhere are not: $(basename "$(dirname "$name")")/$(basename "$name")" 0 \
        'lies outside.*--allow-outside' info in/model.obj
    run info --allow-outside in/model.obj
    test $status = 0 && test "$(lights)" = 1; result $? "unless that is allowed"
done
obj sub/fine.mtl
sed -i 's/usemtl glow/usemtl other/' in/model.obj
expect "--strict refuses a material that no library defines" 1 \
    'guessed at: 1; .*material that is not there.*other' info --strict in/model.obj
obj none.mtl
expect "materials that are not there are told of" 0 'default material, because .*none.mtl' info in/model.obj
expect "and an error with --strict" 1 'library of materials that cannot be read' info --strict in/model.obj
gltf sub/triangle.bin
fine "buffers below the folder are read" info in/model.gltf
gltf ../out_there/triangle.bin
expect "buffers elsewhere are not" 1 'lies outside.*--allow-outside' info in/model.gltf
fine "unless that is allowed" info --allow-outside in/model.gltf
gltf '%2e%2e/out_there/triangle.bin'
expect "nor those whose way is written in percents" 1 'lies outside' info in/model.gltf
(cd in && "$program" info model.gltf 2>&1 | grep -q 'lies outside')
result $? \
    "also where the input is in the working folder"

# ---- pipes ----
expect "a pipe as input is refused" 1 'not a regular file' info in/pipe
expect "a pipe as command, too" 2 'is no command' in/pipe
expect "a pipe as spec of experiments" 1 'not a regular file' experiment in/pipe -o results
obj pipe
expect "a pipe as materials" 0 'not a regular file' info in/model.obj
gltf pipe
expect "a pipe as buffer" 1 'not a regular file' info in/model.gltf
fine "a pipe as a grid that the user types is left" info \
    --crs "+proj=longlat +ellps=GRS80 +nadgrids=$work/in/pipe +type=crs" in/city.gml
python3 - <<'END'
import struct
points = [(11.42, 48.76), (11.4201, 48.76)]
box = struct.pack("<4d", 11.42, 48.76, 11.4201, 48.76) + bytes(32)
def head(words): return struct.pack(">7i", 9994, 0, 0, 0, 0, 0, words) + struct.pack("<2i", 1000, 1) + box
record = lambda i, p: struct.pack(">2i", i, 10) + struct.pack("<i2d", 1, *p)
open("in/poles.shp", "wb").write(head(50 + 14 * len(points)) + b"".join(record(i + 1, p) for i, p in enumerate(points)))
open("in/poles.shx", "wb").write(head(50 + 4 * len(points)) +
                                 b"".join(struct.pack(">2i", 50 + 14 * i, 10) for i in range(len(points))))
field = b"highway\0\0\0\0C" + bytes(4) + bytes([20, 0]) + bytes(14)
open("in/poles.dbf", "wb").write(struct.pack("<B3BIHH20x", 3, 126, 1, 1, 2, 32 + 32 + 1, 21) + field + b"\r" +
                                 b" street_lamp         " * 2 + b"\x1a")
open("in/poles.prj", "w").write('GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137,298.257223563]],'
                                'PRIMEM["Greenwich",0],UNIT["Degree",0.0174532925199433]]')
END
if "$real" --version | grep -q gdal; then
    fine "a Shapefile is read" info in/poles.shp
    grep -q 'lamps *2$' out; result $? "with its lamps"
    for part in dbf shx prj cpg qix; do
        mkdir -p pipes && rm -f pipes/* && cp in/poles.* pipes && rm -f pipes/poles.$part && mkfifo pipes/poles.$part
        expect "a pipe as .$part of a Shapefile" 1 "poles.$part .*not a regular file" info pipes/poles.shp
    done
    rm -f pipes/* && cp in/poles.shp in/poles.shx in/poles.prj pipes && ln -s ../in/poles.dbf pipes/poles.DBF
    expect "a table of a Shapefile that lies elsewhere" 1 \
        'poles.DBF .*lies outside.*--allow-outside' info pipes/poles.shp
    fine "unless that is allowed" info --allow-outside pipes/poles.shp

    # ---- it can be stopped ----
    # interrupt SIGNAL ARGUMENT...: a signal after a second of work
    interrupt() {
        signal=$1
        shift
        env --default-signal=INT "$real" "$@" >out 2>err </dev/null &
        pid=$!
        sleep 1
        kill -0 $pid && kill -"$signal" $pid
        tries=0
        while kill -0 $pid 2>/dev/null && test $tries -lt 3000; do sleep 0.1; tries=$((tries + 1)); done
        kill -KILL $pid 2>/dev/null
        wait $pid
        status=$?
    }
    mkdir temporary
    export TMPDIR=$work/temporary
    python3 "$here/geopackage.py" in/endless.gpkg view
    interrupt INT info in/endless.gpkg
    test $status = 130; result $? "one Ctrl-C ends a query that never does" "status $status"
    interrupt TERM render in/endless.gpkg -o endless.png
    test $status = 143 && test ! -e endless.png; result $? "and SIGTERM" "status $status"
    interrupt INT info --no-isolate in/endless.gpkg
    test $status = 130; result $? "and Ctrl-C where it is read in the same process" "status $status"
    expect "it is ended after the time that it may take" 1 'limit --reader-time' info --reader-time 0.5 in/endless.gpkg
    test -z "$(ls temporary)"; result $? "nothing is left behind" "$(ls temporary)"
    # Who started it cannot look at the clock: its own limit of processor time ends it, two seconds after the other. How
    # long that takes is the machine's business: what counts is the time that it has used, and five times the limit is
    # too much.
    # One that has ended is Z, whether or not this shell has been told.
    state() { sed -n 's/^State:\t\(.\).*/\1/p' "/proc/$1/status" 2>/dev/null | grep . || echo Z; }
    for seconds in 4 8 16 32 64; do # on a busy machine more time goes by before it can be stopped
        "$real" info --reader-time $seconds in/endless.gpkg >out 2>err </dev/null &
        pid=$! keeper='' child=
        until grep -q "^Max cpu time *$((seconds + 2)) " "/proc/$child/limits" 2>/dev/null ||
            [ "$(state $pid)" = Z ]; do
            keeper=$(cat /proc/$pid/task/$pid/children 2>/dev/null)
            keeper=${keeper% }
            # it has its limit once it has all that it was asked
            child=$(cat "/proc/$keeper/task/$keeper/children" 2>/dev/null)
            child=${child% }
        done
        kill -STOP $pid
        until [ "$(state $pid)" = T ] || [ "$(state $pid)" = Z ]; do sleep 0.05; done
        before=$(state "$child")
        test "$before" = Z || break # it lives, and nobody will end it
        kill -CONT $pid
        wait $pid
    done
    if "$real" --version | grep -q 'system calls by seccomp'; then
        grep -q '^Seccomp:.*2$' "/proc/$child/status"; result $? "it may not make all system calls"
    else
        skip "it may not make all system calls" "no seccomp here"
    fi
    test -z "$(sed -n 's/^Cap[PE].*:\t//p' "/proc/$child/status" | tr -d '04\n')"
    result $? "nor has it root's rights, but for reading" "$(grep Cap "/proc/$child/status")"
    grep -q '^Max processes *0 ' "/proc/$child/limits"; result $? "nor may it start others"
    used=0 ticks=$(getconf CLK_TCK) after=$before
    while [ "$after" != Z ] && [ "${used:-0}" -lt $((5 * (seconds + 2) * ticks)) ]; do
        sleep 0.2
        used=$(awk '{ print $14 + $15 }' "/proc/$child/stat" 2>/dev/null)
        after=$(state "$child")
    done
    test "$before" != Z && test "$after" = Z
    result $? "it ends by itself where nobody ends it" \
        "helper ${child:-never seen}: $before, $after after ${used:-0} ticks"
    until [ "$(state "$keeper")" = Z ]; do sleep 0.05; done
    test "$(kill -l "$(awk '{ print $NF }' "/proc/$keeper/stat")")" = XCPU
    result $? "by the signal that tells why, as does who keeps it"
    kill -CONT $pid
    wait $pid
    test $? = 1 && grep -q 'limit --reader-time' err; result $? "and the error says so"
    python3 - <<'END'
with open("in/large.obj", "w") as f:
    f.writelines("v %d %d 0\n" % (i % 1000, i // 1000) for i in range(1000000))
    f.writelines("f %d %d %d\n" % (i + 1, i + 2, i + 1001) for i in range(990000))
END
    python3 - <<'END'
with open("in/large.geojson", "w") as f:
    f.write('{"type": "Feature", "properties": {}, "geometry": {"type": "MultiPoint", "coordinates": [[0,0]')
    f.write(",[0,0]" * 3000000)
    f.write("]}}")
END
    python3 - <<'END'
import gzip
with open("in/rows.csv.gz", "wb") as f:
    f.write(gzip.compress(b"longitude,latitude,lamp_type\n"))
    f.write(gzip.compress(b"7.1,51.1,LED\n" * 700000) * 150)
END
    expect "an archive that grows to a gigabyte and more is an error" 1 \
        'limit --max-expansion is 200 times' info in/rows.csv.gz
    rm in/rows.csv.gz
    # Sanitizers take more addresses than any limit by themselves, and the helper has none there.
    limited() {
        if (ulimit -v 4000000 && "$program" --version) >/dev/null 2>&1; then
            expect "$1" 1 'limit --max-memory' info --max-memory "$2" "$3"
        else
            skip "$1" "more addresses are taken from the start, as by sanitizers"
        fi
    }
    limited "faces that take more memory than they may are an error" 0.1 in/large.obj
    limited "it is ended where it takes more memory than it may" 0.1 in/large.geojson
    rm in/large.obj in/large.geojson
    for what in NOCTURNE_READER=/nonexistent NOCTURNE_READER=/bin/false; do
        (export "$what"; run info in/poles.shp; echo $status >ended)
        test "$(cat ended)" = 1 && test -s err; result $? "the wrong helper is an error ($what)" "$(cat err)"
    done
    printf '#!/bin/sh\nkill -XCPU $$\n' >spent && chmod +x spent
    (export NOCTURNE_READER="$work/spent"; run info in/poles.shp; echo $status >ended)
    test "$(cat ended)" = 1 && grep -q 'limit --reader-time' err
    result $? "and its signal is told as that limit" "$(cat err)"
    printf '#!/bin/sh\ndd bs=65536 count=1 <&3 >/dev/null 2>&1\nexec 3<&-\nexec sleep 1000\n' >mute && chmod +x mute
    (export NOCTURNE_READER="$work/mute"; timeout 300 "$program" info in/poles.shp >out 2>err; echo $? >ended)
    test "$(cat ended)" = 1 && grep -q 'hung up' err
    result $? "a helper that hangs up and stays is ended" "status $(cat ended): $(cat err)"
    printf '#!/bin/sh\nenv >seen\n' >looks && chmod +x looks
    (export NOCTURNE_READER="$work/looks" SOME_TOKEN=secret GDAL_HTTP_USERPWD=secret TZ=UTC LC_TIME=C
     run info in/poles.shp)
    grep -q '^TMPDIR=.*nocturne-scratch' seen && grep -q '^TZ=UTC' seen && grep -q '^LC_TIME=C' seen
    result $? "its environment has what reading needs" "$(cat seen)"
    ! grep -q 'secret\|^HOME' seen; result $? "and nothing else" "$(cat seen)"
    # says NAME STATUS RECORDS PATTERN ARGUMENT...: a helper that was taken over sends RECORDS; one error comes of it,
    # or none
    says() {
        name=$1 expected=$2 pattern=$4
        echo "$3" >says
        shift 4
        (export NOCTURNE_READER="$here/helper.py"; run info "$@" in/poles.shp; echo $status >ended)
        test "$(cat ended)" = "$expected" && grep -Eq -- "$pattern" err && test "$(grep -vc 'warning:' err)" = $expected
        result $? "$name" "status $(cat ended)"
    }
    says "a helper that ends well and stays is ended" 0 'log(1, "its last word") + end(0)' 'last word'
    says "an error that it gives no reason for" 1 'end(3)' 'makes no sense'
    says "a reason, and no error" 1 'log(0, "reason") + end(0)' 'makes no sense'
    says "reasons beyond number" 1 'log(0, "reason") * 9 + end(3)' 'makes no sense'
    says "a lamp that is none" 1 'record(LAMP, bytes(8))' "makes no sense"
    fine "in the same process none is needed" info --no-isolate in/poles.shp
    for crs in "+init=$work/in/pipe:x" "+proj=longlat +nadgrids=$work/in/pipe"; do
        lamps "{\"type\": \"name\", \"properties\": {\"name\": \"$crs\"}}"
        for where in isolate no-isolate; do
            expect "a pipe that GDAL would open, $where: ${crs%=*}" 1 'lamps.geojson: the CRS .* may open files' info \
                --$where in/lamps.geojson
        done
    done

    # ---- nothing is written ----
    mkdir packages
    for kind in plain log; do python3 "$here/geopackage.py" packages/$kind.gpkg $kind; done
    state() { ls -l --time-style=full-iso packages; cksum packages/*; }
    state >before
    run info packages/plain.gpkg
    test $status = 0 && grep -q 'lamps *2$' out; result $? "a GeoPackage is read"
    run info packages/log.gpkg
    test $status = 0 && grep -q 'lamps *3$' out; result $? "with what is in its write-ahead log"
    state >after
    cmp -s before after; result $? "and is as it was: bytes, times and folder" "$(diff before after)"
    test -z "$(ls temporary)"; result $? "no copy of it is left behind" "$(ls temporary)"
    # What a killed run left goes with the next one; what lives, or is not ours, stays.
    mkdir temporary/nocturne-scratch.kiLLed temporary/nocturne-scratch.living temporary/nocturne-backup &&
        : >temporary/nocturne-scratch.kiLLed/copy
    if command -v flock >/dev/null; then
        flock temporary/nocturne-scratch.living "$program" info packages/plain.gpkg >out 2>err
        test $? = 0 && test "$(ls temporary | tr '\n' ' ')" = "nocturne-backup nocturne-scratch.living "
        result $? "temporary folders of killed runs are swept" "$(ls temporary)"
    else
        skip "temporary folders of killed runs are swept" "no flock here"
    fi
    rm -r temporary/*
    rm packages/log.gpkg-wal && mkfifo packages/log.gpkg-wal
    expect "a pipe as log of a GeoPackage" 1 'log.gpkg-wal .*not a regular file' info packages/log.gpkg
    for kind in text comment name; do
        python3 "$here/geopackage.py" in/$kind.gpkg $kind
        expect "a virtual table over another file is not read ($kind)" 1 \
            '(VirtualText|unclear).* may open other files' info in/$kind.gpkg
    done
    (export OGR_SQLITE_LOAD_EXTENSIONS=./nothing.so; run info --no-isolate packages/plain.gpkg; echo $status >ended)
    test "$(cat ended)" = 0 && grep -q 'lamps *2$' out
    result $? "libraries for SQLite that the environment names are not loaded" "$(cat err)"
else
    for what in "a Shapefile is read" "a GeoPackage is read"; do skip "$what" "built without GDAL"; done
fi
finish
