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
for way in "--smooth --segment 4" "" "--method restir --no-spatial --segment 4" "--segment 3"; do
    rm -rf whole part && mkdir whole part
    # shellcheck disable=SC2086 # options, or none
    run render lamp.yaml --animate --frames 9 --samples 2 $way -o whole/%02d.png
    cp whole/02.png whole/06.png whole/09.png part
    # shellcheck disable=SC2086
    run render lamp.yaml --animate --frames 9 --samples 2 $way -o part/%02d.png
    for f in whole/*; do cmp -s "$f" "part/${f#whole/}" || echo "$f"; done >why
    grep -q '9 pictures, 3 of them were there' out && test "$(numbers part '*.png')" = 9 && test ! -s why
    result $? "goes on as if it had not stopped: ${way:-default}" "$(cat why)"
    test -e smooth.png || cp whole/05.png smooth.png
done
test "$(meta smooth.png smoothed)" = "for display" && test -z "$(meta whole/05.png smoothed)"
result $? "smoothed pictures say so, and no others do"
start render builtin:city --city-size 150 --size 64x36 --exposure 3 --animate --frames 100000 --samples 1 -v \
    -o long-%d.exr
until grep -qs 'long-2.exr' err || ! kill -0 $pid; do sleep 0.1; done
kill -INT $pid
wait $pid
test $? = 130 && grep -Eq 'interrupted: [0-9]+ of 100000 pictures are there' err
result $? "Ctrl-C says how far it came"
said=$(sed -n 's/.*interrupted: \([0-9]*\) of.*/\1/p' err)
test "$(numbers . 'long-*.exr')" = "$said" && test -z "$(find . -name '.long*')"
result $? "and leaves whole pictures alone" "$said"
run render lamp.yaml --animate --frames 9 --samples 2 --segment 3 -o part/%02d.png
test "$status" = 0 && grep -q '9 of them were there' out; result $? "nothing is left to do"

# a film, by a program that takes pictures and tells what it was asked for
mkdir bin
cat >bin/ffmpeg <<'END'
#!/bin/sh
for last; do :; done
{ cat; printf '%s\n' "$@"; } >"${last#file:}"
END
chmod +x bin/ffmpeg
path=$PATH
film() { PATH=$PWD/bin:$path run render lamp.yaml --animate --frames 3 --samples 1 --fps 12.5 "$@"; }
name='-a "$(touch b)"; 100%.mp4'
mkdir there
film -o "there/$name"
test "$status" = 0 && grep -aq '^comment=Nocturne animation [0-9a-f]*/3$' "there/$name" && test ! -e b &&
    test "$(ls -A there)" = "$name" && grep -aq '^12.5$' "there/$name"
result $? "a film alone, of any name" "$(ls -A there)"
test "$(tr -cd '\211' <"there/$name" | wc -c)" -ge 3 && test "$(grep -ac IEND "there/$name")" = 3
result $? "of all pictures"
before=$(cksum <"there/$name")
film -o "there/$name"
grep -q 'was there' out && test "$(cksum <"there/$name")" = "$before"; result $? "it is not made twice"
chmod 600 "there/$name"
film --seed 3 -o "there/$name"
test "$(cksum <"there/$name")" != "$before" && test "$(stat -c %a "there/$name")" = 600
result $? "but anew with other options, and keeps its mode"
film -o there/x-%02d.png
test -e there/x.mp4 && test "$(numbers there 'x-*.png')" = 3; result $? "a film beside pictures"
film --no-mp4 -o there/y-%02d.png
test "$status" = 0 && test ! -e there/y.mp4; result $? "no film on request"
echo mine >there/z.mp4
film -o there/z-%02d.png
test "$status" = 0 && test "$(cat there/z.mp4)" = mine && grep -q 'no film of an animation: it is left alone' err
result $? "a file that is something else stays"
film --mp4 -o there/z-%02d.png
grep -aq 'Nocturne animation' there/z.mp4; result $? "unless it is asked for"
echo kept >elsewhere && ln -s ../elsewhere there/l.mp4
film -o there/l.mp4
test "$status" = 0 && test -L there/l.mp4 && grep -aq IEND elsewhere
result $? "a film behind a link" "$(cat err)"
rm there/l.mp4 elsewhere
printf '#!/bin/sh\necho one >&2\necho no such codec >&2\nexit 3\n' >bin/ffmpeg
film -o there/f.mp4
test "$status" = 1 && grep -q 'there/f.mp4: ffmpeg made no film of the pictures, which are there: no such codec' err &&
    test "$(wc -l <err)" = 1 && test ! -e there/f.mp4 && test "$(numbers there/f-frames '*.png')" = 3
