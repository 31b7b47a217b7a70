#!/bin/sh
# Processes that share the work: together they make what one makes, each item once, whatever started them and whichever
# of them was killed.
. "$(dirname "$0")/lib.sh"
lamp_model
unset OMPI_COMM_WORLD_RANK OMPI_COMM_WORLD_SIZE PMI_RANK PMI_SIZE JOB_COMPLETION_INDEX NOCTURNE_PARTS
for name in $(env | sed -n 's/^\(SLURM_[A-Z_]*\)=.*/\1/p'); do unset "$name"; done
# sums FOLDER: of its pictures; there is a film as well where ffmpeg is installed
sums() { (cd "$1" && sha256sum -- *.png 2>&1); }
# pictures FOLDER ARGUMENT...: the arguments that make nine pictures there
pictures() { echo "render lamp.obj --size 24x16 --animate --frames 9 --samples 2 -v -o $1/%02d.png"; }
# made FILE...: names of pictures that runs with -v made, sorted
made() { cat "$@" | sed -n 's/^nocturne: \([^ ]*\.png\)$/\1/p' | sort; }
same() { # NAME FOLDER FILE...: the folder has the pictures of `whole`, and the runs made each once
    name=$1 folder=$2
    shift 2
    sums "$folder" >sums
    made "$@" >made
    test "$(wc -l <made)" = 9 && test "$(uniq made | wc -l)" = 9 && cmp -s whole.sums sums
    result $? "$name" "$(wc -l <made) made: $(diff whole.sums sums | head -n 3)"
}
mkdir whole
# shellcheck disable=SC2046 # words
run $(pictures whole)
sums whole >whole.sums
test "$status" = 0 && test "$(wc -l <whole.sums)" = 9 && ! grep -q 'part' err
result $? "one process makes all, and says nothing of parts"

for parts in 2 3 5 12; do
    rm -rf shared err.* && mkdir shared
    part=1
    while [ $part -le $parts ]; do
        # shellcheck disable=SC2046
        run $(pictures shared) --part $part/$parts
        [ "$status" = 0 ] && grep -q "^nocturne: part $part of $parts, by --part$" err && mv err err.$part
        part=$((part + 1))
    done
    same "$parts parts make the same pictures, each once" shared err.*
done
for way in "--segment 4 --smooth" "--segment 2 --method restir --no-spatial"; do
    rm -rf one shared && mkdir one shared
    # shellcheck disable=SC2046,SC2086
    run $(pictures one) $way
    for part in 1 2; do
        # shellcheck disable=SC2046,SC2086
        run $(pictures shared) $way --part $part/2
    done
    sums one >one.sums
    sums shared | cmp -s - one.sums && test "$(wc -l <one.sums)" = 9
    result $? "and where pictures learn from each other: $way"
done
for part in 2 1; do
    # shellcheck disable=SC2046
    run $(pictures shared) --part $part/2
    test "$status" = 1 && grep -q 'is there, and is of other options.*--overwrite replaces it' err
    result $? "what is in the way of part $part is an error"
    # shellcheck disable=SC2046
    run $(pictures shared) --part $part/2 --overwrite
    made err >made
done
sums shared | cmp -s - whole.sums && test "$(wc -l <made)" = 5; result $? "and replaced on request"
test -z "$(meta shared/01.png part)"; result $? "a picture does not tell its part"

# what started the process
tells() { # VARIABLES TEXT: with these variables it says that it is this part
    # shellcheck disable=SC2046,SC2086
    env $1 "$program" $(pictures whole) >out 2>err </dev/null
    status=$?
    test $status = 0 && test "$(grep -c part err)" = 1 && grep -qx "nocturne: part $2" err
    result $? "part $2"
}
tells 'OMPI_COMM_WORLD_RANK=2 OMPI_COMM_WORLD_SIZE=5' '3 of 5, by OMPI_COMM_WORLD_RANK'
tells 'PMI_RANK=0 PMI_SIZE=2' '1 of 2, by PMI_RANK'
tells 'SLURM_ARRAY_TASK_ID=2 SLURM_ARRAY_TASK_COUNT=4 SLURM_ARRAY_TASK_MIN=1' '2 of 4, by SLURM_ARRAY_TASK_ID'
tells 'SLURM_ARRAY_TASK_ID=7 SLURM_ARRAY_TASK_MIN=0 SLURM_ARRAY_TASK_MAX=7' '8 of 8, by SLURM_ARRAY_TASK_ID'
tells 'SLURM_ARRAY_TASK_ID=9 SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=1 SLURM_ARRAY_TASK_STEP=4' \
    '3 of 3, by SLURM_ARRAY_TASK_ID'
