#!/bin/sh
# The Vulkan suite and its tables on one device, in one go of under nine minutes, as a page of docs/gpu.
# gpu-report.sh: packs build/, runs the pack on this machine, and writes docs/gpu/DEVICE.md.
# gpu-report.sh pack FILE: writes the pack alone, FILE.tar.xz: program, library and all libraries that they need but the
#   C library's, tests, scenes and specs. It runs on a machine that has a driver and Python 3 and nothing else of ours:
#       python3 -m tarfile -e FILE.tar.xz FOLDER && sh FOLDER/gpu-report/gpu-report.sh run OUT
#   WITH_LOADER=1 packs this machine's Vulkan loader, too, for a machine that has a driver and no loader.
# gpu-report.sh run OUT: in an unpacked pack. OUT gets DEVICE.md and what it was made of, eight files at most. The page
#   is written again after each step, and after a signal, so that it is there whenever the run is ended.
# Environment: DEVICE, a device's name or number as --device takes it; SIZE of pictures (1920x1080, in software 96x54);
#   BUDGET in seconds (520): each step ends by a share of it, and the page lists those that had no time; TEST_LIMIT,
#   seconds of one test program at most; BUILD, the build folder.
set -u
here=$(cd "$(dirname "$0")" && pwd)

# ---- packing ----

# libraries FILE...: what they load when they start, without the C library's own
libraries() {
    for binary in "$@"; do ldd "$binary"; done 2>/dev/null | awk '$3 ~ /^\// { print $3 }' | sort -u |
        grep -Ev '/(ld-linux[^/]*|lib(c|m|dl|rt|pthread|resolv|util|nsl|anl))\.so\.[0-9.]+$'
}

