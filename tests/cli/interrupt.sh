#!/bin/sh
# Ctrl-C: the picture so far is saved and that is said; before the first frame nothing is.
. "$(dirname "$0")/lib.sh"

# interrupt SIGNAL WHEN ARGUMENT...: starts the program, sends the signal once stderr matches WHEN
interrupt() {
    signal=$1 when=$2
    shift 2
    start "$@"
    tries=0
    until grep -qs "$when" err; do
        tries=$((tries + 1))
        [ $tries -gt 3000 ] && break # against hangs alone
        kill -0 $pid 2>/dev/null || break
        sleep 0.1
    done
    kill -"$signal" $pid 2>/dev/null
    wait $pid
    status=$?
}

city='builtin:city --city-size 150 --size 64x36'
interrupt INT 'frame 2:' render $city --frames 1e9 -v -o a.png
test $status = 130 && grep -Eq 'interrupted: saved [0-9]+ of 1000000000 frames to a.png' err
result $? "Ctrl-C saves the picture so far"
test "$(meta a.png size)" = "64 36"; result $? "which is whole"
frames=$(sed -n 's/.*saved \([0-9]*\) of.*/\1/p' err)
test "$(meta a.png frames)" = "$frames"
result $? "and tells how many frames it holds" "$frames"
interrupt TERM 'frame 2:' render $city --frames 1e9 -v -o b.exr
test $status = 143 && grep -q 'interrupted: saved' err && test -s b.exr; result $? "SIGTERM too, with its own status"

interrupt HUP 'frame 2:' render $city --frames 1e9 -v -o c.exr
test $status = 129 && grep -q 'interrupted: saved' err && test -s c.exr; result $? "and SIGHUP, when the terminal goes"
rm c.exr
# ignored from the start, as under nohup: frames go on until another signal comes
: >err
env --ignore-signal=HUP,INT "$program" render $city --frames 1e9 -v -o c.exr >out 2>err </dev/null &
pid=$!
until grep -q 'frame 2:' err || ! kill -0 $pid; do sleep 0.1; done
kill -HUP $pid && kill -INT $pid
sent=$? frames=$(grep -c 'frame [0-9]*:' err)
until test "$(grep -c 'frame [0-9]*:' err)" -gt $((frames + 1)) || ! kill -0 $pid; do sleep 0.1; done
kill -TERM $pid
wait $pid
status=$?
test $status = 143 && test $sent = 0 && test -s c.exr; result $? "signals that are ignored stay so" "$status"
rm c.exr

# One frame of many reference rays a pixel takes minutes: it is interrupted before it is complete.
long='builtin:city --city-size 150 --size 4000x4000 --method reference --rays 1024'
interrupt INT 'triangles' render $long -v -o c.png
test $status = 130 && grep -q 'interrupted: .* nothing was saved' err && test ! -e c.png
result $? "before the first frame nothing is saved"
mkdir bin && printf '#!/bin/sh\n' >bin/ffmpeg && chmod +x bin/ffmpeg
(PATH=$PWD/bin:$PATH
    start render $long --animate --exposure 3 -o film.mp4
    until test -d film-frames || ! kill -0 $pid 2>/dev/null; do sleep 0.1; done
    test -d film-frames && kill -INT $pid
    wait $pid)
test $? = 130 && test ! -e film-frames; result $? "nor is a film's folder left without a picture"
rm -r bin
test "$(ls)" = "a.png
b.exr
err
out"; result $? "and nothing is left behind" "$(ls | tr '\n' ' ')"
finish
