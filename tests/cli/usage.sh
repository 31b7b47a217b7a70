#!/bin/sh
# Wrong arguments: status 2, one clear line, where to read on, and nothing written.
. "$(dirname "$0")/lib.sh"
c=builtin:city
long=$(head -c 10000 /dev/zero | tr '\0' x)
bytes=$(printf '\377\376\200')
escape=$(printf '\033[31m')

expect "no arguments at all" 2 'nocturne render'
expect "unknown command" 2 'no command "rendr"; is it render\?' rendr
expect "unknown command, nothing near" 2 'no command "frobnicate"' frobnicate
expect "an option before the command" 2 'command comes first' -v render
: >city.gml
expect "a file in the command's place" 2 'nocturne render city.gml -o night.png' city.gml
expect "help of an unknown command" 2 'no command "compar"; is it compare' help compar
expect "render without input" 2 'nothing to draw' render -o a.png
expect "render without output" 2 'where to' render $c
expect "unknown option" 2 'no option --candidatse; is it --candidates\?' render $c -o a.png --candidatse 3
expect "unknown option with value" 2 'no option --widht=3; is it --width\?' render $c -o a.png --widht=3
expect "unknown negation" 2 'no option --no-temporl; is it --no-temporal\?' render $c -o a.png --no-temporl
expect "negation of a number" 2 'no option --no-width' render $c -o a.png --no-width
expect "negation with a value" 2 'no-temporal takes no value' render $c -o a.png --no-temporal=1
expect "an option begun" 2 'is it --candidates\?' render $c -o a.png --cand 3
expect "a long option with one dash" 2 'is it --output\?' render $c -output a.png
expect "unknown short option" 2 'no option -z' render $c -o a.png -z
expect "missing value at the end" 2 '--width needs a value' render $c -o a.png --width
expect "missing value before an option" 2 '--width needs a value' render $c -o a.png --width --height 3
expect "missing value after =" 2 'width: needs a value' render $c -o a.png --width=
expect "missing short value" 2 '-o needs a value' render $c -o
expect "two outputs" 2 '-o is given twice' render $c -o a.png -o b.png
expect "two outputs, long and short" 2 '-o is given twice' render $c -o a.png --output=b.png
expect "an empty argument" 2 'an argument is empty' render $c "" -o a.png
expect "an empty output" 2 'output: needs a value' render $c -o ""
expect "no number" 2 'width: "abc" is not a number' render $c -o a.png --width abc
expect "no whole number" 2 'is not a whole number' render $c -o a.png --width 10.5
expect "negative frames" 2 'frames: "-3" is outside 1 to 1000000000' render $c -o a.png --frames -3
expect "zero frames" 2 'frames: "0" is outside' render $c -o a.png --frames 0
expect "too many frames" 2 'frames: "1e10" is outside' render $c -o a.png --frames 1e10
expect "not a number" 2 'not a number' render $c -o a.png --sky nan
expect "a sky that is no class" 2 'sky: "bortle:12" is not bortle:1 to bortle:9' render $c -o a.png --sky bortle:12
expect "infinite" 2 'not a number' render $c -o a.png --sky inf
expect "huge" 2 'not a number' render $c -o a.png --sky 1e400
expect "unknown choice" 2 'method: "ristir" is none of reference\|is\|ris\|restir' render $c -o a.png --method ristir
expect "a bool that is none" 2 'temporal: "maybe" is neither true nor false: .*--no-temporal off' \
    render $c -o a.png --temporal=maybe
expect "a value of a switch" 2 '--wet is a switch and takes no value, and no file is called "5"' \
    render $c --wet 5 -o a.png
expect "a word of a switch" 2 '--no-wet is a switch and takes no value' render $c -o a.png --no-wet off
mkdir switches && echo >switches/5
(cd switches && "$program" render --wet 5 -o a.png) >out 2>err
test $? = 1 && grep -q '^nocturne: 5: ' err; result $? "a file that is called so is an input"
rm -r switches
expect "a number tells its range and unit" 2 'fov: "wide" is not a number from 1 to 170 degrees' \
    render $c -o a.png --fov wide
expect "a whole number, too" 2 'width: "9.5" is not a whole number from 1 to 32768 px' render $c -o a.png --width 9.5
for size in 0x0 0x10 10x0 -1x5 100000x100000 32769x1 10 10x 10x10x10 10,10 axb 1e9x1 10.5x10 ' 10x10' 'infx10' \
    '0x10x10'; do
    expect "size '$size'" 2 '--size: ' render $c -o a.png "--size=$size"