# pack FOLDER
pack() {
    pack=$1
    root=$(cd "$here/.." && pwd)
    build=${BUILD:-$root/build}
    [ -x "$build/nocturne" ] || { echo "gpu-report: $build has no program: make build" >&2; exit 1; }
    rm -rf "$pack" && mkdir -p "$pack/lib" "$pack/build" "$pack/specs" || exit 1
    cp "$here/gpu-report.sh" "$here/gpu-report.py" "$here/count-tests.py" "$pack/" || exit 1
    cp "$build/nocturne" "$build/nocturne-reader" "$pack/build/" && cp -L "$build"/libnocturne.so.[0-9] "$pack/lib/" ||
        exit 1
    python3 "$here/gpu-report.py" --tests "$root" "$build" "$pack" || exit 1
    # shellcheck disable=SC2046 # paths without blanks
    cp -L $(libraries "$build/nocturne" "$build"/libnocturne.so "$pack"/build/tests/* | grep -v libnocturne) \
        "$pack/lib/" || exit 1
    if [ -n "${WITH_LOADER:-}" ]; then
        mkdir "$pack/loader"
        for name in libvulkan libEGL libGLdispatch libGLX libGL libOpenGL libGLESv2; do
            for library in /usr/lib/*/"$name".so.[0-9]; do
                [ -e "$library" ] && cp -L "$library" "$pack/loader/"
            done
        done
    fi
    # A city's file needs no database of coordinate systems, and loads at once.
    export NOCTURNE_READER="$build/nocturne-reader"
    city="$root/../shared/data/cities/rotterdam/3-20-DELFSHAVEN.city.json.gz"
    if [ -e "$city" ]; then
        for kind in lamps:--no-windows windows: lit:--window-lit=1; do
            # shellcheck disable=SC2086 # one option or none
            "$build/nocturne" build -q "$root/cities/rotterdam.yaml" ${kind#*:} -o "$pack/specs/${kind%%:*}.noct" ||
                exit 1
        done
    fi
    python3 "$here/gpu-report.py" --specs "$root" "$pack" || exit 1
    { git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown; } >"$pack/commit"
}

# ---- running ----

# until_share PERCENT: seconds left until this share of the budget is used
until_share() {
    echo $((BUDGET * $1 / 100 - $(date +%s) + begun))
}

# step NAME SECONDS COMMAND...: runs it no longer than that, its output in logs, one line of steps.txt; then the page
step() {
    name=$1 limit=$2
    shift 2
    if [ -n "$stopped" ] || [ "$limit" -lt 3 ]; then
        echo "$name - 0" >>"$work/steps.txt"
        return
    fi
    before=$(date +%s)
    env LD_LIBRARY_PATH="$libraries" timeout -k 5 "$limit" "$@" >"$work/$name.out" 2>"$work/$name.err" </dev/null &
    child=$!
    wait "$child"
    status=$?
    if [ -n "$stopped" ]; then # the signal ended the wait alone
        wait "$child"
        status=stopped
    fi
    child=
    echo "$name $status $(($(date +%s) - before))" >>"$work/steps.txt"
    [ ! -e "$work/chosen" ] || page
}

# The page of what is there so far.
page() {
    echo "$(($(date +%s) - begun)) ${stopped:-}" >"$work/took"
    python3 "$here/gpu-report.py" "$work" "$out" >"$work/page.txt"
}

# A signal ends the step that runs, leaves out the others, and keeps the page.
stop() {
    stopped=stopped
    [ -n "$child" ] && kill "$child" 2>/dev/null
}

# The first driver of hardware, else that of the tests (vulkan-driver.sh); nothing: the loader finds its own.
find_driver() {
    for pattern in nvidia radeon amd intel; do
        for folder in /usr/share/vulkan/icd.d /etc/vulkan/icd.d /usr/local/share/vulkan/icd.d \
            /usr/local/nvidia/share/vulkan/icd.d; do
            for file in "$folder/$pattern"*.json; do
                [ -e "$file" ] && { echo "$file"; return; }
            done
        done
    done
    [ -e "$tests/lvp_icd.json" ] && echo "$tests/lvp_icd.json"
}

# run OUT
run() {
    mkdir -p "$1" && out=$(cd "$1" && pwd) && work=$(mktemp -d) || exit 1
    trap 'rm -rf "$work"' EXIT
    begun=$(date +%s) stopped='' child=''
    BUDGET=${BUDGET:-520}
    trap stop TERM INT HUP
    libraries=$here/lib
    ldconfig -p 2>/dev/null | grep -q 'libvulkan\.so\.1' || libraries=$here/lib:$here/loader
    tests=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/nocturne-tests
    export MESA_SHADER_CACHE_DIR="${MESA_SHADER_CACHE_DIR:-$tests/shaders}"
    if [ -z "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ]; then
        driver=$(find_driver)
        [ -n "$driver" ] && export VK_DRIVER_FILES="$driver"
    fi
    export XDG_CACHE_HOME="$work/cache" NOCTURNE_READER="$here/build/nocturne-reader" CMOCKA_MESSAGE_OUTPUT=TAP
    export NOC_SOURCE="$here" NOC_BUILD="$here/build" NOC_SHARED="$here/shared"
    cp "$here/commit" "$work/"
    program=$here/build/nocturne
    step devices 60 "$program" devices
    cp "$work/devices.out" "$out/devices.txt"
    nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader >"$work/smi.out" 2>/dev/null
    # The device of this number, else of this name, else the first that is usable.
    grep '^vulkan *[0-9]* [^:]*$' "$work/devices.out" >"$work/usable.txt"
    device=$({
        grep "^vulkan *${DEVICE:-none} " "$work/usable.txt"
        grep -iF -- "${DEVICE:-}" "$work/usable.txt"
    } | awk 'NR == 1 { print $2 }')
    device=${device:-0}
    kind=$(sed -n "s/^vulkan *$device \([a-z]*\),.*/\1/p" "$work/devices.out")
    size=1920x1080 frames=9
    [ "$kind" = software ] && size=96x54 frames=3
    size=${SIZE:-$size}
    printf '%s\n%s\n%s\n' "$device" "$kind" "$size" >"$work/chosen"
    page

    # Tests first, then what says most. A step's end is a share of the budget, so what one leaves, the next has.
    count=$(wc -l <"$here/tests.txt")
    while IFS= read -r test; do
        limit=$(($(until_share 29) / count))
        [ "$limit" -gt "${TEST_LIMIT:-$limit}" ] && limit=$TEST_LIMIT
        count=$((count - 1))
        # shellcheck disable=SC2046 # its arguments
        step "test-${test%% *}" "$limit" $(echo "${test#* }" | sed "s|@PACK@|$here|g")
    done <"$here/tests.txt"
    python3 "$here/gpu-report.py" --sized "$here/specs" "$size"
    bench floor 43 --backend vulkan --device "$device" --only floor,passes --frames $frames
    experiment frame-times 64
    bench growth 79 --backend vulkan --device "$device" --only lights,windows --method restir-uniform --frames $frames
    experiment cars 93
    bench cpu 100 --backend embree --only floor --frames 3
    page && cat "$work/page.txt" && [ -z "$stopped" ]
}

# bench NAME PERCENT OPTION...: its own limit is less than the step's, so that it ends with whole tables
bench() {
    name=$1 limit=$(until_share "$2")
    shift 2
    step "$name" "$limit" "$program" bench "$@" --size "$size" --time $((limit * 9 / 10)) -o "$work/$name.json"
}

# experiment NAME PERCENT
experiment() {
    step "$1" "$(until_share "$2")" "$program" experiment "$here/specs/$1-sized.json" --backend vulkan \
        --device "$device" -o "$work/$1" -q
}

case "${1:-}" in
pack)
    folder=$(mktemp -d) || exit 1
    trap 'rm -rf "$folder"' EXIT
    pack "$folder/gpu-report"
    tar -C "$folder" -cf - gpu-report | xz -6 >"${2:?FILE}.tar.xz" && ls -l "$2.tar.xz"
    ;;
run)
    run "${2:?OUT}"
    ;;
"")
    folder=$(cd "$here/.." && pwd)
    pack "$folder/build/gpu-report"
    out=$folder/build/gpu-report/out
    sh "$folder/build/gpu-report/gpu-report.sh" run "$out" >/dev/null &
    child=$!
    trap 'kill "$child" 2>/dev/null' TERM INT HUP
    wait "$child" || wait "$child" # a signal ends the first wait alone
    status=$?
    for page in "$out"/*.md; do
        [ -e "$page" ] && mkdir -p "$folder/docs/gpu" && cp "$page" "$folder/docs/gpu/" && echo "docs/gpu/${page##*/}"
    done
    exit $status
    ;;
*)
    sed -n '2,/^set/s/^# \{0,1\}//p' "$0"
    exit 2
    ;;
esac
