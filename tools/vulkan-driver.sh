#!/bin/sh
# The Vulkan driver of the tests: Mesa's software device with ray tracing, which Debian 12 has in its backports alone.
# vulkan-driver.sh [FOLDER]: unpacks it into FOLDER, unless it is there. No package is installed. Where it cannot be
#   had, prints one line with the reason and succeeds: tests that need it are skipped.
# vulkan-driver.sh --run PROGRAM [ARGUMENT...]: runs PROGRAM with that driver alone, so that tests do not depend on the
#   machine's GPUs. VK_DRIVER_FILES, where set, names another driver: with it tests run on a GPU.
# FOLDER is nocturne-tests in the user's cache folder by default. It is kept, with the shaders that Mesa has compiled
# (MESA_SHADER_CACHE_DIR), which make most of the time of a first run.
set -u
cache=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/nocturne-tests
package=mesa-vulkan-drivers
suite=bookworm # the first Mesa with ray tracing in software, 24.1, is in none of its own packages

if [ "${1:-}" = --run ]; then
    shift
    if [ -z "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ]; then
        driver=$cache/lvp_icd.json
        for file in /usr/share/vulkan/icd.d/lvp_icd*.json; do
            [ -e "$driver" ] || driver=$file
        done
        export VK_DRIVER_FILES="$driver"
    fi
    export MESA_SHADER_CACHE_DIR="${MESA_SHADER_CACHE_DIR:-$cache/shaders}"
    exec "$@"
fi

# lacks LIBRARY: the first thing that the system lacks for it
lacks() { ldd -r "$1" 2>&1 | awk '/not found|undefined symbol/ { print; exit }'; }
folder=${1:-$cache}
[ -e "$folder/lvp_icd.json" ] && [ -z "$(lacks "$folder/libvulkan_lvp.so")" ] && exit 0
without() {
    echo "Tests of Vulkan ray tracing run on the system's own driver, or not at all: $1"
    exit 0
}

# shellcheck disable=SC1091 # this system's
codename=$(. /etc/os-release 2>/dev/null && echo "${VERSION_CODENAME:-}")
command -v apt-get >/dev/null 2>&1 && [ "$codename" = $suite ] || without "this is not Debian 12"
architecture=$(dpkg --print-architecture)
[ "$architecture" = amd64 ] || without "Mesa's software device crashes tracing rays on $architecture"
# The mirror that this machine has its own packages from.
mirror=$(apt-get indextargets --format '$(RELEASE) $(COMPONENT) $(REPO_URI)' "Created-By: Packages" 2>/dev/null |
    awk -v suite=$suite '$1 == suite && $2 == "main" { print $3; exit }')
[ -n "$mirror" ] || without "apt has no mirror of $suite"

mkdir -p "$folder" && work=$(mktemp -d "$folder/unpack.XXXXXX") || without "$folder cannot be written"
trap 'rm -rf "$work"' EXIT
keys=/usr/share/keyrings/debian-archive-keyring.gpg
[ -e $keys ] && keys="[signed-by=$keys]" || keys=
echo "deb $keys $mirror $suite-backports main" >"$work/sources.list"
mkdir -p "$work/lists/partial" "$work/cache/archives/partial"
apt() {
    apt-get -qq -o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts=/dev/null \
        -o Dir::State::lists="$work/lists" -o Dir::Cache="$work/cache" -o Acquire::Languages=none \
        -o Acquire::Retries=1 -o Acquire::http::Timeout=20 -o APT::Sandbox::User=root "$@" >"$work/log" 2>&1
}
echo "Fetching a Vulkan driver for tests (11 MB) ..."
# shellcheck disable=SC2015 # either may fail
apt update && (cd "$work" && apt download $package/$suite-backports) ||
    without "$suite-backports: $(grep -m 1 '^[EW]:' "$work/log" || echo 'not fetched')"
dpkg-deb -x "$work/$package"_*.deb "$work/root" || without "$package cannot be unpacked"

# One library of the package is used. What it needs comes with Debian's own $package.
library=$(find "$work/root" -name libvulkan_lvp.so)
[ -n "$library" ] || without "$package has no libvulkan_lvp.so"
missing=$(lacks "$library")
[ -z "$missing" ] || without "$missing"
version=$(sed -n 's/.*"api_version": *"\([^"]*\)".*/\1/p' "$work"/root/usr/share/vulkan/icd.d/lvp_icd*.json)
mv -f "$library" "$work/root/usr/share/doc/$package/copyright" "$folder/" &&
    printf '{ "file_format_version": "1.0.0", "ICD": { "library_path": "%s", "api_version": "%s" } }\n' \
        "$(cd "$folder" && pwd)/libvulkan_lvp.so" "$version" >"$work/lvp_icd.json" &&
    mv "$work/lvp_icd.json" "$folder/" || without "$folder cannot be written"