tells 'SLURM_JOB_ID=7 SLURM_STEP_ID=0 SLURM_PROCID=1 SLURM_NTASKS=3' '2 of 3, by SLURM_PROCID'
tells 'SLURM_JOB_ID=7 SLURM_STEP_ID=0 SLURM_PROCID=1 SLURM_NTASKS=8 SLURM_STEP_NUM_TASKS=3' '2 of 3, by SLURM_PROCID'
tells 'SLURM_ARRAY_TASK_ID=2 SLURM_ARRAY_TASK_COUNT=2 SLURM_ARRAY_TASK_MIN=1 PMI_RANK=1 PMI_SIZE=3' \
    '5 of 6, by SLURM_ARRAY_TASK_ID and PMI_RANK'
tells 'JOB_COMPLETION_INDEX=3 NOCTURNE_PARTS=4' '4 of 4, by JOB_COMPLETION_INDEX'
for variables in 'SLURM_JOB_ID=7 SLURM_PROCID=0 SLURM_NTASKS=8' 'SLURM_JOB_ID=7 SLURM_NTASKS=8'; do
    # shellcheck disable=SC2046,SC2086
    env $variables "$program" $(pictures whole) >out 2>err </dev/null && ! grep -q part err
    result $? "one process of an allocation is all of it: $variables"
done
export JOB_COMPLETION_INDEX=1
# shellcheck disable=SC2046
run $(pictures whole) --part -/3
grep -qx 'nocturne: part 2 of 3, by JOB_COMPLETION_INDEX' err; result $? "a size for an index that has none"
# shellcheck disable=SC2046
run $(pictures whole) --part 1/1
test "$status" = 0 && ! grep -q part err; result $? "--part 1/1 turns it off"
unset JOB_COMPLETION_INDEX
wrong() { # VARIABLES PATTERN [ARGUMENT...]: one error, and nothing is made
    variables=$1 pattern=$2
    shift 2
    rm -rf none && mkdir none
    # shellcheck disable=SC2046,SC2086
    env $variables "$program" $(pictures none) "$@" >out 2>err </dev/null
    status=$?
    test $status = 2 && test "$(wc -l <err)" = 2 && head -n 1 err | grep -q "$pattern" && test -z "$(ls none)"
    result $? "refused: $variables $*" "status $status"
}
wrong OMPI_COMM_WORLD_RANK=0 'OMPI_COMM_WORLD_RANK is set and OMPI_COMM_WORLD_SIZE is not.*--part 1/1 does all'
wrong OMPI_COMM_WORLD_SIZE=3 'OMPI_COMM_WORLD_SIZE is set and OMPI_COMM_WORLD_RANK is not'
wrong 'OMPI_COMM_WORLD_RANK=3 OMPI_COMM_WORLD_SIZE=3' 'RANK is 3, beyond OMPI_COMM_WORLD_SIZE, which is 3'
wrong 'PMI_RANK=one PMI_SIZE=3' 'PMI_RANK is "one", not a number'
wrong 'PMI_RANK=-1 PMI_SIZE=3' 'PMI_RANK is "-1", not a number'
wrong 'PMI_RANK=0 PMI_SIZE=99999999999999999999' 'PMI_SIZE is "9*", not a number'
wrong SLURM_ARRAY_TASK_ID=2 'SLURM_ARRAY_TASK_ID is set and SLURM_ARRAY_TASK_MIN is not'
wrong 'SLURM_ARRAY_TASK_ID=7 SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=1' 'is not one of 3 even steps from'
wrong SLURM_PROCID=1 'SLURM_PROCID is set and SLURM_NTASKS is not'
wrong JOB_COMPLETION_INDEX=1 'NOCTURNE_PARTS is not: set it to the job.s completions, or pass --part -/N'
wrong NOCTURNE_PARTS=3 'NOCTURNE_PARTS is set and JOB_COMPLETION_INDEX is not'
wrong JOB_COMPLETION_INDEX=3 'part 4 of 3 does not exist' --part -/3
wrong A=1 'no variable gives K' --part -/3
for part in 0/3 4/3 1/0 3 x/3 1/ /3 1/3x -1/3 1/1000001; do
    wrong A=1 'is not K/N with K from 1 to N, nor -/N' --part "$part"
