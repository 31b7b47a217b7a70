#!/bin/sh
# run-tests.sh BUILD [MESON-TEST-OPTION...]: runs the suite; the last line is "N passed, N failed, N skipped".
set -u
build=$1
shift
rm -f "$build/meson-logs/testlog.json"
meson test -C "$build" --no-rebuild --print-errorlogs "$@"
status=$?
[ -s "$build/meson-logs/testlog.json" ] || { echo "no tests were run" >&2; exit 1; }
python3 "$(dirname "$0")/count-tests.py" "$build" || exit 1
exit $status
