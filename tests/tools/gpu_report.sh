#!/bin/sh
# tools/gpu-report.sh and tools/gpu-report.py, with a program that only pretends: steps, limits, and what the page says.
. "$(dirname "$0")/../cli/lib.sh"

# A pack whose program writes what nocturne would, and whose tests pass, fail, hang and die.
pack=$work/pack
mkdir -p "$pack/build/tests" "$pack/specs" "$pack/lib"
cp "$source_dir/tools/gpu-report.sh" "$source_dir/tools/gpu-report.py" "$source_dir/tools/count-tests.py" "$pack/"
echo 1234567 >"$pack/commit"
cat >"$pack/build/nocturne" <<'PROGRAM'
#!/bin/sh
echo "$*" >>"$ASKED"
case "$*" in *"${SLOW:-nothing}"*) exec sleep 12 ;; esac
case "$*" in
devices) printf 'embree 0 processor, P\n%s\n' "$DEVICES" ;;
*lights*) echo 'nocturne: vulkan: the device is lost' >&2; exit 1 ;;
bench*) while [ "$1" != -o ]; do shift; done; cp "$BENCH" "$2" ;;
experiment*) while [ "$1" != -o ]; do shift; done; mkdir -p "$2"; cp "$ROWS" "$2/results.csv" ;;
esac
PROGRAM
cat >"$pack/build/tests/mixed" <<'TEST'
#!/bin/sh
printf 'ok 1 - a\nnot ok 2 - b\nok 3 - c # SKIP no layer\n1..3\n'
exit 1
TEST
printf '#!/bin/sh\necho 1..2; echo "ok 1 - a"; kill -SEGV $$\n' >"$pack/build/tests/dies"
printf '#!/bin/sh\nexec sleep 60\n' >"$pack/build/tests/hangs"
chmod +x "$pack/build/nocturne" "$pack"/build/tests/*
for t in mixed dies hangs; do echo "$t @PACK@/build/tests/$t"; done >"$pack/tests.txt"
for s in frame-times cars; do
    echo '{ "size": "1x1", "crop": [0, 0, 1, 1], "light-view": true, "repetitions": 4 }' >"$pack/specs/$s.json"
done
cat >bench.json <<'BENCH'
{ "processor": "P", "cores": 2, "method": "restir-uniform", "scene": { "triangles": 1000, "lights": 20 },
  "left_out": [ { "table": "floor", "what": "aerial", "why": "no time" } ],
  "tables": { "floor": [ { "name": "restir-uniform", "view": "street", "wall_s": 0.012, "floor_wall_s": 0.004,
    "cpu_s": 0.02, "floor_cpu_s": 0.01, "rays_primary": 1000000, "rays_shadow": 3000000, "frames": 9,
    "first_wall_s": 0.075,
    "passes": [ { "pass": "primary", "thread_s": 0.0015 }, { "pass": "spatial", "thread_s": 0.0025 } ] } ] } }
BENCH
python3 - <<'ROWS'
import csv
columns = "scene configuration frame wall_s cpu_s wall_total_s cpu_total_s".split()
out = csv.writer(open("rows.csv", "w"))
out.writerow(columns)
for kind, ms in (("lamps", 4), ("lamps and windows", 6), ("all windows lit", 10)):
    for frame, extra in ((1, 90), (2, 70), (3, 0), (4, 0)): # the first two frames do not count
        out.writerow(["built-in, " + kind, "SRIS #40", frame, (ms + extra) / 1e3, 1, 0, 0])
for kind, ms in (("no cars", 5), ("cars at rest", 6), ("cars driving", 9)):
    for odd in 0, 100, 0: # a median of runs
        out.writerow(["built-in, " + kind, "ReSTIR", 20, (ms + odd) / 1e3, 0, (20 * ms + 33) / 1e3, 1])
ROWS
export TEST_LIMIT=3 ASKED="$work/asked" BENCH="$work/bench.json" ROWS="$work/rows.csv"

# report DEVICES BUDGET: a run, and its page
report() {
    rm -rf made asked
    DEVICES=$1 BUDGET=$2 VK_DRIVER_FILES=none sh "$pack/gpu-report.sh" run "$work/made" >err 2>&1
    page=$(ls made/*.md)
}
# says TEXT...: each is a line of the page, or a part of one
says() {
    for text in "$@"; do
        grep -qF -- "$text" "$page" || { echo "not said: $text" >>err; return 1; }
    done
}

report 'vulkan 0 discrete, NVIDIA GeForce RTX 3060, NVIDIA 550.54
vulkan 1 software, llvmpipe (LLVM 15.0.6, 256 bits), Mesa 25.0.7' 60
test "$page" = made/nvidia-geforce-rtx-3060.md && says '# NVIDIA GeForce RTX 3060' 'NVIDIA 550.54, discrete' \
    'Commit: 1234567' 'Pictures: 1920x1080 px'
result $? "a page is called after the card, and names its driver"
! grep -q 'no ray-tracing cores\|software on a processor' "$page"
result $? "nothing is held against a card with such cores"
says '| mixed | 1 | 1 | 1 |' '- failed: mixed b' '- skipped: mixed c (no layer)' '| dies | 1 | 0 | 0 |' \
    'ended before its end, status 139' '| hangs | 0 | 0 | 0 |' 'stopped at its limit'
result $? "tests that fail, are skipped, die and hang are told apart"
says '| restir-uniform, street | 12 | 3 | 1000 | 9 | 75 |' 'Left out: aerial (no time).' \
    '| primary | 1.5 |' '| spatial | 2.5 |' 'Timestamps of the device'
result $? "a frame over its floor by the clock, its first frame apart, and its passes"
says '| SRIS #40 | 4 (1.5, 2.5) | 94 / 96 / 100 | 7.69 (6.2) |'
result $? "windows over lamps beside the thesis, first frames apart"
says '| ReSTIR | 5 | 1.2 | 1.5 | 33 / 33 / 33 |'
result $? "cars that drive over cars at rest, by medians of last frames"
grep -v "^devices" asked | sed 's/ --.*-only / /; s/ --.*//; s/,.*//; s|[^ ]*/||' >order
printf '%s\n' 'bench floor' 'experiment frame-times-sized.json' 'bench lights' 'experiment cars-sized.json' \
    'bench floor' | diff - order >err