done
expect "one picture has no parts" 2 '^nocturne: --part is for --animate$' render lamp.obj --part 1/2 -o a.png

# engines, as docs/many-machines.md has them
document=$source_dir/docs/many-machines.md
mkdir path && printf '#!/bin/sh\nexec "%s" "$@" -v\n' "$program" >path/nocturne && chmod +x path/nocturne
PATH=$PWD/path:$PATH
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 \
    PARALLEL_HOME=$PWD/parallel
mkdir parallel && touch parallel/will-cite
cat >city.yaml <<'END'
nocturne: 1
inputs: [lamp.obj]
width: 24
height: 16
paths:
  way: { keys: [{ view: aerial }, { eye: [0, -12, 5], target: [0, 0, 0], seconds: 0.4 }] }
END
mkdir night
run render city.yaml --animate -o night/%04d.png
(cd night && sha256sum -- *.png) >night.sums
shared() { # NAME COMMAND...: makes the pictures of night.sums in four parts
    name=$1
    shift
    rm -rf night && mkdir night
    "$@" >out 2>err </dev/null
    status=$?
    made err >made
    (cd night && sha256sum -- *.png) >sums
    test $status = 0 && test -s sums && cmp -s sums night.sums && test "$(uniq made | wc -l)" = "$(wc -l <sums)" &&
        test "$(wc -l <made)" = "$(wc -l <sums)" && test "$(grep -c 'part [1-4] of 4, by' err)" = 4
    result $? "$name" "status $status"
}
python3 "$source_dir/tests/cli/engines.py" "$document" "GNU parallel" >parallel.sh
python3 "$source_dir/tests/cli/engines.py" "$document" "Open MPI" >mpi.sh
python3 "$source_dir/tests/cli/engines.py" "$document" "Slurm" >slurm.sh
if command -v parallel >where; then
    shared "GNU parallel" sh parallel.sh
else
    skip "GNU parallel" "parallel is not here"
