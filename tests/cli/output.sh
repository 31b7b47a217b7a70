#!/bin/sh
# What cannot be written is told before the long work, and left as it was.
. "$(dirname "$0")/lib.sh"
c=builtin:city
mkdir folder folder.png
echo text >file
printf x >input.png
ln -s /dev/full device.png
ln -s input.png link.png
mkfifo pipe.png

expect "a missing folder" 1 'its folder missing is not there: make it first' render $c -o missing/x.png
expect "a missing folder at the root" 1 'its folder /nonexistent is not there: make it first' \
    render $c -o /nonexistent/x.png
expect "a file for a folder" 1 'folder' render $c -o file/x.png
expect "a folder" 1 'is a folder' render $c -o folder
expect "a folder with the right ending" 1 'is a folder' render $c -o folder.png
expect "a folder with a slash" 1 'is a folder' render $c -o folder/
expect "no ending" 2 'must end in .png or .exr' render $c -o picture
expect "another ending" 2 'must end in .png or .exr' render $c -o picture.jpg
expect "only an ending" 2 'must end in .png or .exr' render $c -o folder/.png
expect "a device" 2 'must end in' render $c -o /dev/full
expect "a device behind a link" 1 'no ordinary file' render $c -o device.png
expect "a pipe" 1 'no ordinary file' render $c -o pipe.png
expect "an input" 1 'is an input too' render input.png -o input.png
expect "an input by another name" 1 'is an input too' render input.png -o ./folder/../input.png
expect "an input behind a link" 1 'is an input too' render input.png -o link.png
expect "compare onto an input" 1 'is an input too' compare input.png file -o input.png
test "$(cat input.png)" = x && test -p pipe.png && test -L device.png && test -d folder.png &&
    test -z "$(ls folder folder.png | grep png$)"
result $? "all is as it was"
long=$(head -c 251 /dev/zero | tr '\0' x)
small="$c --city-size 150 --size 1x500 --frames 1 -q"
expect "a name of 256 bytes" 1 'too long' render $c -o "x$long.png"
run render $small -o "$long.png"
test $status = 0 && test "$(meta "$long.png" size)" = "1 500"
result $? "one of 255 bytes can be written, and a slit has a view"
(umask 022 && : >private.png && : >shared.png && chmod 600 private.png && chmod 664 shared.png
    for mode in private shared fresh; do "$program" render $small -o $mode.png; done) >out 2>err
test "$(stat -c %a private.png shared.png fresh.png | tr '\n' ' ')" = "600 664 644 " && test -s private.png
result $? "a file keeps the mode of the one that it replaces" "$(stat -c '%n %a' private.png shared.png fresh.png)"
ln -s ring.png ring.png
expect "a ring of links" 1 'symbolic links' render $c -o ring.png
if [ -d /proc/self ]; then
    expect "a folder that takes no files" 1 '^nocturne: /proc/x.png: cannot be written' render $c -o /proc/x.png
else
    skip "a folder that takes no files" "no /proc here"
fi
ln -s later.png dangling.png
run render $small -o dangling.png
test $status = 0 && test -L dangling.png && test "$(meta later.png size)" = "1 500"
result $? "a link to what is not there yet is followed"
test -z "$(ls -A | grep part$)"; result $? "no temporary file is left"
# Sanitizers take more addresses than this by themselves.
if (ulimit -v 4000000 && "$program" --version) >out 2>err; then
    (ulimit -v 4000000; "$program" render $c --city-size 150 --size 20000x20000 -v -o big.png) >out 2>err
    test $? = 1 && grep -q 'no memory for a picture of 20000 x 20000 (8.0 GB)' err && ! grep -q 'frame 1' err
    result $? "memory for the picture is found missing before it is rendered"
else
    skip "memory for the picture is found missing before it is rendered" "the program cannot run in 4 GB of addresses"
fi
# Root may write everywhere: then somebody else tries.
mkdir locked && chmod 555 locked && chmod 755 .
other=
[ "$(id -u)" = 0 ] && other="setpriv --reuid=65534 --regid=65534 --clear-groups"
if $other test -x "$program" && $other test -r .; then
    $other "$program" render $c -o locked/x.png >out 2>err
    test $? = 1 && grep -q 'cannot be written: Permission' err; result $? "a folder without permission"
else
    skip "a folder without permission" "no unprivileged user can run the program here"
fi

# 10 s is when the first line is due; one thread, so that other tests go on.
start render builtin:single --size 16x9 --threads 1 --time 3000 -o long.png
until grep -q left err || ! kill -0 $pid 2>/dev/null; do sleep 0.1; done
kill -INT $pid
wait $pid
grep -Eq '^nocturne: [0-9]+ %, frame [0-9]+, about [0-9]+ min [0-9]+ s left$' err && ! grep -q "$(printf '\r')" err
result $? "a long render shows a sign of life in a pipe"
lamp_model
mkdir -p east west
cp lamp.obj lamp.mtl east && cp lamp.obj lamp.mtl west
run render "$PWD/east/lamp.obj" west/lamp.obj --size 16x9 --frames 1 -o twins.png
test $status = 0 && test "$(meta twins.png inputs)" = "east/lamp.obj, west/lamp.obj"
result $? "inputs of one name are told apart by their folders" "$(meta twins.png inputs)"
for folder in one two; do mkdir $folder && cp -r east $folder; done
cp east/lamp.obj lone.obj
run render one/east/lamp.obj lone.obj "$PWD/two/east/lamp.obj" lamp.obj one/east/../../west/lamp.obj lone.obj \
    --size 16x9 --frames 1 -o twins.png
test $status = 0 && test "$(meta twins.png inputs)" = \
    "one/east/lamp.obj, lone.obj, two/east/lamp.obj, lamp.obj, west/lamp.obj, lone.obj"
result $? "and by the folders of these, where they have one name" "$(meta twins.png inputs)"
cat >names.osm <<'OSM'
<osm version="0.6"><node id="1" lat="52.5" lon="13.4"/><node id="2" lat="52.5" lon="13.401"/>
<node id="3" lat="52.50003" lon="13.4002"><tag k="highway" v="street_lamp"/></node>
<way id="4"><nd ref="1"/><nd ref="2"/><tag k="highway" v="residential"/>
<tag k="name" v="=A(&quot;,&quot;)"/></way></osm>
OSM
run influence names.osm --map-surfaces -q --sky 0 --time 0.1 --region pixel:640,500 --csv names.csv
test $status = 0 && grep -qF ",\"'=A(\"\",\"\")\"," names.csv
result $? "names of files are no formulas in a CSV" "$(sed -n 2p names.csv)"
finish