result $? "rows are measured in order of worth, after the tests"
says 'Not measured: vulkan: the device is lost.'; result $? "a step that failed says why, and the others are there"
grep -q -- '^bench --backend vulkan --device 0 .*--size 1920x1080' asked; result $? "the GPU is taken before software"
python3 - <<'CHECK' 2>err
import json
for name in "frame-times", "cars":
    spec = json.load(open("pack/specs/%s-sized.json" % name))
    assert spec["size"] == "1920x1080" and "crop" not in spec and "light-view" not in spec
    assert spec["repetitions"] == (3 if name == "cars" else 1)
CHECK
result $? "specs are those of the report's size"
test "$(ls made | wc -l)" -le 8 && grep -q '^==> steps.txt' made/log.txt; result $? "few files, and a log"

: >"$pack/tests.txt" # the others are of devices
report 'vulkan 0 discrete, NVIDIA H100 80GB HBM3, NVIDIA 580.159' 0
says 'This chip has no ray-tracing cores' 'say nothing of a card that has such cores, as the thesis'
result $? "an H100's figures say nothing of an RTX 3060, and the page does"
report 'vulkan 0 software, llvmpipe (LLVM 15.0.6, 256 bits), Mesa 25.0.7' 60
says 'This is software on a processor, no GPU' '| restir-uniform, street | 20 | 2 |' 'Thread time' 'Pictures: 96x54 px'
result $? "software says so, is timed by the processor, and draws small pictures"
report 'vulkan 0 discrete, X: not usable: no ray tracing
vulkan 1 integrated, Y, Z 1' 0
says '# Y'; result $? "what is not usable is passed by"
for wanted in 1 3060 'rtx 3060'; do
    DEVICE=$wanted report 'vulkan 0 discrete, Y, Z 1
vulkan 1 discrete, NVIDIA GeForce RTX 3060, D' 0
    says '# NVIDIA GeForce RTX 3060' 2>/dev/null || echo "$wanted" >>unnamed
done
test ! -e unnamed; result $? "DEVICE is a number or a part of a name" "$(cat unnamed 2>/dev/null)"
report 'vulkan 0 discrete, Y, Z 1' 0
says '# Y' 'None were run' 'Not measured: no time was left'
result $? "steps that do not fit into the time are left out, and said"
SLOW=floor,passes report 'vulkan 0 discrete, Y, Z 1' 20
says '## Frame over trace floor' 'Not measured: it was stopped at its limit' '| SRIS #40'
result $? "a step that is stuck takes its own share of the time"
python3 - bench.json none.json <<'NONE'
import json, sys
bench = json.load(open(sys.argv[1]))
bench["tables"]["floor"] = []
json.dump(bench, open(sys.argv[2], "w"))
NONE
BENCH=$work/none.json report 'vulkan 0 discrete, Y, Z 1' 60
says '## Frame over trace floor' 'Not measured: no time.'; result $? "a table whose rows were all left out says why"
# ended SIGNAL: a run that gets this signal while it measures cars
ended() {
    rm -rf made asked
    SLOW=cars-sized DEVICES='vulkan 0 discrete, Y, Z 1' BUDGET=60 VK_DRIVER_FILES=none \
        sh "$pack/gpu-report.sh" run "$work/made" >err 2>&1 &
    until grep -q cars-sized asked 2>/dev/null; do sleep 0.1; done
    kill -s "$1" $!
    wait $! 2>/dev/null
    page=$(ls made/*.md)
}
ended TERM
says '**the run was stopped by a signal after' '| SRIS #40' 'Not measured: the run was stopped.' \
    'Not measured: no time was left.'
result $? "a run that is ended by a signal writes its page, and leaves out what is left"
ended KILL
says '| SRIS #40' '| restir-uniform, street'
result $? "a run that is killed leaves the page of what it had"
for name in 'NVIDIA RTX A6000' 'NVIDIA A40' 'NVIDIA L4' 'Tesla T4' 'AMD Radeon RX 7900 XTX'; do
    report "vulkan 0 discrete, $name, D 1" 0
    ! grep -q 'no ray-tracing cores' "$page" || echo "$name" >>wrong
done
for name in 'NVIDIA A100-SXM4-40GB' 'NVIDIA H200' 'Tesla V100-SXM2-16GB' 'NVIDIA GeForce GTX 1080 Ti' \
    'AMD Instinct MI300X'; do
    report "vulkan 0 discrete, $name, D 1" 0
    grep -q 'no ray-tracing cores' "$page" || echo "$name" >>wrong
done
test ! -e wrong; result $? "cards with and without ray-tracing cores, by name" "$(cat wrong 2>/dev/null)"
finish