done
for size in 0x0 0x10 10x0; do
    expect "size '$size' is too small, not misspelt" 2 "a side is 1 to 32768 px, not $size" render $c -o a.png \
        --size $size
done
expect "an eye beyond all bounds" 2 '--eye: "1e300,0,0" is more than 10000 km away' render $c -o a.png --eye 1e300,0,0 \
    --target 0,0,0
expect "a target beyond them" 2 '--target: "0,-1e7,0" is more than' render $c -o a.png --eye 0,0,0 --target 0,-1e7,0
expect "size and width" 2 'exclude each other' render $c -o a.png --size 10x10 --width 10
for v in 1,2 1,2,3,4 a,b,c '1,2,' ',,,' 'nan,0,0' '1, 2, 3' 1e999,0,0; do
    expect "eye '$v'" 2 '--eye: .* is not X,Y,Z' render $c -o a.png --eye "$v" --target 0,0,0
    expect "target '$v'" 2 '--target: .* is not X,Y,Z' render $c -o a.png --target "$v" --eye 0,0,0
done
expect "half an eye is told of before a missing target" 2 '--eye: "1,2" is not X,Y,Z' render $c -o a.png --eye 1,2
expect "eye without target" 2 '--eye needs --target' render $c -o a.png --eye 0,0,0
expect "target without eye" 2 '--target needs --eye' render $c -o a.png --target 0,0,0
expect "eye at target" 2 'the same place' render $c -o a.png --eye 1,2,3 --target 1,2,3.0
expect "eye and view" 2 'exclude each other' render $c -o a.png --eye 1,2,3 --target 0,0,0 --view aerial
expect "camera CRS without eye" 2 '--camera-crs is for' render $c -o a.png --camera-crs EPSG:25832
expect "options of a city that is not drawn" 2 '--city-size is for the input builtin:city' render city.gml -o a.png \
    --city-size 200
expect "an unknown view" 2 'show: "lamps" is none of picture\|lights' render $c -o a.png --show lamps
expect "a view without a query" 2 'view "lights": only ris and restir with candidates influence or lists' render $c \
    -o a.png --show lights --candidates light-bvh
expect "a view of no reservoir" 2 'view "weight": the reference method' render $c -o a.png --show weight \
    --method reference
expect "variance of nothing" 2 'frames must be accumulated' render $c -o a.png --show variance --no-accumulate
expect "variance of one frame" 2 '--show error needs two frames' render $c -o a.png --show error --frames 1
expect "a bar without a view" 2 '--show-range is for views' render $c -o a.png --show-range 0,1
expect "lines without a view" 2 '--isolines is for views' render $c -o a.png --isolines 5
expect "lines among names" 2 '--isolines is for views' render $c -o a.png --show class --isolines 5
expect "a scale without a view" 2 '--show-scale is for views' render $c -o a.png --show-scale log
expect "a logarithmic bar from 0" 2 'begins above 0' render $c -o a.png --show illuminance --show-range 0,9
for v in 33 2.5 -1 x , 1,1 2,1 0,1 1,,2 1,nan; do
    expect "isolines $v" 2 '--isolines: ".*" is neither' render $c -o a.png --show illuminance --isolines="$v"
done
expect "a bar of names" 2 '--show-range is for views' render $c -o a.png --show light --show-range 0,1
for v in 1 1,1 2,1 -1,1 a,b 1,2,3 nan,1 0,inf; do
    expect "a bar of $v" 2 '--show-range: ".*" is not LOW,HIGH' render $c -o a.png --show lights --show-range=$v
done
expect "field of view of 0" 2 'fov: "0" is outside 1 to 170 degrees' render $c -o a.png --fov 0
for e in bright 31 -31 1,2 f/2,1/30 f/0,1,iso100 ''; do
    expect "exposure '$e'" 2 'exposure: ' render $c -o a.png "--exposure=$e"
