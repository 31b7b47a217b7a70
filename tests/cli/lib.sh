# Sourced by the tests of the program: runs it, looks at what it says, and prints TAP.
# NOC_PROGRAM is the program; the working folder is a fresh one that goes away at the end.
set -u
program=${NOC_PROGRAM:?names the program to test}
source_dir=${NOC_SOURCE:?names the source folder}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
count=0 failed=0

# result STATUS NAME [WHY]: one line of TAP
result() {
    count=$((count + 1))
    if [ "$1" = 0 ]; then
        echo "ok $count - $2"
    else
        failed=$((failed + 1))
        echo "not ok $count - $2"
        [ -n "${3:-}" ] && echo "# $3"
        for f in out err; do
            [ -s $f ] && sed "s/^/# $f: /" $f | head -n 20 | tr -cd '\11\12\40-\176'
        done
    fi
    return 0
}

skip() { count=$((count + 1)); echo "ok $count - $1 # SKIP $2"; }

# run ARGUMENT...: the program's output in out and err, its status in $status. Signs of life, which depend on how busy
# the machine is, are left out of err.
run() {
    "$program" "$@" >out 2>err </dev/null
    status=$?
    sed -i '/^nocturne: [0-9]\{1,3\} %, /d' err
}

# start ARGUMENT...: the program in the background, as $pid. What it prints cannot be taken for the last one's. A shell
# makes its background jobs ignore SIGINT, and nohup SIGHUP; what is ignored stays so.
start() {
    rm -f out err
    env --default-signal=HUP,INT,TERM "$program" "$@" >out 2>err </dev/null &
    pid=$!
}

# expect NAME STATUS PATTERN ARGUMENT...: ends with this status, and says what matches the (extended) pattern on stderr
expect() {
    name=$1 expected=$2 pattern=$3
    shift 3
    run "$@"
    why=
    [ "$status" = "$expected" ] || why="status $status, not $expected"
    grep -Eq -- "$pattern" err || why="$why; stderr does not say: $pattern"
    [ -z "$why" ]; result $? "$name" "$why"
}

# meta FILE KEY: a text chunk of a PNG, or its "size"; fails where the file is not a whole PNG
meta() { python3 "$source_dir/tests/cli/png_text.py" "$@"; }

# lamp_model: lamp.obj and lamp.mtl, a floor of 10 x 10 m and a lamp of 1 x 1 m that faces it, 2 m above; y is up
lamp_model() {
    cat >lamp.obj <<'OBJ'
mtllib lamp.mtl
v -5 0 -5
v 5 0 -5
v 5 0 5
v -5 0 5
v -.5 2 -.5
v .5 2 -.5
v .5 2 .5
v -.5 2 .5
usemtl floor
f 4 3 2 1
usemtl lamp
f 5 6 7 8
OBJ
    printf 'newmtl floor\nKd .5 .5 .5\nnewmtl lamp\nKd 0 0 0\nKe 40 40 40\n' >lamp.mtl
}

finish() {
    echo "1..$count"
    [ "$failed" = 0 ]
    exit
}
