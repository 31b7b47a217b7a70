#!/bin/sh
# Pictures of a small built-in city: what is written, what is said, and that it can be made again.
. "$(dirname "$0")/lib.sh"
small='builtin:city --city-size 150 --size 64x36 --frames 2'

run render $small -o a.png
test $status = 0 && test ! -s err; result $? "renders the built-in city"
test "$(meta a.png size)" = "64 36"; result $? "the picture has the size asked for"
run render $small --isa baseline -o a.png
grep -q "a frame (baseline x4)" out; result $? "a forced instruction set runs, and is told of"
run render $small -o a.png
grep -q '^a.png$' out && grep -Eq '[0-9] triangles, [0-9,]+ lights' out && grep -q '2 frames of ris' out &&
    grep -q 'a frame' out &&
    grep -q 'memory .*B at most' out
result $? "the summary tells path, size, frames, triangles, lights, times, memory"
test "$(ls)" = "a.png
err
out"; result $? "nothing else is left behind" "$(ls | tr '\n' ' ')"

run render $small -o b.png
cmp -s a.png b.png; result $? "the same arguments, the same file"
run render $small --threads 1 -o b.png && run render $small --threads 3 -o c.png
cmp -s b.png c.png && cmp -s a.png b.png; result $? "any number of threads, the same file"
run render $small --seed 2 -o b.png
test $status = 0 && ! cmp -s a.png b.png; result $? "another seed, another picture"
run render $small --city-seed 9 -o b.png
test $status = 0 && ! cmp -s a.png b.png; result $? "another city, another picture"

run render $small --view street -o c.png
eye=$(meta a.png camera-eye | tr ' ' ,) target=$(meta a.png camera-target | tr ' ' ,) fov=$(meta a.png camera-fov)
run render $small --eye "$eye" --target "$target" --fov "$fov" -o b.png
meta a.png | grep -v '^view: own$' >a.meta
test -n "$eye" && meta b.png | cmp -s a.meta && "$program" compare b.png a.png |
    grep -Eq '^  all pixels +2,304 +0\.000 +0 +0 '
result $? "the camera in the metadata gives the same picture" "$eye $target $fov"
test "$(meta a.png method)" = ris && test "$(meta a.png seed)" = 1 && test "$(meta a.png frames)" = 2 &&
    test "$(meta a.png city-size)" = 150 &&
    meta a.png Software | grep -q '^Nocturne ' && test -n "$(meta a.png ev100)"
result $? "the options are in the metadata"
test "$(meta a.png view) $(meta c.png view)" = "own street" && test -z "$(meta b.png view)" &&
    test -z "$(meta a.png lights)$(meta a.png scene-seed)" &&
    grep -q "$(meta a.png scene-triangles | sed -E 's/([0-9]{3})$/,\1/') triangles, $(meta a.png scene-lights) light" \
    out
result $? "and the view, the scene's counts, and no option of other scenes"
run render "$source_dir/tests/cli/city.gml" --size 32x18 --frames 1 -o b.png
test $status = 0 && ! meta b.png | grep -E '^(lights|city-size|city-seed|scene-seed|auto-ev100):' &&
    meta b.png |
    grep -q '^tonemap: '
result $? "a real city's picture has no option of built-in scenes"

# a photograph of 400 x 300 pixels from 0,-100,50 towards 0,0,10, by a lens of 50 degrees
python3 -c '
import math
t = math.tan(math.radians(25))
d = math.hypot(100, 40)
print("# of a hand\n400,300\npx,py,x,y,z")
for x, y, z in (-30, -10, 0), (28, -5, 2), (-20, 30, 25), (25, 35, 20), (0, 10, 5), (10, -20, 12):
    along = ((y + 100) * 100 - (z - 50) * 40) / d
    up = ((y + 100) * 40 + (z - 50) * 100) / d
    print("%.9g,%.9g,%g,%g,%g" % (200 + 150 * x / along / t, 150 - 150 * up / along / t, x, y, z))' >photo.csv
