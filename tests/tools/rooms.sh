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
int f(void) { return load_it(3) + own(2); } /* not_asked(1) */
int own(int x) { return x; }
C
cat >"$work/tree/src/backend/cpu/reuse.c" <<'C'
int x;
int load_it(int i) {
    return i; /* core asks for it */
}
static int not_asked(int i) { return i; }
static int own(int x) { return x; }
C
printf 'int x;\n' >"$work/tree/src/backend/cpu/lanes_tmpl.h"
printf 'int x;\n' >"$work/tree/tests/test.c"
printf 'int x;\n' >"$work/tree/src/core/meson.build"
python3 "$source_dir/tools/rooms.py" "$work/tree" >"$work/out" 2>&1
figure src/core/ 6
figure src/backend/cpu/ 7
figure ' reuse.c' 6
figure ' of these, bridges' 3
figure ' lanes_tmpl.h (machine)' 1
figure all 13
figure 'algorithm and bridges' 6
figure 'bridges, that core calls by name' 3
figure 'algorithm, outside core/ and render/' 3
echo "1..$count"
exit $failed
