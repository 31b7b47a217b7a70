#!/bin/sh
# fuzz.sh BUILD SECONDS [CORPUS...]: runs the fuzzer of each corpus for so long, on what it found before and on the
# seeds, and prints a table. Inputs that break something lie in BUILD/findings/CORPUS, new ones in BUILD/corpus/CORPUS.
# Fails where something was found. As many corpora at a time as there are cores, or JOBS of them; fuzz.sh BUILD SECONDS
# alone CORPUS is what each of them runs. fuzz.sh BUILD table: the table of all runs so far. fuzz.sh BUILD turn N: the
# corpora whose turn it is at the Nth of several runs that share the work, one in ten of them.
set -u
build=$1 seconds=${2:-60}
shift 2
root=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$build" && build=$(cd "$build" && pwd) || exit 1

# corpus, program, longest input, dictionary, endings of real data in shared/ that it starts from, too
corpora='
citygml citygml 32768 citygml gml
cityjson cityjson 16384 cityjson json,jsonl
gltf gltf 16384 gltf gltf,glb
obj obj 8192 obj obj
ply ply 8192 - ply
terrain terrain 8192 - tif
csv lamps 4096 lamps csv
overpass lamps 8192 lamps json
geojson lamps 8192 lamps geojson
osm lamps 8192 lamps osm
pbf lamps 8192 lamps pbf
gpkg lamps 65536 lamps gpkg
shp lamps 8192 lamps shp
fgb lamps 8192 lamps fgb
tracks tracks 8192 tracks gpx
stream stream 4096 - gz,zip
png image 4096 - png
exr image 8192 - exr
hdr image 4096 - hdr
compare image 8192 - -
pixels pixels 4096 - jpg,png
crs crs 2048 crs -
ies profile 4096 profile ies,IES
ldt profile 4096 profile ldt
spec spec 8192 spec -
recipe recipe 4096 recipe -
noct noct 131072 - -
pipeline pipeline 32768 citygml -
wire wire 16384 - -
request request 4096 - -
viewer viewer 8192 viewer -
'

# All of a corpus' runs: executions, processor time, coverage (edges that an input reaches, of the last run), findings.
table() {
    printf '%-10s %12s %8s %8s %8s %9s %9s\n' corpus executions minutes 'a second' edges inputs findings
    echo "$corpora" | while read -r corpus program rest; do
        [ -n "$corpus" ] && [ -s "$build/fuzz-logs/$corpus" ] || continue
        inputs=$(ls "$build/corpus/$corpus" | wc -l)
        found=$(ls "$build/findings/$corpus" | wc -l)
        awk -v corpus="$corpus" -v inputs="$inputs" -v found="$found" '
            { runs += $1; time += $2; if ($3) edges = $3 }
            END { printf "%-10s %12d %8.1f %8.1f %8d %9d %9d\n",
                corpus, runs, time / 60, time ? runs / time : 0, edges, inputs, found }' \
            "$build/fuzz-logs/$corpus"
    done
}

# fuzz CORPUS PROGRAM LENGTH DICTIONARY ENDINGS: a run that breaks something is followed by another, until the time is
# over.
fuzz() {
    now=$build/corpus/$1 found=$build/findings/$1 log=$build/fuzz-logs/$1.log
    mkdir -p "$now" "$found" "$build/fuzz-logs" "$build/fuzz/seeds/$1"
    seeds="$build/fuzz/seeds/$1"
    [ -d "$root/fuzz/found/$1" ] && seeds="$seeds $root/fuzz/found/$1"
    if [ "$5" != - ] && [ -d "$root/../shared/data" ]; then
        rm -rf "$build/real/$1" && mkdir -p "$build/real/$1"
        for ending in $(echo "$5" | tr , ' '); do
            find "$root/../shared/data" -type f -name "*.$ending" -size "-$(($3 / 1024))k" \
                -exec ln -sf -t "$build/real/$1" {} +
        done
        seeds="$seeds $build/real/$1"
    fi
    dictionary=
    [ "$4" = - ] || dictionary=-dict=$build/fuzz/dictionaries/$4.dict
    end=$(($(date +%s) + seconds))
    while left=$((end - $(date +%s))) && [ $left -gt 0 ]; do
        times >"$log.before" # of this process and its children: not in a pipe, whose ends are processes of their own
        # shellcheck disable=SC2086 # lists of words
        "$build/fuzz/fuzz_$2" $dictionary -max_len="$3" -max_total_time=$left -timeout=60 -report_slow_units=60 \
            -rss_limit_mb=4096 -print_final_stats=1 \
            -artifact_prefix="$found/" -reload=0 -close_fd_mask=1 "$now" $seeds >"$log" 2>&1 </dev/null
        status=$?
        times >"$log.after"
        awk '
            FILENAME ~ /(before|after)$/ {
                if (FNR == 2) { gsub("[ms]", " "); time = $1 * 60 + $2 + $3 * 60 + $4 - time }
                next
            }
            /stat::number_of_executed_units/ { runs = $2 }
            / cov: / { for (i = 1; i < NF; i++) if ($i == "cov:") edges = $(i + 1); n = $1; sub(/#/, "", n); last = n }
            END { print (runs ? runs : last + 0), time, edges }' \
            "$log.before" "$log.after" "$log" >>"$build/fuzz-logs/$1"
        rm "$log.before" "$log.after"
        [ $status = 0 ] && break
        cp "$log" "$build/fuzz-logs/$1.broken.$(date +%s).log"
    done
}

if [ "$seconds" = table ]; then
    table
    exit
fi
if [ "$seconds" = turn ]; then
    echo "$corpora" | awk -v turn="$1" '$1 && n++ % 10 == turn % 10 { printf "%s ", $1 }'
    exit
fi
export ASAN_OPTIONS="detect_leaks=1:allocator_may_return_null=1:${ASAN_OPTIONS:-}" \
    UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1"
export LSAN_OPTIONS="suppressions=$root/tests/lsan.supp:print_suppressions=0"
# PROJ's database made small (proj.py)
[ -s "$build/fuzz/proj/proj.db" ] && export PROJ_DATA="$build/fuzz/proj" PROJ_LIB="$build/fuzz/proj"
if [ "${1:-}" = alone ]; then
    # shellcheck disable=SC2046 # a row's words
    fuzz $(echo "$corpora" | awk -v corpus="$2" '$1 == corpus')
    exit
fi
echo "$corpora" | while read -r corpus rest; do
    [ -n "$corpus" ] || continue
    case " $* " in "  "|*" $corpus "*) echo "$corpus";; esac
done | xargs -P "${JOBS:-$(nproc)}" -n 1 sh "$0" "$build" "$seconds" alone
table
[ -z "$(find "$build/findings" -type f 2>/dev/null | head -n 1)" ] || { echo "findings: $build/findings" >&2; exit 1; }
