#!/bin/sh
# check-arm64.sh [TEST...]: builds for arm64 on another machine, and runs tests there by qemu. Packages for arm64 of the
# same Debian are unpacked in build-arm64/root and not installed. It builds without GDAL, Assimp and the viewer, which
# need half of Debian. `make arm64` calls it.
set -eu
cd "$(dirname "$0")/.."
build=build-arm64
root=$PWD/$build/root apt=$PWD/$build/apt triplet=aarch64-linux-gnu
[ $# -gt 0 ] || set -- core-test_dialect core-test_light core-test_list_sketch backend-test_kernels render-test_golden
missing=
need() { command -v "$1" >/dev/null || missing="$missing $2"; }
need $triplet-gcc gcc-$triplet
need qemu-aarch64-static qemu-user-static
need meson meson
need ninja ninja-build
need apt-get apt
[ -z "$missing" ] || { echo "Please install:$missing" >&2; exit 1; }

# Its own lists, state and cache: the machine's are left alone.
if [ ! -e "$root/ready" ]; then
    rm -rf "$root"
    mkdir -p "$root" "$apt/lib/lists/partial" "$apt/cache/archives/partial"
    : >"$apt/status"
    cat >"$apt/apt.conf" <<END
Dir::State "$apt/lib";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
APT::Architecture "arm64";
APT::Architectures "arm64";
APT::Install-Recommends "false";
END
    libraries=$(sed -n 's/^ *need \(lib[a-z0-9.-]*-dev\|zlib1g-dev\) .*/\1/p' tools/install-deps.sh |
        grep -vE 'gdal|assimp|websockets|vulkan')
    APT_CONFIG=$apt/apt.conf apt-get update -qq
    # shellcheck disable=SC2086 # a list of words
    APT_CONFIG=$apt/apt.conf apt-get install -qq -y --download-only $libraries >/dev/null
    for package in "$apt"/cache/archives/*.deb; do
        dpkg -x "$package" "$root"
    done
    # lib is a link to usr/lib, as on an installed system
    cp -a "$root/lib/." "$root/usr/lib/"
    rm -rf "$root/lib" "$apt"
    ln -s usr/lib "$root/lib"
    touch "$root/ready"
fi

libraries=$root/usr/lib/$triplet
search=$libraries:$libraries/blas:$libraries/lapack
if [ ! -e $build/build.ninja ]; then
    cat >$build/cross.txt <<END
[binaries]
c = '$triplet-gcc'
cpp = '$triplet-gcc'
ar = '$triplet-ar'
strip = '$triplet-strip'
pkgconfig = 'pkg-config'
pkg-config = 'pkg-config'
exe_wrapper = ['qemu-aarch64-static', '-L', '$root', '-E', 'LD_LIBRARY_PATH=$search']
[built-in options]
c_args = ['--sysroot=$root']
c_link_args = ['--sysroot=$root', '-Wl,-rpath-link,$search']
[properties]
sys_root = '$root'
pkg_config_libdir = '$libraries/pkgconfig:$root/usr/share/pkgconfig'
[host_machine]
system = 'linux'
cpu_family = 'aarch64'
cpu = 'armv8-a'
endian = 'little'
END
    meson setup $build --cross-file $build/cross.txt -Dgdal=disabled -Dassimp=disabled -Dviewer=disabled \
        -Dtests=enabled >$build/setup.log || { cat $build/setup.log >&2; exit 1; }
fi
# What `meson test` needs of all tests is more than these do.
programs=$(tools/test_targets.py $build "$@")
# shellcheck disable=SC2086
ninja -C $build $programs
meson test -C $build --no-rebuild --timeout-multiplier 20 --print-errorlogs "$@"
