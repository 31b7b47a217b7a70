#!/bin/sh
# check-format.sh [FOLDER]: fails, and names the files, where clang-format 14 would change C or C++, or where a line is
# longer than 120 columns. TAP. The first is skipped where there is no clang-format 14: others lay out otherwise.
# check-format.sh --write: lays the tree out (`make format`). Lines it cannot break are left, and named.
set -u
write=
[ "${1:-}" = --write ] && write=yes && shift
cd "${1:-$(dirname "$0")/..}" || exit 1

formatter=
for program in clang-format-14 clang-format; do
    "$program" --version 2>/dev/null | grep -q 'version 14\.' && formatter=$program && break
done
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
# What git tracks, and what is new and not ignored; without git, what lies in the folders of sources.
sources() {
    grep -E '\.(c|h|cc|py|sh|glsl|comp|js|css|html)$' | sort -u | while read -r file; do
        [ ! -f "$file" ] || echo "$file"
    done
}
git ls-files -co --exclude-standard 2>/dev/null | sources >"$work/all"
[ -s "$work/all" ] || find bench examples fuzz include src tests tools -type f 2>/dev/null | sources >"$work/all"
grep -E '\.(c|h|cc)$' "$work/all" >"$work/code"
[ -s "$work/code" ] || { echo "check-format.sh: no sources in $(pwd)" >&2; exit 1; }

if [ -n "$write" ]; then
    [ -n "$formatter" ] || { echo "check-format.sh: clang-format 14 is not here" >&2; exit 1; }
    xargs "$formatter" -i <"$work/code" || exit 1
fi
failed=0
# told NUMBER NAME FILE: fails where the file has lines, which it prints
told() {
    if [ -s "$3" ]; then
        failed=1
        echo "not ok $1 - $2"
        sed 's/^/# /' "$3"
    else
        echo "ok $1 - $2"
    fi
}
echo 1..2
if [ -n "$formatter" ]; then
    xargs "$formatter" --dry-run <"$work/code" 2>&1 | sed -n 's/: \(warning\|error\): .*//p' >"$work/places"
    awk -F: '!seen[$1]++ { print $1 ":" $2 ": make format would change it" }' "$work/places" >"$work/changed"
    told 1 "clang-format 14 would change no file" "$work/changed"
else
    echo "ok 1 - clang-format 14 would change no file # SKIP no clang-format 14 here"
fi
LC_ALL=C.UTF-8 xargs grep -HnE '.{121}' <"$work/all" | cut -d: -f 1,2 |
    sed 's/$/: longer than 120 columns/' >"$work/long"
told 2 "no line is longer than 120 columns" "$work/long"
exit $failed
