#!/bin/sh
# install-deps.sh [build|check|fuzz|coverage]: sees what is missing to build (default), to build and test, to fuzz, or
# to measure what tests cover, says what and why, and installs it where apt-get is. Says and does nothing when all is
# there.
set -u
purpose=${1:-build}

have() { command -v "$1" >/dev/null 2>&1; }
module() { have pkg-config && pkg-config --exists "$1" 2>/dev/null; }
header() {
    for folder in /usr/include /usr/local/include; do
        [ -e "$folder/$1" ] && return 0
    done
    return 1
}
icd() {
    for file in /usr/share/vulkan/icd.d/lvp_icd* /usr/local/share/vulkan/icd.d/lvp_icd*; do
        [ -e "$file" ] && return 0
    done
    return 1
}
layer() {
    for folder in /usr/share /usr/local/share /etc; do
        [ -e "$folder/vulkan/explicit_layer.d/VkLayer_khronos_validation.json" ] && return 0
    done
    return 1
}

missing= reasons=
# need PACKAGE REASON PROBE...: PACKAGE is Debian's name of it
need() {
    package=$1 reason=$2
    shift 2
    "$@" && return
    missing="$missing $package"
    reasons="$reasons
  $package: $reason"
}

compiler() { have cc || have gcc || have clang; }
cplusplus() { have c++ || have g++ || have clang++; }
libc() { header stdio.h; }
embree() { header embree4/rtcore.h || header embree3/rtcore.h; }
need gcc "C compiler" compiler
need libc6-dev "C library headers" libc
need meson "build system" have meson
need ninja-build "runs the build" have ninja
need pkg-config "finds libraries" have pkg-config
need libembree-dev "ray tracing on the processor" embree
need libgdal-dev "street lamps from OpenStreetMap, GeoJSON and CSV" module gdal
need libproj-dev "coordinate reference systems" module proj
need libexpat1-dev "CityGML (XML)" module expat
need libjansson-dev "Overpass JSON, specs of experiments" module jansson
need libyaml-dev "recipes" module yaml-0.1
need libglu1-mesa-dev "cuts polygons into triangles" module glu
need libassimp-dev "OBJ meshes" module assimp
need libseccomp-dev "a fence around the program that reads OBJ and map files" module libseccomp
need libopenexr-dev "EXR pictures" module OpenEXR
need libturbojpeg0-dev "JPEG textures" module libturbojpeg
need libwebsockets-dev "nocturne view, the viewer in a browser" module libwebsockets
need libpng-dev "PNG pictures" module libpng
need libzip-dev "zipped city models" module libzip
need zlib1g-dev "gzipped city models" module zlib
need libvulkan-dev "rendering on GPUs (Vulkan)" module vulkan
need libvulkan-volk-dev "finds the Vulkan loader at run time" header volk.h
need glslang-tools "compiles shaders" have glslangValidator
need spirv-tools "validates shaders" have spirv-val
fuzzer() {
    have clang || return 1
    for file in "$(clang -print-resource-dir)"/lib/linux/libclang_rt.fuzzer-*.a; do
        [ -e "$file" ] && return 0
    done
    return 1
}
browser() { have chromium || have chromium-browser || have google-chrome; }
formatter() { have clang-format || have clang-format-14; }
if [ "$purpose" = fuzz ]; then
    need "clang libclang-rt-14-dev llvm-14" "libFuzzer and the sanitizers" fuzzer
fi
if [ "$purpose" = coverage ]; then
    need "clang llvm" "counts the lines that were run" have llvm-cov
fi
if [ "$purpose" = check ] || [ "$purpose" = coverage ]; then
    need g++ "tests that the headers serve C++ too" cplusplus
    need libcmocka-dev "unit tests" module cmocka
    need clang-format "tests the layout of the sources" formatter
    need mesa-vulkan-drivers "a Vulkan device in software, for tests" icd
    need vulkan-validationlayers "finds wrong use of Vulkan in tests" layer
    need chromium "drives the viewer's page in tests" browser
fi
[ -n "$missing" ] || exit 0

printf 'Needed and not here:%s\n' "$reasons"
if ! have apt-get; then
    echo "There is no apt-get here: please install these (Debian's names) and run make again." >&2
    exit 1
fi
root=
if [ "$(id -u)" != 0 ]; then
    have sudo || { echo "Please run as root: apt-get install --no-install-recommends$missing" >&2; exit 1; }
    root="sudo"
fi
echo "Installing with apt-get (about half a minute to a minute) ..."
log=$(mktemp) || exit 1
trap 'rm -f "$log"' EXIT
# shellcheck disable=SC2086 # a list of words
install() {
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends -o Dpkg::Use-Pty=0 \
        -o DPkg::Options::=--force-unsafe-io $missing >"$log" 2>&1
}
# A fresh machine has no package lists, an old one stale ones: fetch them when the first try fails.
if ! install; then
    $root apt-get update -qq >"$log" 2>&1 && install || {
        tail -n 15 "$log" >&2
        echo "apt-get failed; by hand: apt-get install --no-install-recommends$missing" >&2
        exit 1
    }
fi
echo "Installed:$missing"
