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
run help --completion bash
offered() { # WORD...: what bash offers for the last of these words
    bash -c 'source ./out; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _nocturne; echo "${COMPREPLY[@]}"' _ "$@"
}
if command -v bash >/dev/null; then
    test "$(offered nocturne comp)" = compare && test "$(offered nocturne render a.gml --method re)" = "reference restir" &&
        test "$(offered nocturne render --jit)" = "" && test "$(offered nocturne render --no-jit)" = "--no-jitter" &&
        test "$(offered nocturne info --met)" = "" && test "$(offered nocturne render --infer)" = --infer-lamps &&
        test "$(offered nocturne render --no-infer)" = --no-infer-lamps && test "$(offered nocturne render --method = re)" = "reference restir" &&
        test "$(offered nocturne render --method = | wc -w)" = 4 && test "$(offered nocturne render builtin : city)" = "city cityscape" &&
        test "$(offered nocturne render builtin : | wc -w)" = 5 && test "$(offered nocturne info builtin)" = builtin:
    result $? "bash completes commands, options and choices"
else
    skip "completion in bash" "bash is not here"
fi
for shell in zsh fish; do
    run help --completion $shell
    if command -v $shell >/dev/null; then
        $shell -n out 2>why; result $? "the completion for $shell is well-formed" "$(head -n 1 why)"
    else
        grep -q -- 'reference is ris restir' out; result $? "the completion for $shell names the choices"
    fi
done
expect "a shell without completion" 2 'bash, zsh and fish' help --completion tcsh
broken=
for page in "$source_dir"/*.md "$source_dir"/docs/*.md; do
    for link in $(grep -o '](\([^)#]*\)' "$page" | sed 's/^](//' | grep -Ev '[:,]|\.(png|jpg)$'); do
        [ -e "$(dirname "$page")/$link" ] || broken="$broken $(basename "$page"):$link"
    done
done
test -z "$broken"; result $? "links between docs lead somewhere" "$broken"
finish
