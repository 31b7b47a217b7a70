#!/bin/sh
# tools/rooms.py on a small tree: what is counted as a line, and what as algorithm.
set -u
source_dir=${NOC_SOURCE:?names the source folder}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
count=0 failed=0
# figure NAME LINES: the row of that name ends so
figure() {
    count=$((count + 1))
    if sed 's/  */ /g' "$work/out" | grep -qxF "$1 $2"; then
        echo "ok $count - $1 $2"
    else
        failed=1
        echo "not ok $count - $1 $2"
        sed 's/^/# /' "$work/out"
    fi
}

mkdir -p "$work/tree/src/core" "$work/tree/src/backend/cpu" "$work/tree/tests" "$work/tree/include/nocturne"
cat >"$work/tree/src/core/a.h" <<'C'
/* a comment
 * of three lines, int x;
 */
int a; /* this counts */ int b;

// and this does not: int c;
const char *text = "/* no comment";
char quote = '"'; /* a comment after a quote */
const char *more = "// nor this";
C
printf 'int x;\nint y;\n' >"$work/tree/src/backend/cpu/reuse.c"
printf 'int x;\n' >"$work/tree/src/backend/cpu/lanes_tmpl.h"
printf 'int x;\n' >"$work/tree/tests/test.c"
printf 'int x;\n' >"$work/tree/src/core/meson.build"
python3 "$source_dir/tools/rooms.py" "$work/tree" >"$work/out" 2>&1
figure src/core/ 4
figure src/backend/cpu/ 3
figure ' reuse.c' 2
figure ' lanes_tmpl.h (machine)' 1
figure all 7
figure 'algorithm, outside core/ and render/' 2
echo "1..$count"
exit $failed