done
expect "10 000 characters as an option" 2 'no option --xxx.*\.\.\.' render $c "--$long"
expect "10 000 characters as a value" 2 'width: "x*\.\.\." is not a number' render $c --width "$long"
expect "10 000 characters as a command" 2 'no command "xxx.*\.\.\.' "$long"
expect "10 000 characters as an output" 2 'must end in .png or .exr' render $c -o "$long"
expect "bytes that are no UTF-8 as an option" 2 'no option' render $c "--$bytes"
expect "bytes that are no UTF-8 as a number" 2 'not a number' render $c --width "$bytes"
expect "an escape sequence in an argument" 2 'no option' render $c "--$escape"
if grep -q "$(printf '\033')" err; then false; else true; fi
result $? "no escape sequence comes back"
expect "info without file" 2 'which file' info
expect "info with an unknown option" 2 'is it --json' info --jsn x
expect "compare with one picture" 2 'two pictures' compare a.exr
expect "compare with three pictures" 2 'two pictures' compare a.exr b.exr c.exr
expect "compare with a bad ceiling" 2 'ceiling: "0" is outside' compare a.exr b.exr --ceiling 0
expect "compare to something else than PNG" 2 'must end in .png' compare a.exr b.exr -o d.exr

expect "an instruction set that is none" 2 'isa: "mmx" is none of auto' render $c --isa mmx
expect "light of a map that is not there" 2 '--environment-light needs a map around the city' render $c -o x.png \
    --environment-light
export NOCTURNE_ISA=mmx
expect "one in the environment" 1 'NOCTURNE_ISA: "mmx" is no instruction set' render $c -o x.png
unset NOCTURNE_ISA

test "$(ls)" = "city.gml
err
out"
result $? "nothing was written" "$(ls | tr '\n' ' ')"

run help render
grep -q -- '--fov X .*that of the view' out && ! grep -A1 -- '--fov X' out | grep -q '\['
result $? "--fov has no default of its own"
run --version
test $status = 0 && grep -Eq '^nocturne [0-9]+\.[0-9]+\.[0-9]+ \(embree [0-9]+\.[0-9.]+, ' out; result $? "--version"
for h in help --help -h; do
    run $h
    test $status = 0 && grep -q 'nocturne compare' out && test ! -s err; result $? "$h"
done
for cmd in render info compare; do
    run help $cmd; cp out first
    test $status = 0 && grep -q -- '--help' out; result $? "help $cmd"
    run $cmd --help
    test $status = 0 && cmp -s out first; result $? "$cmd --help is the same"
    run $cmd -h
    test $status = 0 && cmp -s out first; result $? "$cmd -h is the same"
    test "$(wc -l <first)" -le 264 && ! grep -Eq '^.{81}' first && ! grep -q ' $' first
    result $? "help $cmd fits four screens of 80 columns"
done
if [ -e /dev/full ]; then
    "$program" help render >/dev/full 2>err
    test $? = 1 && grep -q 'standard output' err; result $? "a full disk under stdout is a failure"
    "$program" render --help >/dev/full 2>err
    test $? = 1 && grep -q 'standard output' err; result $? "so it is under --help"
fi
# ---- limits of the process ----
# stacked LIMIT ARGUMENT...: by a soft limit (-S) or one that cannot be raised (-SH); dash knows no -s of a soft limit
# alone
stacked() {
    limit=$1
    shift
    bash -c 'ulimit $0 -s 64; exec "$@"' "$limit" "$program" "$@" >out 2>err
    status=$?
}
if ! "$program" render builtin:city --city-size 150 --size 32x32 --frames 1 -o whole.png >out 2>err; then
    skip "a small stack" "nothing is drawn here"
else
    stacked -S render builtin:city --city-size 150 --size 32x32 --frames 1 -o small.png
    test $status = 0 && test -s small.png
    result $? "a stack of 64 kB is raised where it may be" "status $status: $(cat err)"
    stacked -SH render builtin:city --city-size 150 --size 32x32 --frames 1 -o none.png
    test $status = 1 && grep -q 'limit of the stack is 64 kB' err && test ! -e none.png
    result $? "and told where it may not" "status $status: $(cat err)"
fi
(PROJ_DATA=/nonexistent PROJ_LIB=/nonexistent; export PROJ_DATA PROJ_LIB; run info \
    "$source_dir/tests/cli/city.gml"; echo $status >ended)
test "$(cat ended)" = 1 && grep -q 'proj.db' err
result $? "a database of PROJ that is not there is an error" "$(cat err)"
run --version
files='(files by Landlock|Landlock for files is not there)' \
    calls='(system calls by seccomp|seccomp for system calls is not there)'
none='neither Landlock for files nor seccomp for system calls is there' # in any order: which there are is the system's
grep -E 'isolation of foreign readers: a process of its own and limits' out |
    grep -E "$files.*$calls|$calls.*$files|$none" >/dev/null
result $? "the version tells what isolation there is" "$(cat out)"

finish