run render $small --method headlight --photo-points photo.csv -o p.png
test $status = 0 && grep -q 'photograph: 6 points, 0.0 of its pixels off' err && meta p.png | python3 -c '
import sys
meta = dict(line.rstrip("\n").split(": ", 1) for line in sys.stdin if ": " in line)
eye = [float(x) for x in meta["camera-eye"].split()]
assert max(abs(a - b) for a, b in zip(eye, (0, -100, 50))) < 0.01, eye
assert abs(float(meta["camera-fov"]) - 50) < 0.01 and meta["method"] == "headlight", meta'
result $? "the camera of a photograph by its points" "$(cat err)"
run render $small --method headlight -o p.png
test $status = 0 && ! grep -q warning err; result $? "no warning of lamps to the headlight" "$(cat err)"
echo 1,2,3 >>photo.csv
run render $small --photo-points photo.csv -o q.png
test $status = 1 && grep -q 'photo.csv:10: a row is px,py,x,y,z' err
result $? "a row that is none is told" "$(cat err)"
mkfifo pipe
run render $small --photo-points pipe -o q.png
test $status = 1 && grep -q 'pipe: it cannot be opened: not a regular file' err
result $? "nobody is waited for who would write a pipe" "$(cat err)"
run render $small --photo-points photo.csv --eye 1,2,3 --target 0,0,0 -o q.png
test $status = 2 && grep -q 'exclude each other' err; result $? "a photograph and an eye are two cameras"
rm photo.csv p.png pipe

run render $small -o a.exr
test $status = 0 && grep -aq 'cd/m2' a.exr && grep -aq 'camera-eye' a.exr && grep -aq 'scene-origin' a.exr &&
    grep -aq 'candidates' a.exr
result $? "EXR with units, camera and options"
auto=$(sed -n 's/.*automatic exposure would be \([-0-9.]*\) EV100$/\1/p' out)
python3 -c '
import re, sys
kept = re.search(rb"auto-ev100\0string\0....([-0-9.]+)", open("a.exr", "rb").read(), re.S)
assert abs(float(kept.group(1)) - float(sys.argv[1])) < 0.006, (kept, sys.argv)' "$auto"
result $? "and the automatic exposure that is told"
run render builtin:mess --lights 9 --size 16x16 --frames 1 --sky sqm:19.25 -o sky.exr
grep -q '^  sky  *0.002155 cd/m2 at the zenith, 19.25 mag/arcsec2$' out && tr '\0' '\n' <sky.exr | grep -aq sky-sqm &&
    grep -aq '19\.25' sky.exr
result $? "the sky's brightness as it is measured is told" "$(cat out)"
rm sky.exr
run render $small -q -o b.PNG
test $status = 0 && test ! -s out && test ! -s err && cmp -s a.png b.PNG
result $? "quiet says nothing; endings in capitals count"

run render $small --preset interactive -o b.png
test "$(meta b.png shadow-rays) $(meta b.png list) $(meta b.png tail)" = "8 32 64" &&
    test "$(meta b.png method)" = ris; result $? "a preset is its settings"
run render $small --tail 99 --preset interactive --shadow-rays 7 -o b.png
test "$(meta b.png shadow-rays) $(meta b.png list) $(meta b.png tail)" = "7 32 99"
result $? "options beside a preset win"

# What is given and changes nothing: one line each; nothing where it counts, and nothing of what a preset sets.
run render $small --method is --shadow-rays 4 --no-temporal --frames 1 -o b.png
test $status = 0 && test "$(cat err)" = \
    "nocturne: warning: --shadow-rays has no effect: it needs method ris|restir, not is
nocturne: warning: --no-temporal has no effect: it needs method restir, not is"
result $? "options without effect are warned of"
run render $small --environment-lux 3 --no-environment-light --frames 1 -o b.png
test $status = 0 && test "$(grep -c 'has no effect: there is no map around the city (--environment FILE)' err)" = 2
result $? "nor have options of a map that is not there"
run render $small --candidates influence --preset interactive --uniform-every 2 --draws 3 --frames 1 -o b.png
test $status = 0 && test ! -s err
result $? "and those that have one are not"
run render $small --exposure 4 --compensation 2 -o b.png && cp err told && run render $small --exposure 4 -o c.png
test "$(meta b.png ev100)" = "$(meta c.png ev100)" && grep -q 'warning: --compensation has no effect' told &&
    test ! -s err
