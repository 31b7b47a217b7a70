#!/bin/sh
# examples/minimal.c draws a picture.
. "$(dirname "$0")/lib.sh"
"$NOC_EXAMPLE" small.png >out 2>err
test $? = 0 && test ! -s err && meta small.png size >/dev/null; result $? "examples/minimal.c draws a city"
run compare small.png small.png
grep -q '320 x 180' out && awk '/mean luminance/ { found = $3 > 0 } END { exit !found }' out
result $? "which is not black"
"$NOC_EXAMPLE" missing/small.png >out 2>err
test $? = 1 && test "$(wc -l <err)" = 1; result $? "and tells of an error once"
export PKG_CONFIG_PATH="${NOC_BUILD:-}/meson-uninstalled"
if pkg-config --exists nocturne 2>/dev/null; then
    ${CC:-cc} -Werror "$source_dir/examples/minimal.c" -fsyntax-only $(pkg-config --cflags nocturne) >out 2>err
    result $? "and compiles with the flags that pkg-config has from a build"
else
    skip "and compiles with the flags that pkg-config has from a build" "no pkg-config"
fi
finish