result $? "a film that fails is one error, and leaves the pictures" "$(cat err)"
test -z "$(find there -name '.*.part')"; result $? "and nothing else"

# what stands in the film's way is no way to another file; and Ctrl-C ends it, whether it reads or not
echo kept >elsewhere
printf '#!/bin/sh\nfor last; do :; done\ncat >"${last#file:}"\n' >bin/ffmpeg
in_its_way() { # a command that takes the place of a run's unfinished film, and the film
    # the run is the shell, so that its number is known
    (export PATH="$PWD/bin:$path" && exec sh -c "$1"' "there/.$2.$(uname -n)-$$.part" && shift 2 && exec "$@"' \
        sh "$1" "$2" \
        "$program" render lamp.yaml --animate --frames 3 --samples 1 --fps 12.5 -o "there/$2") >out 2>err </dev/null
    status=$?
}
in_its_way 'ln -s ../elsewhere' f.mp4
test "$status" = 0 && test "$(cat elsewhere)" = kept && test ! -L there/f.mp4 && grep -aq IEND there/f.mp4
result $? "a link of the unfinished film's name is not followed" "$(cat err)"
in_its_way mkdir k.mp4
test "$status" = 1 && grep -Eq 'there/.k.mp4.[^/]*-[0-9]+.part: cannot be written' err && rmdir there/.k.mp4.*.part
result $? "nor is a folder" "$(cat err)"
mkdir there/d.mp4
film -o there/d-%d.png
test "$status" = 0 && test "$(numbers there 'd-*.png')" = 3 && test -z "$(ls -A there/d.mp4)" &&
    grep -q 'd.mp4 is there, and is no film of an animation: it is left alone$' err
result $? "a folder in the place of a film that nobody asked for stays" "$(cat err)"
expect "and is in the way of one that somebody did" 1 'there/d.mp4 is a folder' \
    render lamp.yaml --animate --frames 3 --samples 1 --mp4 -o there/d-%d.png
rm -r there/d.mp4 there/d-*
printf '#!/bin/sh\ntouch started\nsleep 1000\n' >bin/ffmpeg
interrupted_film() {
    rm -f started
    PATH=$PWD/bin:$path start render lamp.yaml --animate --frames 3 --samples 1 -o there/s-%d.png --mp4
    tries=0
    until test -e started || test $tries -gt 3000; do sleep 0.1; tries=$((tries + 1)); done
    kill -INT $pid
    tries=0
    while kill -0 $pid 2>/dev/null && test $tries -lt 3000; do sleep 0.1; tries=$((tries + 1)); done
    kill -KILL $pid 2>/dev/null
    wait $pid
    status=$?
}
interrupted_film
test "$status" = 130 && test -z "$(find there -name '.*.part')"; result $? "one Ctrl-C ends a film that hangs" "$status"
head -c 300000 /dev/zero >>there/s-1.png # more than a pipe holds
interrupted_film
test "$status" = 130 && test -z "$(find there -name '.*.part')"; result $? "and one that takes no pictures" "$status"
rm -r there/s-* started
without() { (PATH=/nowhere && export PATH && exec "$program" "$@") >out 2>err </dev/null; status=$?; }
without render lamp.yaml --animate --frames 3 --samples 1 -o there/g-%d.png
test "$status" = 0 && grep -q 'film      none: the program ffmpeg is not on PATH' out
result $? "without ffmpeg: pictures"
without render lamp.yaml --animate --frames 3 -o there/h.mp4
test "$status" = 1 && grep -q 'made by the program ffmpeg, which is not on PATH' err && test ! -e there/h-frames
result $? "without ffmpeg: no film alone, and that is known before"
expect "a film of linear pictures" 2 'linear pictures' render lamp.yaml --animate --mp4 -o a%d.exr
expect "a film and none" 2 'is a film' render lamp.yaml --animate --no-mp4 -o a.mp4
if command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null; then
    run render lamp.yaml --animate --frames 5 --size 31x17 --samples 1 --fps 25 -o there/real.mp4
    ffprobe -v error -count_frames -show_entries stream=nb_read_frames,width,height,r_frame_rate -of csv=p=0 \
        there/real.mp4 >real
    test "$(cat real)" = "32,18,25/1,5"; result $? "a film by ffmpeg itself" "$(cat real)"