result $? "compensation is of the automatic exposure"
run render $small --method is --shadow-rays 4 -q --frames 1 -o b.png
test $status = 0 && test ! -s err; result $? "nor in silence"

for view in street aerial overview; do
    run render $small --view $view -o $view.png
    test $status = 0; result $? "view $view"
done
! cmp -s street.png aerial.png && ! cmp -s aerial.png overview.png; result $? "the views differ"
for method in reference is restir; do
    run render $small --method $method -o b.png
    test $status = 0 && ! cmp -s a.png b.png; result $? "method $method"
done
run render $small --method restir -o r.png
for switch in --no-temporal --no-spatial --no-bias-rays --no-visibility-reuse --neighbours=2 --bias=mis; do
    run render $small --method restir $switch -o b.png
    test $status = 0 && ! cmp -s r.png b.png; result $? "restir: $switch changes the picture"
done
for switch in --no-learn --shadow-rays=2 --no-final-ray --no-jitter --no-accumulate --no-emitters \
    --sky=0 --exposure=3 --compensation=1 --tonemap=linear --candidates=uniform --list=3 --tail=3 --window-lit=1 \
    --fov=80; do
    run render $small $switch -o b.png
    test $status = 0 && ! cmp -s a.png b.png; result $? "$switch changes the picture"
done
# Later settings win, so that scripts can add to a command.
run render $small --seed 2 --seed 1 -o b.png
cmp -s a.png b.png; result $? "the last of two settings wins"
run render $small --no-jitter --jitter -o b.png
cmp -s a.png b.png; result $? "a switch can be switched back"

run render builtin:city --city-size 150 --size 32x18 --time 0.3 -o b.png
test $status = 0 && test "$(meta b.png frames)" -ge 1; result $? "--time ends by itself"
run render $small --stats -o b.png
test $status = 0 && grep -q 'trace floor' out && grep -q 'primary' out; result $? "--stats prints the passes"
run render $small -v -o b.png
test $status = 0 && grep -q 'frame 2: ' err; result $? "--verbose tells of every frame"
if command -v script >/dev/null 2>&1; then
    TERM=vt100 script -qec "'$program' render $small --frames 500 -o b.png" /dev/null </dev/null >out 2>err
    status=$?
    test $status = 0 && grep -q 'frame [0-9]* of 500' out; result $? "a terminal gets a progress line"
    tr '\r' '\n' <out | tail -n 1 | grep -q 'frame' && false || true
    result $? "which is erased at the end"
else
    skip "a terminal gets a progress line" "no script(1) here"
fi

# Views of the light sampling in the picture's place.
for v in lights density light weight confidence rays variance error; do
    run render $small --candidates influence --show $v -o $v.png
    test $status = 0 && test "$(meta $v.png show)" = $v && grep -Eq "^  view      $v: (median|[0-9,]+ different)" out &&
        ! cmp -s a.png $v.png
    result $? "--show $v"
done
test "$(meta lights.png size)" = "260 81"; result $? "a view has a legend below"
run render $small --candidates influence --show lights -o lights.exr
test $status = 0 && grep -aq units lights.exr && grep -aq 'candidates' lights.exr && ! grep -aq cd/m2 lights.exr
result $? "EXR takes a view's numbers and their unit"
run render $small --candidates influence --show lights --show-range 0,7 -o b.png
test $status = 0 && ! cmp -s lights.png b.png; result $? "--show-range sets the colour bar"
run render $small --show illuminance --show-range 1,100 -o lux.png
run render $small --show illuminance --show-range 1,100 --isolines 2,5,20 -o b.png
test $status = 0 && ! cmp -s lux.png b.png; result $? "--isolines draws lines"
run render $small --show illuminance --show-range 1,100 --show-scale linear -o b.png
test $status = 0 && ! cmp -s lux.png b.png; result $? "--show-scale sets the bar"
run render $small --show influential -o who.png
test $status = 0 && grep -Eq '^ +[0-9]+ [a-z]+ [0-9]+ [0-9.]+%' out &&
    meta who.png labels | grep -Eq '^[0-9]+ [a-z]+ [0-9]+ #'
