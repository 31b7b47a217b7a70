#!/bin/sh
# Animations: a picture for each step along a path, the same however often it was interrupted.
. "$(dirname "$0")/lib.sh"
lamp_model
cat >lamp.yaml <<'END'
nocturne: 1
inputs: [lamp.obj]
width: 24
height: 16
cameras:
  side: { eye: [9, -9, 6], target: [0, 0, 0], fov: 40 }
paths:
  way:
    keys:
      - { camera: side }
      - { eye: [0, -12, 5], target: [0, 0, 0], fov: 40, seconds: 0.5 }
      - { camera: side, fov: 60, seconds: 1 }
  round:
    loop: on
    keys: [{ camera: side }, { eye: [-9, -9, 6], target: [0, 0, 0] }, { eye: [0, 12, 6], target: [0, 0, 0] }]
END
numbers() { find "$1" -name "$2" | wc -l; }

# the path's seconds say how many pictures, and its first and last key are the first and last picture
run render lamp.yaml --animate --fps 10 --samples 2 -o way-%03d.png
test "$status" = 0 && test "$(numbers . 'way-*.png')" = 11; result $? "pictures for the path's seconds" "$status"
run render lamp.yaml --camera side --frames 2 -o still.png
test "$(meta way-001.png camera-eye)" = "$(meta still.png camera-eye)" &&
    test "$(meta way-011.png camera-eye)" = "$(meta still.png camera-eye)"
result $? "from the first key to the last" "$(meta way-011.png camera-eye)"
test "$(meta way-006.png camera-eye)" = "0 -12 5"
result $? "through the key between them" "$(meta way-006.png camera-eye)"
test "$(meta way-001.png frames)" = 2; result $? "frames of each picture are told"
for i in 001 006 011; do meta way-$i.png ev100; done | sort -u >exposures
test "$(wc -l <exposures)" = 1; result $? "one exposure for all pictures" "$(tr '\n' ' ' <exposures)"

# a loop does not show its first picture twice
run render lamp.yaml --animate --path round --duration 1 --fps 4 --samples 1 -o round-%d.png
test "$(numbers . 'round-*.png')" = 4; result $? "a loop's pictures"

# interrupted anywhere, with and without reuse of samples: the same pictures
for way in "" "--preset interactive --segment 4" "--segment 3"; do
    rm -rf whole part && mkdir whole part
    # shellcheck disable=SC2086 # options, or none
    run render lamp.yaml --animate --frames 9 --samples 2 $way -o whole/%02d.png
    cp whole/02.png whole/06.png whole/09.png part
    # shellcheck disable=SC2086
    run render lamp.yaml --animate --frames 9 --samples 2 $way -o part/%02d.png
    for f in whole/*; do cmp -s "$f" "part/${f#whole/}" || echo "$f"; done >why
    grep -q '9 pictures, 3 of them were there' out && test "$(numbers part '*.png')" = 9 && test ! -s why
    result $? "goes on as if it had not stopped: ${way:-default}" "$(cat why)"
done
env --default-signal=INT "$program" render builtin:city --city-size 150 --size 64x36 --exposure 3 \
    --animate --frames 1000 --samples 1 -v -o long-%d.exr >out 2>err </dev/null &
pid=$!
until grep -q 'long-2.exr' err || ! kill -0 $pid; do sleep 0.1; done
kill -INT $pid
wait $pid
test $? = 130 && grep -Eq 'interrupted: [0-9]+ of 1000 pictures are there' err; result $? "Ctrl-C says how far it came"
said=$(sed -n 's/.*interrupted: \([0-9]*\) of.*/\1/p' err)
test "$(numbers . 'long-*.exr')" = "$said" && test -z "$(find . -name '.long*')"
result $? "and leaves whole pictures alone" "$said"
run render lamp.yaml --animate --frames 9 --samples 2 --segment 3 -o part/%02d.png
test "$status" = 0 && grep -q '9 of them were there' out; result $? "nothing is left to do"

# what is of something else is not touched
before=$(cksum <part/05.png)
expect "other options are noticed" 1 'part/01.png is there, and is of other options' \
    render lamp.yaml --animate --frames 9 --samples 3 --segment 3 -o part/%02d.png
expect "so is another path" 1 'is of other options, another path' \
    render lamp.yaml --animate --frames 9 --samples 2 --segment 3 --path orbit -o part/%02d.png
cp still.png part/05.png
expect "and a picture of another kind" 1 'part/05.png is there, and is no picture of an animation' \
    render lamp.yaml --animate --frames 9 --samples 2 --segment 3 -o part/%02d.png
run render lamp.yaml --animate --frames 9 --samples 2 --segment 3 --overwrite -o part/%02d.png
test "$status" = 0 && test "$(cksum <part/05.png)" = "$before"; result $? "--overwrite replaces it"

expect "a name without a number" 2 'names one picture; frame-%04d.png names one' render lamp.yaml --animate -o a.png
for name in 'a%s.png' 'a%4d.png' 'a%d%d.png' 'a%d-100%.png' 'a%0000000004d.png' 'a%00d.png' '%d/a.png' 'a%ld.png'; do
    expect "$name" 2 "one %d, or %0Nd" render lamp.yaml --animate -o "$name"
done
expect "a format that is not written" 2 'must end in .png or .exr' render lamp.yaml --animate -o a%d.jpg
expect "a path that is not there" 2 'no path "wya"; is it way\?' render lamp.yaml --animate --path wya -o a%d.png
expect "a path without a recipe" 2 'no path "fly"; paths besides orbit and pan are of recipes' \
    render lamp.obj --animate --path fly -o a%d.png
expect "options of an animation alone" 2 'fps is for --animate' render lamp.yaml --fps 25 -o a.png
expect "a time limit" 2 'exclude each other' render lamp.yaml --animate --time 5 -o a%d.png
finish
