#!/bin/sh
# Holds the arrows of docs/architecture.md: reads every #include under src/ and fails when one turns back. It also holds
# that a library never ends its host: refused memory is a status, and so is all else. TAP.
set -u
root=${NOC_SOURCE:-$(cd "$(dirname "$0")/.." && pwd)}

# A room, and the rooms whose headers it may use besides its own and base's; core, and what the programs are made of
# (cli, viewer, reader), may not use base either.
arrows='
base:
core:
photometry:
noct:
scene: core photometry noct
geo: scene
image:
light: scene core
city: geo scene
import: geo city scene image noct
render: light scene image core
backend: render light scene core
lab:
recipe:
ask:
measure: render scene core
viewer:
cli: viewer
reader:
'
# Libraries that one room alone may touch (jansson: three; neither hands its values on).
owners='
embree[34]/ backend
volk.h|vulkan/ backend
rtcore.h backend
proj.h geo
gdal|ogr_|cpl_ import
assimp/ import
expat.h import
jansson.h import lab viewer
libwebsockets.h viewer
yaml.h recipe
zip.h import
GL/glu.h geo
png.h image
turbojpeg.h image
openexr image
'

# violations FOLDER: one line each
violations() {
    find "$1" -name '*.[ch]' | sort | while read -r file; do
        room=${file#"$1"/}
        room=${room%%/*}
        awk -v file="${file#"$1"/}" -v room="$room" -v arrows="$arrows" -v owners="$owners" '
            BEGIN {
                n = split(arrows, line, "\n")
                for (i = 1; i <= n; i++) {
                    m = split(line[i], word, /[: ]+/)
                    known[word[1]] = 1
                    for (j = 2; j <= m; j++)
                        if (word[1] == room) allowed[word[j]] = 1
                }
                if (!(room in known)) print file ": no such room in tests/layers.sh: " room
                allowed[room] = 1
                if (room != "core" && room != "cli" && room != "viewer" && room != "reader")
                    allowed["base"] = 1
                split(owners, owner, "\n")
            }
            # The programs may end themselves, and so may the helper that reads for a library.
            /(^|[^A-Za-z0-9_.>])(abort|exit|_exit|_Exit|quick_exit|raise|assert|__builtin_trap)[ \t]*\(/ {
                if (room != "cli" && room != "reader" && file !~ /^import\/remote\/(serve|keep).c$/)
                    print file ": a library may not end its host: " $0
            }
            # Tests refuse what base/memory.c allocates; jansson must have its memory (import/json.c says why).
            /(^|[^A-Za-z0-9_.>])((m|c|re)alloc|reallocarray|aligned_alloc|posix_memalign)[ \t]*\(/ ||
            /(^|[^A-Za-z0-9_.>])(alloca|strn?dup|v?asprintf)[ \t]*\(/ {
                if (room != "cli" && room != "viewer" && room != "lab" &&
                    file != "base/memory.c" && file != "import/json.c")
                    print file ": allocations are those of base/base.h: " $0
            }
            /^[ \t]*#[ \t]*include[ \t]*"/ {
                split($0, part, "\""); path = part[2]
                if (path ~ /\.\.\//) print file ": climbs out of its room: " path
                if (index(path, "/")) {
                    other = path; sub(/\/.*/, "", other)
                    if ((other in known) && !(other in allowed)) print file ": " room " may not use " path
                    if (other == "backend" && room == "backend") {
                        mine = file; sub(/^backend\//, "", mine); sub(/\/.*/, "", mine)
                        theirs = path; sub(/^backend\//, "", theirs); sub(/\/.*/, "", theirs)
                        if (mine != theirs && theirs != "parts.h" && !(mine == "embree" && theirs == "cpu"))
                            print file ": one backend may not use another: " path
                    }
                }
            }
            /^[ \t]*#[ \t]*include[ \t]*</ {
                path = $0; sub(/.*</, "", path); sub(/>.*/, "", path)
                if (room == "core" && path ~ /^nocturne\//) print file ": core may not use " path
                if (room == "backend" && path ~ /^embree[34]\// && file !~ /^backend\/embree\//)
                    print file ": only backend/embree may use " path
                for (i in owner) {
                    split(owner[i], word, " ")
                    if (owner[i] != "" && path ~ "^(" word[1] ")" && word[2] != room && word[3] != room &&
                        word[4] != room)
                        print file ": only " word[2] " may use " path
                }
            }' "$file"
    done
}

count=0 failed=0
result() {
    count=$((count + 1))
    if [ "$1" = 0 ]; then echo "ok $count - $2"; else failed=1; echo "not ok $count - $2"; fi
}

found=$(violations "$root/src")
[ -z "$found" ]; result $? "every arrow points down"
[ -n "$found" ] && echo "$found" | sed 's/^/# /'

# circles FOLDER: what tsort says of files that include each other's headers in a circle; a.c and a.h are one
circles() {
    grep -o '^#include "lab/[a-z_]*\.h"' "$1"/lab/*.[ch] |
        sed 's|^.*/lab/\([a-z_]*\)\.[ch]:#include "lab/|\1 |; s|\.h"$||' | awk '$1 != $2' | tsort 2>&1 >/dev/null
}
found=$(circles "$root/src")
[ -z "$found" ] && grep -q '"lab/session.h"' "$root/src/lab/run.h"; result $? "the laboratory's files form no circle"
[ -n "$found" ] && echo "$found" | sed 's/^/# /'

# The check itself: a tree where each of these lines is wrong.
tree=$(mktemp -d) || exit 1
trap 'rm -rf "$tree"' EXIT
wrong() {
    mkdir -p "$tree/$(dirname "$1")"
    printf '%s\n' "$2" >"$tree/$1"
    [ -n "$(violations "$tree")" ]; result $? "notices $1: $2"
    rm -r "${tree:?}"/*
}
wrong base/a.c '#include "scene/scene.h"'
wrong photometry/a.c '#include "scene/scene.h"'
wrong core/a.h '#include "base/base.h"'
wrong core/a.h '#include <nocturne/log.h>'
wrong scene/a.c '  #  include "render/backend.h"'
wrong cli/a.c '#include "base/base.h"'
wrong cli/a.c '#include "../base/base.h"'
wrong viewer/a.c '#include "base/base.h"'
wrong viewer/a.c '#include "cli/cli.h"'
wrong viewer/a.c 'exit(1);'
wrong cli/a.c '#include <libwebsockets.h>'
wrong reader/a.c '#include "base/base.h"'
wrong reader/a.c '#include "import/remote/remote.h"'
wrong backend/embree/a.c '#include "backend/vulkan/b.h"'
wrong backend/cpu/a.c '#include "backend/embree/b.h"'
wrong backend/cpu/a.c '#include <embree3/rtcore.h>'
wrong render/a.c '#include <embree3/rtcore.h>'
wrong import/a.c '#include <proj.h>'
wrong attic/a.c 'int x;'
wrong lab/a.c '#include "render/view.h"'
wrong lab/a.c '#include "cli/cli.h"'
wrong base/a.c '    abort();'
wrong import/load/a.c '    if (!p) exit(1);'
wrong lab/a.c 'assert(count++ < size);'
wrong import/remote/remote.c '_exit(1);'
wrong scene/a.c '    char *p = malloc (size);'
wrong backend/embree/a.c '    return strdup(name);'
mkdir -p "$tree/render" "$tree/import/remote" && echo '#include "scene/scene.h"' >"$tree/render/a.c"
echo '_Static_assert(sizeof(int) == 4, ""); int x = noc_exit(noc_strdup(s->alloca(at_exit(1))));' >>"$tree/render/a.c"
echo '_exit(0);' >"$tree/import/remote/serve.c"
found=$(violations "$tree")
[ -z "$found" ]; result $? "lets an arrow pass that points down, and words that only look like those that end a program"
[ -n "$found" ] && echo "$found" | sed 's/^/# /'

mkdir -p "$tree/lab" && echo '#include "lab/b.h"' >"$tree/lab/a.h" && echo '#include "lab/a.h"' >"$tree/lab/b.c"
[ -n "$(circles "$tree")" ]; result $? "notices a circle of files"

# Every public header compiles alone.
compiler=$(command -v cc || command -v gcc || command -v clang)
alone() {
    for header in "$root"/include/nocturne/*.h; do
        echo "#include <nocturne/$(basename "$header")>" >"$tree/alone.c"
        $compiler -fsyntax-only -Wall -Wextra -Werror "$@" -I"$root/include" "$tree/alone.c" || return 1
    done
}
alone -x c -std=c11 >"$tree/log" 2>&1; result $? "public headers compile alone as C"
sed 's/^/# /' "$tree/log"
echo 'int x;' >"$tree/probe.cc"
if $compiler -x c++ -fsyntax-only "$tree/probe.cc" 2>/dev/null; then
    alone -x c++ -std=c++14 >"$tree/log" 2>&1; result $? "public headers compile alone as C++"
    sed 's/^/# /' "$tree/log"
    $compiler -x c++ -std=c++14 -Wall -Wextra -Wpedantic -Wshadow -Werror -I"$root/include" \
        "$root/tests/cli/defaults.cc" \
        -o "$tree/defaults" -lstdc++ >"$tree/log" 2>&1 && "$tree/defaults"
    result $? "default parameters can be had in C++, and their addresses"
    sed 's/^/# /' "$tree/log"
else
    for what in "public headers compile alone as C++" "default parameters can be had in C++, and their addresses"; do
        count=$((count + 1))
        echo "ok $count - $what # SKIP no C++ compiler here"
    done
fi
echo "1..$count"
exit $failed