result $? "--show influential names lights"
run render $small --show picture -o b.png
test $status = 0 && cmp -s a.png b.png && test -z "$(meta a.png show)"; result $? "--show picture is the picture"

# What labels mean is in the legend, the metadata and the summary.
run render $small --show class -o class.png
cp out told
grep -q '^  picture   64 x 36, 2 frames of ris, the view class in colours, with a legend$' out && ! grep -q EV100 out &&
    ! meta class.png | grep -q tonemap
result $? "a view has no exposure"
run render $small --show depth -o depth.exr
grep -q 'frames of ris, the view depth as numbers of unit m$' out && ! grep -Eq '^  picture.*(EV100|cd/m2)' out
result $? "nor have its numbers"
run render $small --show class -o class.exr
grep -q 'frames of ris, the view class as numbers that stand for names$' out &&
    ! grep -Eq '^  picture.*(EV100|cd/m2)' out
result $? "nor have those that are names"
python3 - "$(meta class.png labels)" "$(meta class.png size)" <<'CHECK'
import re, sys
labels = re.findall(r"(\d+) (\w+) (#[0-9a-f]{6})(?:, |$)", sys.argv[1])
assert len(labels) == 18 and len({c for n, name, c in labels}) == 18 and ("9",
                                                                          "road") in {l[:2]
                                                                                      for l in labels}, sys.argv[1]
rgb = {name: [int(c[i:i + 2], 16) for i in (1, 3, 5)] for n, name, c in labels}
rgb["none"] = [92, 92, 96]
for a in rgb:
    assert all(a == b or sum((x - y) ** 2 for x, y in zip(rgb[a], rgb[b])) >= 45 ** 2 for b in rgb), a
most = lambda name: max(range(3), key=lambda k: rgb[name][k])
assert all(len(set(rgb[name])) == 1 for name in ("road",
                                                 "sidewalk")) and most(
                                                     "green") == most("tree") == 1 and most("water") == 2, rgb
assert rgb["terrain"][0] > rgb["terrain"][1] > rgb["terrain"][2] and most("roof") == 0, rgb
told = re.findall(r"(\d+) (\w+) ([\d.]+)%", open("told").read().split("\n  scene")[0].split("pixels\n")[1])
none = float(re.search(r"none in ([\d.]+)%", open("told").read()).group(1))
shares = [float(t[2]) for t in told]
assert len(told) > 5 and shares == sorted(shares, reverse=True) and abs(sum(shares) + none - 100) < 1, (told, none)
assert {t[:2] for t in told} <= {l[:2] for l in labels}, told
assert int(sys.argv[2].split()[1]) > 36 + 13 * len(told) // 4
numbers = ", ".join("%s %s" % l[:2] for l in labels).encode()
assert numbers in open("class.exr", "rb").read()
CHECK
result $? "a view of classes tells their names: in the picture, its metadata, and the summary" \
    "$(meta class.png labels)"
run render "$source_dir/tests/cli/city.gml" --size 64x36 --frames 1 --show object -o object.png
test $status = 0 && grep -Eq '^            .*[0-9]+ house [0-9.]+%' out; result $? "one of objects those that have some"
run render $small --show group -o group.png
cp out told
run render $small --group windows=off --show group -o group.exr
test $status = 0 && meta group.png labels | grep -Eq '^0 others #[0-9a-f]{6}, 1 lamps #[0-9a-f]{6}, 2 windows #' &&
    grep -q '2 windows [0-9.]*%' told && grep -q '1 lamps [0-9.]*%' out && ! grep -q '2 windows' out &&
    grep -aq '0 others, 1 lamps, 2 windows' group.exr
result $? "one of groups of lights their names, and none that is off"

