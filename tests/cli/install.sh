#!/bin/sh
# What is installed works by itself: the program finds its library and the helper that reads maps and OBJ, none of them
# in the build folder.
. "$(dirname "$0")/lib.sh"
here=$source_dir/tests/cli
unset NOCTURNE_READER
if ! DESTDIR="$work/stage" meson install -C "$NOC_BUILD" --no-rebuild --quiet >out 2>err; then
    result 1 "it installs into DESTDIR"
    finish
fi
result 0 "it installs into DESTDIR"
program=$(find "$work/stage" -type f -name nocturne -perm -u+x)
library=$(dirname "$(find "$work/stage" -name 'libnocturne.so*' -type f)")
helper=$(find "$work/stage" -type f -name nocturne-reader -perm -u+x)
test -n "$program" && test "$helper" = "$library/nocturne/nocturne-reader"
result $? "the helper lies in the library's folder" "$helper"
export LD_LIBRARY_PATH="$library" # the staged one: the installed program has the final place in it
lamp_model
LD_DEBUG=libs LD_DEBUG_OUTPUT="$work/libraries" "$program" info lamp.obj >out 2>err
test $? = 0 && grep -q 'triangles *4' out; result $? "it reads an OBJ by the installed helper"
test "$(cat libraries.* | grep -c 'initialize program: .*nocturne-reader')" = 1; result $? "which ran"
! cat libraries.* | grep -E 'trying file=|calling init:' | grep -qF "$NOC_BUILD/"
result $? "nothing of the build folder was looked for"
if "$program" --version | grep -q gdal; then
    python3 "$here/geopackage.py" map.gpkg plain
    run info map.gpkg
    test $status = 0 && grep -q GeoPackage out; result $? "a GeoPackage"
else
    skip "a GeoPackage" "no GDAL"
fi
mv "$helper" "$helper.away"
expect "without it an error says where it is looked for" 1 \
    "nocturne-reader, which is not in $library or $library/nocturne" info lamp.obj
run info --no-isolate lamp.obj
test $status = 0; result $? "and reading in the same process works"
finish
