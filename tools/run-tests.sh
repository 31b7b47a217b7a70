#!/bin/sh
# run-tests.sh BUILD [MESON-TEST-OPTION...]: runs tests; the last line is "N passed, N failed, N skipped". One more than
# there are processors, since some wait for a browser, or for what a program does after some seconds.
set -u
build=$1
shift
rm -f "$build/meson-logs/testlog.json"
# Where `python3` is a script that looks for one each time (pyenv), tests that call it often would take twice as long.
found=$(python3 -c 'import sys; print(sys.executable)') && PATH="${found%/*}:$PATH"
export PATH
export MESON_TESTTHREADS="${MESON_TESTTHREADS:-$(($(nproc) + 1))}"
meson test -C "$build" --no-rebuild --print-errorlogs "$@"
status=$?
[ -s "$build/meson-logs/testlog.json" ] || { echo "no tests were run" >&2; exit 1; }
python3 "$(dirname "$0")/count-tests.py" "$build" || exit 1
exit $status
