#!/bin/sh
# tools/count-tests.py, which `make check` believes: every way in which a test program can end.
set -u
source_dir=${NOC_SOURCE:?names the source folder}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
mkdir "$work/meson-logs"
log=$work/meson-logs/testlog.json
count=0 failed=0

# program NAME RESULT STDOUT: one line of Meson's log
program() { printf '{"name": "%s", "result": "%s", "stdout": "%s"}\n' "$1" "$2" "$3" >>"$log"; }

# expect NAME STATUS LAST-LINE [LINE]: of the log so far, which is then emptied
expect() {
    count=$((count + 1))
    python3 "$source_dir/tools/count-tests.py" "$work" >"$work/out" 2>&1
    if [ $? = "$2" ] && [ "$(tail -n 1 "$work/out")" = "$3" ] && { [ -z "${4:-}" ] ||
        grep -qxF "$4" "$work/out"; }; then
        echo "ok $count - $1"
    else
        failed=1
        echo "not ok $count - $1"
        sed 's/^/# /' "$work/out"
    fi
    : >"$log"
}

program a OK '1..2\nok 1 - x\nok 2 - y\n# ok - tests\n'
program b OK 'ok 1 - z\n1..1\n'
expect "all pass" 0 "3 passed, 0 failed, 0 skipped"
program a FAIL '1..2\nok 1 - x\nnot ok 2 - y\n# why\n# not ok - tests\n'
expect "one fails" 1 "1 passed, 1 failed, 0 skipped" "failed: a y (why)"
program a OK '1..2\n# skipped: shared/x is not here\nnot ok 1 # SKIP x\nok 2 - y\n'
expect "cmocka skips" 0 "1 passed, 0 failed, 1 skipped" "skipped: a x (shared/x is not here)"
program a OK 'ok 1 - x # SKIP no such device\nok 2 - y\n1..2\n'
expect "a shell test skips" 0 "1 passed, 0 failed, 1 skipped" "skipped: a x (no such device)"
program a ERROR '1..5\nok 1 - x\nok 2 - y\n'
expect "a crash half-way: what was not reached has failed" 1 "2 passed, 3 failed, 0 skipped" \
    "failed: a (not reached) (ERROR)"
program a ERROR 'ok 1 - x\n'
expect "a shell test that stops without its plan" 1 "1 passed, 1 failed, 0 skipped"
program a ERROR '1..1\nok 1 - x\n'
expect "a bad status after good tests, as of a leak" 1 "1 passed, 1 failed, 0 skipped" "failed: a (at the end) (ERROR)"
program a TIMEOUT ''
expect "nothing said at all" 1 "0 passed, 1 failed, 0 skipped"
program a OK 'no TAP here\n'
program b FAIL ''
program c SKIP ''
expect "programs without TAP are one test each" 1 "1 passed, 1 failed, 1 skipped"
expect "no tests are no success" 1 "0 passed, 0 failed, 0 skipped"

# tools/turn-tests.py, by which CI shares slow tests out.
build=${NOC_BUILD:?names the build folder}
meson introspect --tests "$build" >"$work/tests"
# timed SLOW: a log in which every SLOWth test took 2 s, the others 0.5 s
timed() {
    python3 -c '
import json, sys
tests = [test for test in json.load(sys.stdin) if not test["name"].startswith("fuzz-")]
for i, test in enumerate(tests):
    print(json.dumps({"name": test["name"], "duration": 0.5 if i % int(sys.argv[1]) else 2}))' \
        "$1" <"$work/tests" >"$log"
}
chosen() { python3 "$source_dir/tools/turn-tests.py" "$build" "$work" "$@" | tr ' ' '\n'; }
# report NAME FOUND EXPECTED
report() {
    count=$((count + 1))
    if [ "$2" = "$3" ]; then
        echo "ok $count - $1"
    else
        failed=1
        echo "not ok $count - $1: $2, not $3"
    fi
}
timed 2
lines=$(wc -l <"$log")
times=$(for turn in 1790000003 1790000004 1790000005 1790000006 1790000007 1790000008; do chosen $turn; done | sort |
    uniq -c | awk '{ print $1 }' | sort -n | uniq -c | awk '{ printf "%s%s x%s", n++ ? ", " : "", $1, $2 }')
report "of six turns each slow test has one, quick ones have all" "$times" \
    "$(((lines + 1) / 2)) x1, $((lines / 2)) x6"
chosen 4 >"$work/half"
timed 1
chosen 4 >"$work/all"
report "the turn of a test is its own" "$(grep -vxFf "$work/half" "$work/all")" ""
: >"$log"
report "without times all tests are chosen" "$(chosen 1 | wc -l)" "$lines"
chosen_of_full() { python3 "$source_dir/tools/turn-tests.py" "$build" - "$1" | tr ' ' '\n'; }
for turn in 1790000003 1790000004 1790000005; do chosen_of_full $turn; done | sort | uniq -c >"$work/turns"
report "of three turns each test of the suite full has one" \
    "$(awk '{ print $1 }' "$work/turns" | sort -u | paste -sd' ')" "1 3"
report "and no test is left out" "$(wc -l <"$work/turns")" "$lines"
report "what they need is built" \
    "$(chosen 1 targets | grep -cxE 'nocturne|tests/test-base(-test_base)?|fuzz/fuzz_image')" 2

# tools/test_targets.py: what `make check` builds, and who runs some tests by name.
targets() { python3 "$source_dir/tools/test_targets.py" "$build" "$@" 2>"$work/err" | tr ' ' '\n'; }
targets >"$work/quick"
report "the quick suite builds what it runs" \
    "$(grep -cE '^(nocturne|examples/minimal|tests/test-(city|import)(-test_windows)?)$' "$work/quick")" 4
report "and nothing else" "$(grep -E 'bench|fuzz|dialect' "$work/quick")" ""
report "a test by name needs its room" "$(targets city-test_windows tools-count | xargs)" \
    "$(targets city-test_windows | xargs)"
report "and no more than it" "$(targets city-test_windows | grep -c ^tests/)" 1
targets city-test_nowhere >"$work/out"
report "a name that is no test's" "$(cat "$work/out" "$work/err")" "no test is named city-test_nowhere"

# tests/main.c, the program of a room. Under sanitizers there is none.
room=$build/tests/test-city
if [ -x "$room" ]; then
    report "a room lists its suites" "$("$room" | grep -cE '/tests/city/test_[a-z_]+\.c$')" \
        "$(find "$source_dir/tests/city" -name 'test_*.c' | wc -l)"
    "$room" test_nowhere >"$work/out" 2>"$work/err"
    report "it fails for another" "$? $(cat "$work/out" "$work/err")" "2 $room: no suite is named test_nowhere"
    "$room" test_window >"$work/out" 2>&1
    report "and for the beginning of a name" "$?" 2
fi

echo "1..$count"
exit $failed
