#!/bin/sh
# --backend and --device, on a machine that has no Vulkan driver.
. "$(dirname "$0")/lib.sh"
unset VK_ICD_FILENAMES VK_ADD_DRIVER_FILES
export VK_DRIVER_FILES="$work/no-driver.json"
small="builtin:city --city-size 150 --size 32x18 --frames 1"

run --version
grep -Eq '^  embree 0 processor, .' out && grep -Eq '^  vulkan none: .' out; result $? "--version lists devices"

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
finish
