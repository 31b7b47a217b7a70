#!/bin/sh
# tools/vulkan-driver.sh without a network: apt-get and dpkg are scripts that answer as each case needs.
set -u
source_dir=${NOC_SOURCE:?names the source folder}
script=$source_dir/tools/vulkan-driver.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/cache"
unset VK_DRIVER_FILES VK_ICD_FILENAMES MESA_SHADER_CACHE_DIR
export XDG_CACHE_HOME="$work/cache"
debian=$(grep -c '^VERSION_CODENAME=bookworm' /etc/os-release)
count=0 failed=0

# expect NAME CONDITION...
expect() {
    count=$((count + 1)) name=$1
    shift
    if "$@"; then
        echo "ok $count - $name"
    else
        failed=1
        echo "not ok $count - $name"
        sed 's/^/# /' "$work/out"
    fi
}
# answers ARCHITECTURE MIRROR: of dpkg, and of apt-get, whose downloads fail
answers() {
    printf '#!/bin/sh\necho %s\n' "$1" >"$work/bin/dpkg"
    # shellcheck disable=SC2016 # expands in that script
    printf '#!/bin/sh\n[ "$1" = indextargets ] && { echo "%s"; exit; }\necho "E: no route"\nexit 100\n' "$2" \
        >"$work/bin/apt-get"
    chmod +x "$work/bin/dpkg" "$work/bin/apt-get"
}
# refused REASON: the script prints it in its last line, succeeds, and leaves nothing
refused() {
    PATH="$work/bin:$PATH" "$script" "$work/folder" >"$work/out" 2>&1 && tail -n 1 "$work/out" | grep -qF "$1" &&
        [ "$(tail -n 1 "$work/out" | grep -c 'Tests of Vulkan')" = 1 ] &&
        [ -z "$(ls "$work/folder" 2>/dev/null)" ]
}
on_debian() {
    [ "$debian" = 1 ] && { expect "$@"; return; }
    count=$((count + 1))
    echo "ok $count - $1 # SKIP this is not Debian 12"
}

answers arm64 'bookworm main http://mirror.example/debian'
on_debian "another architecture is refused" refused "on arm64"
answers amd64 ''
on_debian "apt without a mirror" refused "apt has no mirror"
answers amd64 'bookworm main http://mirror.example/debian'
on_debian "no network: apt's error is the reason" refused "E: no route"
answers amd64 'trixie main http://mirror.example/debian'
on_debian "a mirror of another release is not taken" refused "apt has no mirror"

# run VARIABLE [ASSIGNMENT]: its value in what the script runs
run() { env ${2:+"$2"} "$script" --run printenv "$1" 2>"$work/out"; }
is() { [ "$1" = "$2" ] || { echo "$1, not $2" >"$work/out"; false; }; }
expect "shaders are kept in the cache folder" is "$(run MESA_SHADER_CACHE_DIR)" "$work/cache/nocturne-tests/shaders"
mkdir "$work/cache/nocturne-tests"
echo '{}' >"$work/cache/nocturne-tests/lvp_icd.json"
expect "tests run on the driver that was unpacked" is "$(run VK_DRIVER_FILES)" \
    "$work/cache/nocturne-tests/lvp_icd.json"
expect "another driver may be named" is "$(run VK_DRIVER_FILES VK_DRIVER_FILES=gpu.json)" gpu.json
expect "another folder of shaders, too" is "$(run MESA_SHADER_CACHE_DIR MESA_SHADER_CACHE_DIR=here)" here
"$script" --run sh -c 'exit 7'
expect "the program's status is passed on" is $? 7
echo "1..$count"
exit $failed
