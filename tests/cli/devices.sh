#!/bin/sh
# --backend and --device, on a machine that has no Vulkan driver, and with that of the tests.
. "$(dirname "$0")/lib.sh"
unset VK_ICD_FILENAMES VK_ADD_DRIVER_FILES
tests_driver=${VK_DRIVER_FILES:-}
export VK_DRIVER_FILES="$work/no-driver.json"
small="builtin:city --city-size 150 --size 32x18 --frames 1"

run devices
test $status = 0 && grep -Eq '^embree 0 processor, .' out && grep -Eq '^vulkan none: .' out
result $? "devices are listed"
expect "devices of a file" 2 'devices takes no files' devices city.gml
LD_DEBUG=files run --version
test $status = 0 && grep -q libnocturne err && ! grep -Eiq 'lib(vulkan|proj|gdal|assimp)[.-]' err
result $? "--version loads neither Vulkan nor what reads files" "$(grep -Ei 'lib(vulkan|proj|gdal|assimp)[.-]' err)"

# refused NAME PATTERN ARGUMENT...: one line, and nothing written
refused() {
    pattern=$2
    expect "$1" 1 "$pattern" "$3" "$4" --backend vulkan -o written
    [ "$(wc -l <err)" = 1 ] && [ ! -s out ] && [ ! -e written ]; result $? "$1: one line, nothing written"
}
echo '{ "scene": { "name": "a", "inputs": ["builtin:single"] }, "cameras": [ { "name": "a" } ],
  "configurations": [ { "name": "a" } ] }' >spec.json
refused "render without a driver" '^nocturne: vulkan: .' render builtin:city
refused "bench without a driver" '^nocturne: vulkan: .' bench builtin:city
refused "experiment without a driver" '^nocturne: vulkan: .' experiment spec.json
sed 's/"scene"/"size": "16x9", "frames": 1, "repetitions": 1, "backend": "vulkan", "scene"/' spec.json >named.json
expect "a spec names the backend" 1 '^nocturne: vulkan: .' experiment named.json -o written
run experiment named.json --cache cache -o by-embree --backend embree
test $status = 0 && grep -q ',embree,' by-embree/results.csv; result $? "and the command overrules it"
sed 's/"vulkan"/"cuda"/' named.json >wrong.json
expect "a spec that names no backend" 2 '^nocturne: wrong.json: .*"cuda" is none of' experiment wrong.json -o written
sed 's/"backend": "vulkan"/"device": "9"/' named.json >number.json
expect "a spec that names a device" 1 '^nocturne: vulkan: .' experiment number.json -o written
echo broken >broken.json
VK_DRIVER_FILES=broken.json
refused "a driver whose manifest is broken" "^nocturne: vulkan: .*manifest is broken" render builtin:city
VK_DRIVER_FILES="$work/no-driver.json"
expect "an animation without a driver" 1 '^nocturne: vulkan: .' render $small --animate --backend vulkan -o a-%d.png
expect "influence without a driver" 1 '^nocturne: vulkan: .' influence builtin:city --region point:0,0 --backend vulkan
expect "view without a driver" 1 '^nocturne: vulkan: .' view builtin:city --port 0 --backend vulkan
expect "a GPU by name without a driver" 1 '^nocturne: vulkan: .' render $small --device nvidia -o a.png
expect "a GPU for embree" 2 'device: "nvidia" is for vulkan' render $small --backend cpu --device nvidia -o a.png
expect "no such backend" 2 'backend: "cuda" is none of embree.vulkan.auto' render $small --backend cuda -o a.png
expect "a device without a name" 2 'device: needs a value' render $small --device= -o a.png

run render $small -o auto.png
[ $status = 0 ] && grep -Eq '^  device    embree, .' out; result $? "auto renders on the processor, and says so"
[ "$(meta auto.png backend)" = embree ] && [ -n "$(meta auto.png device)" ]
result $? "metadata name backend and device"
run render $small --backend embree -o embree.png
cmp -s auto.png embree.png; result $? "embree by its name: the same file"
run render $small --backend cpu -o cpu.png
cmp -s auto.png cpu.png; result $? "cpu is another name of it"
run bench builtin:single --quick --only isa --json
python3 -c 'import json, sys; d = json.load(open("out")); assert d["backend"] == "embree" and d["device"]' 2>why
result $? "bench names backend and device" "$(tail -n 1 why)"

# each OPTION...: status and first line of every command that renders, with these options
cat >commands <<'COMMANDS'
render builtin:single -o each.png
render builtin:single --animate -o each-%d.png
view builtin:single --port 0
influence builtin:single --region point:0,0
experiment spec.json
bench builtin:single --quick
COMMANDS
each() {
    while IFS= read -r command; do
        # shellcheck disable=SC2086 # words
        run $command "$@"
        echo "$status $(head -n 1 err)"
    done <commands | sort -u
}
test "$(each --backend cuda)" = '2 nocturne: --backend: "cuda" is none of embree|vulkan|auto' &&
    test "$(each --device '')" = '2 nocturne: --device: needs a value' &&
    test "$(each --backend embree --device 0)" = '2 nocturne: device: "0" is for vulkan; embree has the processor alone'
result $? "all commands that render refuse wrong values alike"
for command in render view influence experiment bench; do
    "$program" help $command | grep -q '^  --backend NAME' && "$program" help $command | grep -q '^  --device GPU' ||
        echo "$command"
done >without
test ! -s without; result $? "and their help lists both options" "$(cat without)"
for command in 'compare a.png b.png' 'build builtin:single -o a.noct' 'info builtin:single' 'init folder a.gml'; do
    # shellcheck disable=SC2086
    run $command --backend vulkan
    test $status = 2 && grep -q 'no option --backend' err || echo "$command"
done >taken
test ! -s taken; result $? "commands that do not render take neither" "$(cat taken)"

if VK_DRIVER_FILES=$tests_driver "$program" devices | grep -Eq '^vulkan 0 software, [^:]*$'; then
    export VK_DRIVER_FILES="$tests_driver"
    test "$(each --backend vulkan --device 9 | sed 's/; devices: 0 .*//')" = \
        '2 nocturne: device: "9" is neither number nor part of a name' &&
        test "$(each --backend vulkan --device ' ')" = '2 nocturne: device: is empty; pass a number or a part of a name'
    result $? "and numbers that no device has"
    for device in 0 llvmpipe LLVMPIPE; do
        run render $small --device $device -o named.png
        test $status = 0 && test "$(meta named.png backend)" = vulkan || echo $device
    done >unnamed
    test ! -s unnamed; result $? "a number and a part of a name mean the device, by auto, too" "$(cat unnamed)"
    run experiment named.json --cache cache -o by-spec
    test $status = 0 && grep -q ',vulkan,"\?llvmpipe' by-spec/results.csv; result $? "a spec names it"
    printf 'nocturne: 1\ninputs: ["builtin:single"]\n' >recipe.yaml
    run render recipe.yaml --size 32x18 --frames 1 --backend vulkan -o recipe.png
    test $status = 0 && test "$(meta recipe.png backend)" = vulkan; result $? "a recipe is drawn by it"
    run render $small -o auto-too.png
    test $status = 0 && cmp -s auto.png auto-too.png; result $? "auto never takes software"
else
    skip "devices by number and name" "no software device here"
fi
finish
