#!/bin/sh
# tools/check-format.sh: what it says of a tree that is laid out badly.
set -u
source_dir=${NOC_SOURCE:?names the source folder}
check=$source_dir/tools/check-format.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
count=0 failed=0
result() {
    count=$((count + 1))
    if [ "$1" = 0 ]; then echo "ok $count - $2"; else failed=1; echo "not ok $count - $2"; fi
}

mkdir -p "$work/tree/src" "$work/tree/tests"
cp "$source_dir/.clang-format" "$work/tree"
printf 'int good(void) { return 1; }\n' >"$work/tree/src/good.c"
printf 'int  bad( void )\n{\n  return 1; }\n' >"$work/tree/src/bad.c"
awk 'BEGIN { printf "/* "; for (i = 0; i < 114; i++) printf "\303\251"; print " */" }' >"$work/tree/src/just.h"
awk 'BEGIN { printf "# "; for (i = 0; i < 119; i++) printf "x"; print "" }' >"$work/tree/tests/long.sh"
"$check" "$work/tree" >"$work/out" 2>&1
test $? = 1; result $? "a tree that is laid out badly fails"
skip=$(sed -n 's/^ok 1 .* # SKIP/ # SKIP/p' "$work/out")
[ -n "$skip" ] || grep -qx '# src/bad.c:1: make format would change it' "$work/out"; result $? "the file is named$skip"
! grep -q 'good\|just' "$work/out"; result $? "others are not: columns are characters, not bytes"
grep -qx '# tests/long.sh:1: longer than 120 columns' "$work/out"; result $? "a long line is named"
if [ -z "$skip" ]; then
    "$check" --write "$work/tree" >"$work/out" 2>&1
    test $? = 1 && test "$(cat "$work/tree/src/bad.c")" = 'int bad(void) { return 1; }'
fi
result $? "--write lays it out$skip"
rm "$work/tree/tests/long.sh"
"$check" "$work/tree" >"$work/out" 2>&1; result $? "and then it passes$skip"
echo "1..$count"
exit $failed
