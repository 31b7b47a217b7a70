#!/bin/sh
# Docs that are made from the program, and links between docs, agree with what is there (pictures aside).
. "$(dirname "$0")/lib.sh"
run help --markdown
cmp -s out "$source_dir/docs/options.md"; result $? "docs/options.md is what the tables say" "run tools/update-docs.sh"
run help --man
if command -v groff >/dev/null; then
    groff -man -Tutf8 -ww out 2>warnings | grep -q 'where light candidates come from' && test ! -s warnings
    result $? "the manual page is one that groff takes without a warning" "$(head -n 1 warnings)"
else
    skip "the manual page" "groff is not here"
fi
# The completion for fish is written without a buffer. What it says of an option stands in each of the other texts,
# whole.
cat >whole.py <<'PY'
import re, subprocess, sys
def text(*words):
    return subprocess.run([sys.argv[1], "help", *words], check=True, capture_output=True, text=True).stdout
def flat(s):
    return " ".join(s.split())
pages = {"options.md": flat(text("--markdown")), "man": flat(text("--man").replace("\\-", "-").replace("\\e", "\\"))}
checked = lost = 0
for line in text("--completion", "fish").splitlines():
    m = re.match(r"complete -c nocturne -n '__nocturne_at (\w+)' -l (\S+).*?(?: -a '([^']*)')? -d '(.*)'$", line)
    if not m:
        continue
    command, name, words, said = m[1], m[2], (m[3] or "").split(), flat(re.sub(r"\\(.)", r"\1", m[4]))
    checked += 1
    places = dict(pages, help=flat(text(command)))
    for place, page in places.items():
        wanted = [said]
        if words:
            joined = "|".join(words) if place == "help" else ", ".join(words)
            wanted.append(joined if place == "options.md" else said + ": " + joined)
        if place == "help": # lines break behind bars too
            page, wanted = page.replace("| ", "|"), [w.replace("| ", "|") for w in wanted]
        for w in wanted:
            if w not in page:
                print("%s: %s of %s: \"%s\" is not there" % (place, name, command, w))
                lost += 1
sys.exit(lost > 0 or checked < 100)
PY
python3 whole.py "$program" >why
result $? "help, manual page and options.md tell each option and all its choices" "$(head -n 1 why)"
# A number that an option has by default has a row in defaults.md, and the row has that number. What changes no
# luminance but by its noise is named here, by group or by name.
cat >rows.py <<'PY'
import re, sys
apart = ["Estimator", "Reuse (restir)", "Device", "Reading", "Built-in scenes", "Output", "Mode", "Animation", "Viewer",
         "Bench", "General"]
effort = ["time"]
rows = {}
for line in open(sys.argv[2]):
    cells = [c.strip() for c in line.split("|")]
    for name in re.findall("`--([a-z-]+)`", cells[1]) if len(cells) > 4 else []:
        rows.setdefault(name, []).append(cells[2].replace(",", ""))
group, found, lost = "", 0, 0
for line in open(sys.argv[1]):
    group = line[4:].strip() if line.startswith("### ") else group
    cells = [c.strip() for c in line.split("|")]
    name = re.match("`(?:-., )?--([a-z-]+)", cells[1]) if len(cells) > 5 else None
    if not name or not re.fullmatch("-?[0-9.e+-]+", cells[3]) or group in apart:
        continue
    if name[1].endswith("seed") or name[1] in effort:
        continue
    found += 1
    default = re.compile(r"(?<![0-9.])" + re.escape(cells[3]) + r"(?![0-9.])")
    if not any(default.search(row) for row in rows.get(name[1], [])):
        print("--%s (%s): no row with its default, %s" % (name[1], group, cells[3]))
        lost += 1
sys.exit(lost > 0 or found < 100)
PY
python3 rows.py "$source_dir/docs/options.md" "$source_dir/docs/defaults.md" >why
result $? "docs/defaults.md has each number that figures hang on" "$(head -n 1 why)"
grep -v -e '--window-cell' "$source_dir/docs/defaults.md" >fewer.md
python3 rows.py "$source_dir/docs/options.md" fewer.md >why
test $? = 1 && grep -q -e '--window-cell (Windows): no row' why
result $? "and would be missed if it had not" "$(cat why)"
sed 's/| 2\.4 m |/| 2.5 m |/' "$source_dir/docs/defaults.md" >other.md
python3 rows.py "$source_dir/docs/options.md" other.md >why
test $? = 1 && grep -q 'no row with its default, 2.4' why; result $? "as would another number" "$(cat why)"
for shell in bash zsh fish; do
    mkdir -p $shell && "$program" help --completion $shell >$shell/_nocturne
    if command -v $shell >/dev/null; then
        $shell -n $shell/_nocturne 2>why; result $? "the completion for $shell is well-formed" "$(head -n 1 why)"
    else
        grep -q -- 'reference is ris restir' $shell/_nocturne; result $? "the completion for $shell names the choices"
    fi
done

