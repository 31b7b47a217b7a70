#!/bin/sh
# The program that docs/experiments.md shows: it compiles as it stands there, and prints a line a frame.
. "$(dirname "$0")/../cli/lib.sh"
sed -n '/^```c$/,/^```$/p' "$source_dir/docs/experiments.md" | sed '/^```/d' >example.c
grep -q noc_lab_measure example.c; result $? "docs/experiments.md shows a program"
# A library that was built with sanitizers wants them in the program, too.
sanitize=$(nm -D "$NOC_BUILD/libnocturne.so" 2>/dev/null | grep -q __asan_init && echo -fsanitize=address)
if command -v "${CC:-cc}" >/dev/null; then
    ${CC:-cc} $sanitize -Wall -Wextra -Werror -I"$source_dir/include" example.c -L"$NOC_BUILD" -Wl,-rpath,"$NOC_BUILD" \
        -lnocturne -o example >out 2>err
    result $? "which compiles"
    ./example >out 2>err
    test $? = 0 && test "$(grep -Ec '^mean of [0-9]+: RMSE [0-9.e-]+ cd/m2, relMSE [0-9.e-]+, [0-9.]+ ms$' out)" = 20
    result $? "and prints the figures of twenty frames"
    awk 'NR == 1 { first = $5 } { last = $5 } END { exit !(last > 0 && last < 0.7 * first) }' out
    result $? "of which the last is better than the first by far"
else
    skip "which compiles and runs" "no C compiler here"
fi
finish
