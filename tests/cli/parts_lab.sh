#!/bin/sh
# Processes that share a spec of the laboratory: together they have the rows, pictures and report of one.
. "$(dirname "$0")/lib.sh"
unset OMPI_COMM_WORLD_RANK OMPI_COMM_WORLD_SIZE PMI_RANK PMI_SIZE JOB_COMPLETION_INDEX NOCTURNE_PARTS
for name in $(env | sed -n 's/^\(SLURM_[A-Z_]*\)=.*/\1/p'); do unset "$name"; done
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
spec() { # FRAMES RAYS SIZE
    cat <<SPEC
{
  "scene": { "name": "city", "inputs": ["builtin:city"], "city-size": 150 },
  "cameras": [ { "name": "street", "view": "street" }, { "name": "up", "eye": [0, -60, 90], "target": [0, 0, 0] } ],
  "size": "$3", "frames": $1, "repetitions": 3, "reference": { "rays": $2, "frames": 2 },
  "configurations": [ { "name": "is", "method": "is" }, { "name": "ris", "method": "ris" } ]
}
SPEC
}
spec 3 8 48x32 >spec.json
rows=72 # of two cameras, three repetitions, two configurations, three frames, two modes
# plain FOLDER: the table in its order, without times and memory; fails where a line has not as many fields as the first
plain() {
    python3 -c '
import csv, sys
table = list(csv.reader(open(sys.argv[1] + "/results.csv")))
assert all(len(row) == len(table[0]) for row in table)
drop = [i for i, name in enumerate(table[0]) if name.endswith("_s") or name in ("memory_bytes", "scene_bytes")]
for row in table:
    print([v for i, v in enumerate(row) if i not in drop])' "$1"
}
pictures() { (cd "$1" && sha256sum -- pictures/* [0-9]*-frame*.png); }
same() { # NAME FOLDER FILE...: the folder is as that of one process, and these outputs tell each row once
    name=$1 folder=$2
    shift 2
    plain "$folder" >plain && pictures "$folder" >sums
    made=$(cat "$@" | sed -n 's/.*: [0-9]* rows in part .*, \([0-9]*\) of them made now/\1/p' | paste -sd+)
    cmp -s plain one.plain && cmp -s sums one.sums && test "$((${made:-0}))" = $rows && test -s "$folder/report.md" &&
        test -z "$(find "$folder" -name 'results.[^c]*')" && ! grep -q 'twice' "$@"
    result $? "$name" "rows made: $made, $(diff one.plain plain | head -n 2)"
}

run experiment spec.json -o one --cache cache
plain one >one.plain && pictures one >one.sums
test "$status" = 0 && test "$(wc -l <one.plain)" = $((rows + 1)) && test ! -e one/.lock
result $? "one process"
for parts in 2 5 20; do
    rm -rf shared told
    early=0
    for part in $(seq $parts -1 1); do
        run experiment spec.json -o shared --cache cache --part "$part/$parts"
        cat out err >>told
        [ "$part" = 1 ] || test ! -e shared/report.md && [ "$status" = 0 ] || early=1
    done
    same "$parts parts, one after the other" shared told
    [ $early = 0 ] && test "$(grep -c "no report yet: the part that ends last makes it" told)" = $((parts - 1))
    result $? "$parts parts: the one that ends last makes the report" "$(cat told)"
done
run experiment spec.json -o shared --cache cache --part 2/5
test "$status" = 0 && grep -q ', 0 of them made now' out && grep -q 'report.md: of 5 parts' out
result $? "nothing is left to do" "$(cat out err)"
run experiment spec.json -o shared --cache cache
test "$status" = 0 && grep -q "$rows rows, 0 of them made now" out; result $? "nor for one process"

# the same tables, however they came about, give the same bytes
rm -rf joined && mkdir joined && cp -r one/pictures joined
head -n 1 one/results.csv | tee joined/results.part-1-of-2.csv >joined/results.part-2-of-2.csv
sed -n '2,31p' one/results.csv | tac >>joined/results.part-2-of-2.csv
sed -n '32,$p' one/results.csv >>joined/results.part-1-of-2.csv
run experiment spec.json -o joined --cache cache --part 1/2
test "$status" = 0 && grep -q ', 0 of them made now' out && grep -q 'joined/report.md: of 2 parts' out
result $? "tables of parts are joined"
run experiment spec.json -o one --cache cache -q
told() { # without the command and the day
    case $1 in
    *.md) sed '/experiment spec.json/d; s/ on 20[-0-9: ]* UTC//' "$1" ;;
    *) cat "$1" ;;
    esac
}
for file in one/results.csv one/*.svg one/*.png one/*.md; do
    told "$file" >first
    told "joined/${file#one/}" | cmp -s - first || echo "$file"
done >why
test ! -s why; result $? "table, plots, sheets and report have the same bytes" "$(cat why)"

# what is in the way
mkdir odd && echo mine >odd/results.part-1-of-2.csv
expect "another file of a table's name stays" 1 'part-1-of-2.csv is a table of another kind or version: remove it' \
    experiment spec.json -o odd --cache cache --part 1/2
test "$(cat odd/results.part-1-of-2.csv)" = mine; result $? "as it is"
expect "no such part" 2 'is not K/N with K from 1 to N' experiment spec.json -o odd --cache cache --part 3/2
cp -r joined other && (cat one/results.csv | sed 's/[0-9a-f]\{32\}$/0123456789abcdef0123456789abcdef/'
) >other/results.part-9-of-9.csv
run experiment spec.json -o other --cache cache --part 1/2
test "$status" = 0 && cmp -s one/results.csv other/results.csv && grep -q 'came from other settings: kept in' err &&
    test "$(cat other/results.old*.csv | grep -c 0123456789abcdef)" = $rows
result $? "rows of other settings are kept apart" "$(ls other)"

# at once
spec 40 64 96x64 >slow.json
rows=960
run experiment slow.json -o one --cache cache.one
rm -f one/results.old*
plain one >one.plain && (cd one && ls pictures) >one.sums
pictures() { (cd "$1" && ls pictures); }
three() { # starts three parts, whose output is in told.1 and so on
    pids=
    for part in 1 2 3; do
        "$program" experiment slow.json -o shared --cache cache.two --part $part/3 >told.$part 2>&1 </dev/null &
        pids="$pids $!"
    done
}
rm -rf shared
three
until [ -s shared/results.part-2-of-3.csv ]; do sleep 0.02; done
expect "a part that is there already" 1 'shared: another process is part 2 of 3 there' \
    experiment slow.json -o shared --cache cache.two --part 2/3
expect "one process beside parts" 1 'shared: another experiment is writing there' \
    experiment slow.json -o shared --cache cache.two
until [ "$(wc -l <shared/results.part-2-of-3.csv)" -gt 20 ]; do sleep 0.02; done
# shellcheck disable=SC2086
set -- $pids
kill -KILL "$2"
for pid; do wait "$pid"; done 2>err
test ! -e shared/report.md && cat told.? >before
result $? "one is killed: no report"
made=$(($(wc -l <shared/results.part-2-of-3.csv) - 1))
three
for pid in $pids; do wait "$pid"; done
cat told.? >after
test "$(sed -n 's/.*in part 2 of 3, \([0-9]*\) of.*/\1/p' after)" = $((rows / 3 - made)) &&
    test "$(grep -c ', 0 of them made now' after)" = 2
result $? "the same command makes the rows that are missing" "$made were there; $(grep made after)"
sed "s/in part 2 of 3, .*/in part 2 of 3, $((rows / 3)) of them made now/" after >told
sed -i "s/320 rows in part [13] of 3, 0 of/320 rows in part 1 of 3, 320 of/" told
same "and all are those of one process" shared told
test "$(cat before after | grep -c 'reference made in')" = 2 && test -z "$(find cache.two -name '*.lock')"
result $? "a reference that several need is made once" "$(grep reference before after)"
if command -v parallel >where; then
    rm -rf shared
    parallel --will-cite -j2 "$program" experiment slow.json -o shared --cache cache.two --part '{}/4' ::: 1 2 3 4 \
        >told 2>&1 </dev/null
    same "GNU parallel" shared told
else
    skip "GNU parallel" "parallel is not here"
fi
if command -v mpirun >where; then
    rm -rf shared
    mpirun --oversubscribe -n 3 "$program" experiment slow.json -o shared --cache cache.two >told 2>&1 </dev/null
    same "three of Open MPI" shared told
else
    skip "three of Open MPI" "mpirun is not here"
fi
finish
