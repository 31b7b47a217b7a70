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

# A table of a version that named no backend.
mkdir former
python3 - <<'FORMER'
import csv
rows = list(csv.reader(open("other/results.csv")))
drop = [i for i, name in enumerate(rows[0]) if name in ("backend", "device", "reference")]
assert len(drop) == 3
with open("former/results.csv", "w") as out:
    csv.writer(out, lineterminator="\n").writerows([v for i, v in enumerate(r) if i not in drop] for r in rows)
FORMER
cp former/results.csv former.csv
run experiment one.json -o former --cache cache
test $status = 0 && grep -q 'of another kind or version; it is kept as results.old.csv' err &&
    cmp -s former.csv former/results.old.csv && grep -q ', 2 of them made now' out
result $? "a table without backends is put aside, and measured again"

# told FOLDER BACKEND REFERENCE: all rows, the report and the pictures name the backend, and the reference's
told() {
    python3 - "$@" <<'TOLD'
import csv, glob, sys
folder, backend, reference = sys.argv[1:]
rows = list(csv.DictReader(open(folder + "/results.csv")))
assert rows and all((r["backend"], r["reference"]) == (backend, reference) and r["device"] for r in rows), rows
report = open(folder + "/report.md").read()
device = rows[0]["device"]
assert "rendered by %s, %s" % (backend, device.split("(")[0].strip()) in report, device
assert "The reference was rendered by " + reference in report, reference
TOLD
}
told other embree embree 2>err; result $? "rows and report name backend, device and the reference's backend"
sed 's/"shown": \[\]/"shown": [1]/' one.json >shown.json
run experiment shown.json -o both --cache cache
test $status = 0 && grep -aq embree both/pictures/*.exr; result $? "and so do pictures"
NOCTURNE_ISA=scalar run experiment one.json -o other --cache cache
test $status = 0 && grep -q ', 2 of them made now' out && grep -q 'rendered by embree, .*, NOCTURNE_ISA=scalar' \
    other/report.md; result $? "nor are rows of another instruction set" "$(cat out)"
if "$program" devices | grep '^vulkan [0-9]' | grep -qv 'not usable'; then
    cp both/results.csv both.csv
    run experiment shown.json -o both --cache cache --backend vulkan
    test $status = 0 && grep -q '2 rows of results.csv came from other settings' err &&
        grep -q ', 2 of them made' out && head -n 3 both/results.old.csv | cmp -s - both.csv
    result $? "no row of the processor is taken for one of a GPU" "$(cat err)"
    grep -q 'reference from cache/.*, rendered by embree' out && told both vulkan embree 2>err
    result $? "the reference is shared, and it is said who made it"
    grep -aq vulkan both/pictures/*.exr && ! grep -alq embree both/pictures/*.exr
    result $? "pictures of the other backend are gone"
    run experiment shown.json -o both --cache cache --backend vulkan
    test $status = 0 && grep -q ', 0 of them made' out; result $? "and a GPU's rows are gone on with"
    run experiment one.json -o fresh --cache fresh-cache --backend vulkan
    run experiment one.json -o fresh --cache fresh-cache
    test $status = 0 && told fresh embree vulkan 2>err; result $? "a GPU's reference serves the processor"
    head -n 1 fresh-cache/*.noise >numbers && for f in fresh-cache/*.noise; do cp numbers "$f"; done
    run experiment one.json -o fresh2 --cache fresh-cache
    test $status = 0 && told fresh2 embree embree 2>err; result $? "a reference without a device is embree's"
else
    skip "backends in rows" "no Vulkan device traces rays here"
fi
finish