# Influence volumes as OBJ: closed bodies that face outwards; of one-sided lights the half that they face, S_r sqrt(I)
# around their shape.
lamp_model
see="--eye 4,-4,1 --target 0,0,0 --size 32x18 --frames 1 --candidates influence"
cat >look.py <<'LOOK'
import math, sys
vertices, objects, faces = [], {}, None
for line in open(sys.argv[1]):
    word = line.split()
    if word[0] == "o":
        faces = objects.setdefault(word[1], [])
    elif word[0] == "v":
        vertices.append(tuple(map(float, word[1:])))
    elif word[0] == "f":
        faces.append([int(i) - 1 for i in word[1:]])
assert all(math.isfinite(x) for v in vertices for x in v)
def volume(faces):
    edges, total = {}, 0
    for f in faces:
        for a, b in zip(f, f[1:] + f[:1]):
            assert (a, b) not in edges, "an edge twice"
            edges[a, b] = True
        for b, c in zip(f[1:], f[2:]):
            p, q, r = (vertices[i] for i in (f[0], b, c))
            total += (p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) +
                      p[2] * (q[0] * r[1] - q[1] * r[0])) / 6
    assert all((b, a) in edges for a, b in edges), "not closed"
    return total
sizes = {name: volume(faces) for name, faces in objects.items()}
points = lambda name: [vertices[i] for i in sorted({i for f in objects[name] for i in f})]
LOOK
run render lamp.obj $see --influence 3 -o b.png --influence-obj volumes.obj
test $status = 0 && python3 - volumes.obj <<'CHECK'
exec(open("look.py").read())
assert len(objects) == 2, objects.keys() # two triangles, which shine down
corners = [(-.5, -.5), (.5, -.5), (.5, .5), (-.5, .5)]
for name, at in zip(sorted(objects), ((0, 1, 2), (0, 2, 3))):
    there = []
    for at in ((0, 1, 2), (0, 2, 3)):
        c = (sum(corners[i][0] for i in at) / 3, 2, sum(corners[i][1] for i in at) / 3)
        shape = max(math.dist(c, (corners[i][0], 2, corners[i][1])) for i in at)
        radius = 3 * math.sqrt(40 * 0.5) + shape
        there.append(all(abs(math.dist(p, c) / radius - 1) < 1e-3 for p in points(name)))
        if there[-1]:
            assert max(p[1] for p in points(name)) < 2.0011 and sum(abs(p[1] - 2.001) < 1e-4
                                                                    for p in points(name)) == 16, name
            # of half a sphere, its corners on the surface
            assert 0.9 < sizes[name] / (2 / 3 * math.pi * radius ** 3) < 1, sizes
    assert sum(there) == 1, (name, there)
CHECK
result $? "influence volumes as OBJ: half spheres under lights that shine down"
run info volumes.obj
test $status = 0 && ! grep -qi 'skipped' out; result $? "which can be read again"
run render builtin:city --city-size 150 --size 32x18 --frames 1 --candidates influence --influence-boxes visible \
    -o b.png --influence-obj volumes.obj
test $status = 0 && python3 - volumes.obj <<'CHECK'
exec(open("look.py").read())
volumes, boxes = [n for n in objects if n.startswith("volume_")], [n for n in objects if n.startswith("box_")]
assert len(volumes) > 300 and len(boxes) > 20 and all(s > 0 for s in sizes.values()), (len(volumes), len(boxes))
assert {n.split("_in_")[1] for n in volumes} == set(boxes)
assert any(abs(len(points(n)) - (1 + 6 * 16)) == 0 for n in volumes) and any(len(points(n)) == 2 + 11 * 16
                                                                             # one-sided, and all around
                                                                             for n in volumes)
assert all(len(points(n)) == 8 for n in boxes)
CHECK
result $? "and boxes, with the volumes that lie in them"
expect "only where there are volumes" 2 'influence-obj needs --candidates influence' render $small -o b.png \
    --influence-obj volumes.obj
expect "under a name that tells" 2 'volumes.ply must end in .obj' render $small --candidates influence -o b.png \
    --influence-obj volumes.ply
expect "in a folder that is there" 1 'its folder [^ ]* is not there: make it first' render $small \
    --candidates influence -o b.png --influence-obj gone/volumes.obj
finish
