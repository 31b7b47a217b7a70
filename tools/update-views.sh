#!/bin/sh
# Draws the figures of docs/views.md: every view of the built-in city from the street and from the air. Takes the
# program's path; needs ImageMagick.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
program=${1:-$root/build/nocturne}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# figure VIEW OPTION...
figure() {
    name=$1
    shift
    for camera in street aerial; do
        "$program" render builtin:city --size 320x180 --view $camera --show "$name" "$@" -q -o "$work/$camera.png"
    done
    montage "$work/street.png" "$work/aerial.png" -tile 2x1 -geometry +2+0 -background '#18181c' "$work/both.png"
    convert "$work/both.png" -strip -dither None -colors 128 "$root/docs/views/$name.png"
}

figure lights --candidates influence --frames 1 --show-range 0,200
figure density --frames 1 --show-range 0.001,1
figure light --shadow-rays 1 --frames 1
figure weight --method restir --frames 1 --show-range 0.1,10000
figure confidence --method restir --frames 8 --show-range 0,4032
figure rays --method restir --frames 8 --show-range 0,24
figure variance --frames 32 --show-range 0.0001,1000
figure error --frames 32 --show-range 0.01,1
figure group --frames 32
figure influential --frames 32
figure influential-share --frames 32
figure luminance --frames 32
figure illuminance --frames 32 --isolines 1,2,5,10,20

# One picture of a turn, among cars that drive.
for camera in street aerial; do
    "$program" render builtin:city --size 320x180 --view $camera --show motion --animate --path orbit --frames 240 \
        --preset interactive --samples 1 --traffic --no-mp4 -q -o "$work/%03d.png"
    mv "$work/004.png" "$work/$camera.png"
    rm "$work"/[0-9]*.png
done
montage "$work/street.png" "$work/aerial.png" -tile 2x1 -geometry +2+0 -background '#18181c' "$work/both.png"
convert "$work/both.png" -strip -dither None -colors 128 "$root/docs/views/motion.png"
