#!/bin/sh
# tools/fuzz.sh: its table is that of fuzz/meson.build, and of ten turns each corpus has one.
set -u
source_dir=${NOC_SOURCE:?names the source folder}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
count=0 failed=0
# same FILE FILE NAME
same() {
    count=$((count + 1))
    if test -s "$1" && cmp -s "$1" "$2"; then
        echo "ok $count - $3"
    else
        failed=1
        echo "not ok $count - $3"
        diff "$1" "$2" | sed 's/^/# /'
    fi
}

sed -n "/^corpora='/,/^'/p" "$source_dir/tools/fuzz.sh" | awk 'NF > 2 { print $1, $2 }' | sort >"$work/table"
sed -n '/^ *foreach corpus, program/,/}/p' "$source_dir/fuzz/meson.build" | grep -o "'[a-z]*': '[a-z]*'" |
    tr -d "':" | sort >"$work/meson"
same "$work/table" "$work/meson" "fuzz.sh and meson.build have the same corpora and programs"

cut -d ' ' -f 1 "$work/table" >"$work/corpora"
for i in 0 1 2 3 4 5 6 7 8 9; do
    sh "$source_dir/tools/fuzz.sh" "$work" turn 179000000$i | tr ' ' '\n' | grep .
done | sort >"$work/turns"
same "$work/corpora" "$work/turns" "ten turns are all corpora, once"
echo "1..$count"
exit $failed