else
    skip "a film by ffmpeg itself" "ffmpeg and ffprobe are not here"
fi

# the scene moves with the pictures: a car of 10 m/s, and windows by the hour
cp "$source_dir/tests/cli/city.gml" .
cat >track.gpx <<'END'
<?xml version='1.0'?><gpx version='1.1' xmlns='http://www.topografix.com/GPX/1/1'><trk><trkseg>
<trkpt lat='48.75448' lon='11.42168'><time>2026-11-22T22:00:00Z</time></trkpt>
<trkpt lat='48.75447' lon='11.42222'><time>2026-11-22T22:00:04Z</time></trkpt></trkseg></trk></gpx>
END
cat >town.yaml <<'END'
nocturne: 1
inputs: [city.gml, track.gpx]
width: 48
height: 27
paths:
  stand: { keys: [{ eye: [5, -35, 408], target: [5, -10, 401] }] }
  night:
    keys:
      - { eye: [5, -12, 404], target: [5, 0, 403], hour: 21 }
      - { eye: [5, -12, 404], target: [5, 0, 403], hour: 4, seconds: 2 }
END
pictures="--animate --frames 6 --fps 2 --samples 2 --method restir --no-spatial --segment 4 --no-mp4"
mkdir cars cars-part
# shellcheck disable=SC2086 # options
run render town.yaml $pictures -o cars/%d.png
cp cars/2.png cars/6.png cars-part
# shellcheck disable=SC2086
run render town.yaml $pictures -o cars-part/%d.png
for f in cars/*; do cmp -s "$f" "cars-part/${f#cars/}" || echo "$f"; done >why
test "$(numbers cars-part '*.png')" = 6 && test ! -s why; result $? "goes on where a car moves" "$(cat why)"
classes="--show class --no-jitter --samples 1 --fps 2 --frames 3"
# shellcheck disable=SC2086
run render town.yaml --animate $classes -o class-%d.png
run render town.yaml --show class --no-jitter --eye 5,-35,408 --target 5,-10,401 --traffic-time 1 --frames 1 -o car.png
test "$(meta class-3.png pixels)" = "$(meta car.png pixels)" &&
    test "$(meta class-1.png pixels)" != "$(meta car.png pixels)"
result $? "a car is where the picture's time has it"
dark="--samples 8 --no-traffic --no-infer-lamps --sky 0 --window-lit 1"
# shellcheck disable=SC2086
run render town.yaml --animate --path night --fps 1 $dark -o hour-%d.exr
run render town.yaml --no-traffic --no-infer-lamps --sky 0 --window-lit 1 --eye 5,-12,404 --target 5,0,403 --hour 4 \
    --frames 8 -o 4.exr
for i in 1 3; do
    run compare hour-$i.exr 4.exr
    awk '/see no emitter/ { print $NF }' out
done >bias
awk 'NR == 1 { first = $1 } NR == 2 { last = $1 } END { exit !(first > 3 && last > 0.98 && last < 1.02) }' bias
result $? "windows are lit by the hour of the path" "$(tr '\n' ' ' <bias)"

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
mkdir 'of%d'
run render lamp.yaml --animate --frames 2 --samples 1 --no-mp4 -o 'of%d/a-%d.png'
test "$(ls 'of%d')" = "a-1.png
a-2.png"; result $? "a folder's name may hold a %"
expect "a format that is not written" 2 'must end in .png or .exr' render lamp.yaml --animate -o a%d.jpg
expect "a path that is not there" 2 'no path "wya"; is it way\?' render lamp.yaml --animate --path wya -o a%d.png
expect "a path without a recipe" 2 'no path "fly"; paths besides orbit and pan are of recipes' \
    render lamp.obj --animate --path fly -o a%d.png
expect "options of an animation alone" 2 'fps is for --animate' render lamp.yaml --fps 25 -o a.png
expect "a time limit" 2 'exclude each other' render lamp.yaml --animate --time 5 -o a%d.png
finish
