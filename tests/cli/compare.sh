#!/bin/sh
# Error figures of pictures that the program made itself.
. "$(dirname "$0")/lib.sh"
small='builtin:city --city-size 150 --size 64x36'
"$program" render $small -q --method reference --frames 4 -o reference.exr || exit 1
"$program" render $small -q --method is --frames 1 -o is.exr || exit 1
"$program" render $small -q --method is --frames 1 -o is.png || exit 1
"$program" render $small -q --size 32x36 --frames 1 -o narrow.exr || exit 1

run compare reference.exr reference.exr
test $status = 0 && grep -Eq '^  all pixels +2,304 +0\.000 +0 +0 +1\.0000$' out && grep -q 'no emitter' out &&
    test ! -s err
result $? "a picture is equal to itself"
run compare is.exr reference.exr --ceiling 2 -o difference.png
test $status = 0 && grep -q 'clamped to 2 cd/m2' out && meta difference.png size >/dev/null
result $? "a noisy one is not, and there is a difference picture"
awk '/^  all pixels/ { found = $4 > 1 && $5 > 0 && $6 > 0 } END { exit !found }' out
result $? "its figures are not zero"
grep -q '^  difference picture: difference.png$' out; result $? "and the difference picture is told"
run compare -q is.exr reference.exr -o difference.png
test $status = 0 && grep -q '^  all pixels' out && ! grep -q difference out && test ! -s err
result $? "quiet keeps the figures, which are the result"
run compare is.exr reference.exr --json -o difference.png
grep -q '"no_emitter_clamped": {"pixels": [0-9]' out; result $? "figures as JSON"
python3 -c 'import json; assert json.load(open("out"))["difference"] == "difference.png"'
result $? "with the name of the difference picture"
"$program" render $small -q --sky 0 --method is --frames 1 -o weak.exr &&
    "$program" render $small -q --sky 0 --frames 2 -o strong.exr
run compare strong.exr weak.exr
cp out table
run compare --json strong.exr weak.exr
python3 -c '
import json, re
all = json.load(open("out"))["all"]
pixels, share = re.search(r"^  ([\d,]+) pixels lit in the picture and 0 in the reference: ([\d.]+) % of relMSE$",
                          open("table").read(), re.M).groups()
assert int(pixels.replace(",",
                          "")) == all["unlit"] > 9 and share == "%.3g" % (100 * all["relmse_unlit"] / all["relmse"])'
result $? "pixels that the reference leaves black are told" "$(cat table)"
# one_picture NAME FILE REFERENCE: of one luminance to a thousandth, and of the same colours as far as halves hold them
one_picture() {
    run compare --json "$2" "$3"
    python3 -c '
import json
all = json.load(open("out"))["all"]
assert abs(all["bias"] - 1) < 5e-4 and all["relmse"] < 1e-6 and all["rmse8"] < .5'
    result $? "$1" "$(cat err)"
}
if command -v exr2aces >/dev/null && command -v exrstdattr >/dev/null; then
    exr2aces reference.exr aces.exr && one_picture "a picture that OpenEXR turned to ACES" aces.exr reference.exr
    # ACEScg whose neutral is another than its white: what its pixels are then is OpenEXR's to say
    exrstdattr -chromaticities .713 .293 .165 .83 .128 .044 .32168 .33767 -adoptedNeutral .3457 .3585 \
        reference.exr cg.exr &&
        exr2aces cg.exr aces.exr && one_picture "and one of another space and neutral" aces.exr cg.exr
    run compare --json cg.exr reference.exr
    python3 -c 'import json; assert json.load(open("out"))["all"]["bias"] > 1.02'
    result $? "the same numbers in another space are another picture"
else
    skip "a picture that OpenEXR turned to ACES" "no exr2aces"
fi
run compare is.png is.png
test $status = 0 && grep -q 'of white$' out && ! grep -q 'cd/m2' out && test ! -s err
result $? "PNG against PNG speaks of white, not cd/m2"
run compare is.png is.png --json
grep -q '"unit": "white"' out && ! grep -q ceiling out && python3 -m json.tool out >/dev/null
result $? "and so does its JSON"
expect "PNG against EXR" 1 'is.png: it is displayed .PNG., the other is linear' compare is.png reference.exr -o d.png
expect "EXR against PNG" 1 'is.png: it is displayed' compare reference.exr is.png
for view in class depth normal; do
    "$program" render $small -q --frames 1 --show $view -o $view.exr &&
        "$program" render $small -q --frames 1 --show $view -o $view.png
    expect "numbers of a view, $view" 1 "$view.exr: it holds the view \"$view\"" compare $view.exr $view.exr -o d.png
    expect "colours of a view, $view" 1 "$view.png: it holds the view \"$view\"" compare $view.png $view.png
done
for end in exr png; do
    "$program" render $small -q --frames 2 --smooth -o smooth.$end && cp smooth.$end rough.$end &&
        "$program" render $small -q --frames 2 -o rough.$end
    expect "a smoothed picture, $end" 1 'picture is smoothed: it is for display' compare smooth.$end rough.$end -o d.png
    expect "a smoothed reference, $end" 1 'reference is smoothed' compare rough.$end smooth.$end
done
expect "a smoothed view" 2 'exclude each other' render $small --smooth --show depth -o d.png
expect "a view as the reference" 1 'depth.exr: it holds the view' compare reference.exr depth.exr
"$program" render $small -q --method is --frames 1 --exposure 4 -o four.png
"$program" render $small -q --method is --frames 1 --exposure 5 -o five.png
"$program" render $small -q --method is --frames 2 --exposure 5 -o fifth.png
run compare four.png five.png
test $status = 0 && grep -q 'exposures differ, EV100 4.00 and 5.00' err; result $? "PNG of two exposures are warned of"
run compare five.png fifth.png
test $status = 0 && test ! -s err; result $? "those of one are not"
run compare -q four.png five.png
test $status = 0 && grep -q 'all pixels' out && test ! -s err; result $? "nor is anything with -q"
expect "pictures of different sizes" 1 '(64.*36|32.*36)' compare narrow.exr reference.exr -o d.png
expect "a missing picture" 1 'missing.exr' compare missing.exr reference.exr
expect "a folder" 1 'nocturne: ' compare . reference.exr
head -c 500 reference.exr >cut.exr
expect "a picture cut short" 1 'cut.exr' compare cut.exr reference.exr
expect "no picture at all" 1 'lib.sh' compare "$source_dir/tests/cli/lib.sh" reference.exr
test ! -e d.png; result $? "nothing is written after an error"
finish
