#!/bin/sh
# results.csv: a pipe is not waited for, what is not an experiment's own is kept, and what it says deletes nothing
# elsewhere.
. "$(dirname "$0")/lib.sh"
cat >one.json <<'SPEC'
{ "scene": { "name": "one", "inputs": ["builtin:single"] }, "cameras": [ { "name": "own", "view": "own" } ],
  "size": "16x9", "reference": { "rays": 1, "frames": 1 }, "frames": 1, "repetitions": 1, "shown": [],
  "configurations": [ { "name": "a" } ] }
SPEC

mkdir pipe && mkfifo pipe/results.csv pipe/.report.md.new
expect "a pipe in the table's place" 1 '^nocturne: pipe/results.csv: is not a regular file$' experiment one.json \
    -o pipe --cache cache
rm pipe/results.csv
run experiment one.json -o pipe --cache cache
test $status = 0 && test -s pipe/report.md; result $? "one in the place of a half-written report is not waited for"

# Text without the end of a line, and the same behind a link.
mkdir other link
printf 'my own notes' >other/results.csv
run experiment one.json -o other --cache cache
test $status = 0 && grep -q 'it is kept as results.old.csv' err && test "$(cat other/results.old.csv)" = 'my own notes'
result $? "one line without an end is kept"
printf 'more notes' >other/results.csv
run experiment one.json -o other --cache cache
test $status = 0 && grep -q 'it is kept as results.old-2.csv' err &&
    test "$(cat other/results.old.csv)" = 'my own notes' &&
    test "$(cat other/results.old-2.csv)" = 'more notes'; result $? "and the next, beside it"
cp other/results.csv before
sed 's/"name": "a"/"name": "b"/' one.json >two.json
run experiment two.json -o other --cache cache
test $status = 0 && grep -q 'other settings: kept in results.old-3.csv' err && head -n 3 other/results.old-3.csv |
    cmp -s before &&
    test "$(cat other/results.old.csv)" = 'my own notes'; result $? "and rows of other settings" "$(ls other)"
cp before other/results.csv
printf 'my own notes' >notes && ln -s ../notes link/results.csv
run experiment one.json -o link --cache cache
test $status = 0 && test "$(cat notes)" = 'my own notes' && test "$(wc -l <link/results.csv)" = 3
result $? "and what a link leads to"
mkdir cut
head -n 1 other/results.csv | head -c 50 >cut/results.csv
run experiment one.json -o cut --cache cache
test $status = 0 && test ! -s err && test ! -e cut/results.old.csv
result $? "the beginning of our own header is gone on with"

# Lines that are no rows, and rows that stand there twice, do not stay.
mkdir worn
{ cat before; sed -n 2p before; sed -n 3p before | head -c 40; echo; } >worn/results.csv
run experiment one.json -o worn --cache cache
test $status = 0 && grep -q '1 row of results.csv could not be read: kept in results.old.csv' err &&
    grep -q '1 row of results.csv stood there twice: kept in results.old.csv' err && cmp -s before worn/results.csv &&
    test "$(wc -l <worn/results.old.csv)" = 5; result $? "broken and repeated rows go, and are told" "$(cat err)"

# A row's key is the name of a picture, which goes with it.
mkdir -p evil/pictures && echo keep >victim-frame1.exr
key=$(python3 -c 'name = "victim"; print("../../" + "/" * (32 - 6 - len(name)) + name)')
head -n 1 other/results.csv >evil/results.csv
sed -n 2p other/results.csv | sed "s|[0-9a-f]*\$|$key|" >>evil/results.csv
run experiment one.json -o evil --cache cache
test $status = 0 && test "${#key}" = 32 && test -e victim-frame1.exr
result $? "a key that leads elsewhere deletes nothing"
finish