fi
# as slurmd would: the script's variables, once an index
cat >array.sh <<'END'
range=$(sed -n 's/^#SBATCH --array=//p' slurm.sh)
export SLURM_ARRAY_TASK_MIN=${range%-*} SLURM_ARRAY_TASK_MAX=${range#*-}
export SLURM_ARRAY_TASK_COUNT=$((SLURM_ARRAY_TASK_MAX - SLURM_ARRAY_TASK_MIN + 1))
for SLURM_ARRAY_TASK_ID in $(seq "$SLURM_ARRAY_TASK_MIN" "$SLURM_ARRAY_TASK_MAX"); do
    export SLURM_ARRAY_TASK_ID
    sh slurm.sh || exit 1
done
END
shared "a Slurm array" sh array.sh
for index in 0 1 2 3 4; do
    python3 "$source_dir/tests/cli/engines.py" "$document" job $index
done >job.sh
shared "a job of Kubernetes" sh -e job.sh
if command -v mpirun >where; then
    shared "Open MPI" sh mpi.sh
    for parts in 1 2 3 5; do
        rm -rf shared && mkdir shared
        # shellcheck disable=SC2046
        mpirun --oversubscribe -n $parts "$program" $(pictures shared) >out 2>err </dev/null
        same "Open MPI, processes: $parts" shared err
    done
else
    skip "Open MPI" "mpirun is not here"
fi

# one is killed: what is there is whole, and the same command makes the rest
killed() { # NAME COMMAND...: runs that with the process's number in pid.2; kills it after its first picture
    name=$1
    shift
    rm -rf shared pid.2 && mkdir shared
    "$@" >out 2>err.first </dev/null &
    all=$!
    until grep -qs 'shared/0[258].png$' err.first || ! kill -0 $all 2>err; do sleep 0.05; done
    kill -KILL "$(cat pid.2)" 2>err
    wait $all
    status=$?
    find shared -name '0*.png' -printf '%p %i %T@\n' | sort >before
    there=$(wc -l <before)
    [ "$status" != 0 ] || [ "$there" = 9 ]
    result $? "$name: the end of one is told" "$status, $there pictures"
    "$@" >out 2>err.again </dev/null
    status=$?
    find shared -name '0*.png' -printf '%p %i %T@\n' | sort | join -j 1 before - | awk '$2 != $4 || $3 != $5' >changed
    made err.again >made
    sums shared | cmp -s - slow.sums && test "$status" = 0 && test ! -s changed &&
        test -z "$(find shared -name '.*.part')" && test "$(wc -l <made)" = $((9 - there))
    result $? "$name: the same command makes what is missing, and nothing else" "$there were there, $(cat changed)"
}
slow="render lamp.obj --size 24x16 --animate --frames 9 --samples 400 -v -o"
mkdir slow
# shellcheck disable=SC2086
run $slow slow/%02d.png
sums slow >slow.sums
cat >one.sh <<'END'
number=${1:-$((OMPI_COMM_WORLD_RANK + 1))}
[ "$number" = 2 ] && echo $$ >pid.2
part=${1:+--part $1/3}
exec $program $slow shared/%02d.png $part
END
export program slow
cat >three.sh <<'END'
for part in 1 2 3; do sh one.sh $part & pids="${pids:-} $!"; done
for pid in $pids; do wait "$pid" || failed=1; done
exit ${failed:-0}
END
killed "three processes of a shell" sh three.sh
if command -v mpirun >where; then
    killed "three of Open MPI" mpirun --oversubscribe -n 3 sh one.sh
else
    skip "three of Open MPI" "mpirun is not here"
fi

# films: made by the part that ends last, of all pictures
mkdir bin
cat >bin/ffmpeg <<'END'
#!/bin/sh
for last; do :; done
{ cat; printf '%s\n' "$@"; } >"${last#file:}"
echo film >>films
END
chmod +x bin/ffmpeg
path=$PATH
film() { PATH=$PWD/bin:$path run render lamp.obj --size 24x16 --animate --frames 5 --samples 1 "$@"; }
content() { sed '/dev\/fd/d' "$1"; } # a film names no descriptor
film -o one.mp4
content one.mp4 >one.film
for output in alone.mp4 beside-%d.png; do
    rm -f films
    for part in 3 1; do
        film -o $output --part $part/3
        test "$status" = 0 && test ! -e films && grep -q 'film      none yet: the part that ends last makes it' out
        result $? "no film of $output by part $part" "$(cat out)"
    done
    film -o $output --part 2/3
    made=${output%-*}
    made=${made%.mp4}.mp4
    test "$status" = 0 && content "$made" | cmp -s - one.film && test "$(wc -l <films)" = 1 && test ! -e alone-frames
    result $? "but by the last one, of the same bytes"
    film -o $output --part 3/3
    test "$status" = 0 && test "$(wc -l <films)" = 1 && grep -q 'film .*, was there' out
    result $? "and no other one"
done
large="--size 400x300 -o twice.mp4"
# shellcheck disable=SC2086
film $large && mv twice.mp4 other.mp4
cat >bin/ffmpeg <<'END'
#!/bin/sh
# another part makes the film, and removes its pictures, while this one sends them
head -c 1 >/dev/null
cp other.mp4 twice.mp4 && rm -r twice-frames
cat >/dev/null
END
for part in 1 2; do
    # shellcheck disable=SC2086
    film $large --part $part/2
done
test "$status" = 0 && test "$(wc -l <err)" = 1 && cmp -s twice.mp4 other.mp4 && test -z "$(find . -name '.twice*')"
result $? "two parts that end at once may both make the film"
finish