# What shells offer at the end of a line, in a folder of two files and another folder: "LINE: WORDS".
mkdir files home
: >files/city.gml
: >files/berlin.gml
mkdir files/folder
cat >offers <<'OFFERS'
nocturne comp: compare
nocturne : bench build compare devices experiment help influence info init measure render view
nocturne help co: compare
nocturne render --method re: reference restir
nocturne render --method=re: reference restir
nocturne render --method=: headlight is reference restir ris
nocturne render --method : headlight is reference restir ris
nocturne render --jit:
nocturne render --no-jit: --no-jitter
nocturne info --met:
nocturne render --infer: --infer-lamps
nocturne render --no-infer: --no-infer-lamps
nocturne render builtin:city: city cityscape
nocturne render builtin:: atrium city cityscape mess single
nocturne render --width :
nocturne render --width=:
nocturne render --crs :
nocturne render ci: city.gml
nocturne render city.gml fo: folder
nocturne render -o : berlin.gml city.gml folder
nocturne render --lamps ber: berlin.gml
nocturne compare b: berlin.gml
nocturne compare ren:
nocturne compare --ce: --ceiling
nocturne experiment -o : berlin.gml city.gml folder
OFFERS
sed 's/: *[^:]*$//' offers >lines
# SHELL_offers: what the shell offers for the lines of its input, a line each
bash_offers() {
    bash -c 'source ../bash/_nocturne
        compopt() { [ "$1$2" = +odefault ] && default=; }
        while IFS= read -r line; do
            split=${line//=/ = }
            COMP_WORDS=(${split//:/ : }) default=yes
            [[ $line == *" " ]] && COMP_WORDS+=("")
            COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
            _nocturne
            [ ${#COMPREPLY[@]} = 0 ] && [ "$default" ] &&
                mapfile -t COMPREPLY < <(compgen -f -- "${COMP_WORDS[COMP_CWORD]#=}")
            echo ${COMPREPLY[@]}
        done'
}
fish_offers() { # fuzzy matches, which it has where nothing begins so, are its own
    HOME=$work/home XDG_CONFIG_HOME=$work/home XDG_DATA_HOME=$work/home fish --no-config -c 'source ../fish/_nocturne
        while read -l line
            set -l word (string match -r "[^ ]*\$" -- $line)
            set -l hits (complete -C $line | string replace -r "\t.*" "" | string match -- "$word*")
            echo $hits
        end'
}
zsh_offers() { zsh "$source_dir/tests/cli/zsh_offers.zsh" "$work/zsh"; }
same_words() { # each line sorted, without what stands before a value, and without a folder's slash
    while IFS= read -r line; do
        for word in $line; do
            case $word in --*=*) word=${word#*=} ;; builtin:?*) word=${word#builtin:} ;; esac
            echo "${word%/}"
        done | LC_ALL=C sort -u | tr '\n' ' '
        echo
    done
}
sed 's/.*: *//' offers >wanted
for command in render info compare experiment bench; do # all its options, as its help has them
    echo "nocturne $command --" >>lines
    "$program" help $command | grep -o -- '^  \(-., \)\?--[^ ]*' |
        sed -e 's/.*--/--/' -e 's/--\[no-\]\(infer-lamps\|map-surfaces\|mp4\|scene\|traffic\|windows\)/--\1 --no-\1/' \
            -e 's/\[no-\]/no-/' |
        tr '\n' ' ' >>wanted
    echo >>wanted
done
same_words <wanted >expected
for shell in bash zsh fish; do
    if ! command -v $shell >/dev/null; then
        skip "completion in $shell" "$shell is not here"
        continue
    fi
    (cd files && ${shell}_offers) <lines | same_words >$shell/offers
    cmp -s $shell/offers expected
    result $? "$shell completes commands, options, choices, built-in scenes and files" "$(diff $shell/offers expected |
        head -n 6)"
done
expect "a shell without completion" 2 'bash, zsh and fish' help --completion tcsh
mkdir drawn
python3 "$source_dir/tools/draw-frame.py" "$NOC_BUILD" drawn && for frame in drawn/*.svg; do
    cmp -s "$frame" "$source_dir/docs/$(basename "$frame")" || echo "$frame"
done >why
test -s drawn/frame-lists.svg && test ! -s why
result $? "pictures of a frame are what render/plan.c says" "run tools/draw-frame.py: $(cat why)"
# Links between pages: each file is there, and each heading. A page of links that are broken is told so.
links="python3 $source_dir/tests/cli/doc_links.py"
$links "$source_dir"/*.md "$source_dir"/docs/*.md >why; result $? "links between docs lead somewhere" "$(head -n 3 why)"
printf '# One two\n\n' >page.md
for i in 1 2 3 4 5 6 7 8 9 10; do printf '[a](page.md#one-two) [b](#one-two) `[c](nowhere.md)`\n' >>page.md; done
$links page.md >why; result $? "and such links are understood" "$(head -n 3 why)"
printf '[a](nowhere.md) [b](#three)\n' >>page.md
$links page.md >why
test $? = 1 && test "$(cat why)" = "page.md: nowhere.md: no such file
page.md: #three: no such heading"; result $? "and told where they lead nowhere" "$(cat why)"
finish
