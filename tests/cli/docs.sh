#!/bin/sh
# Docs that are made from the program, and links between docs, agree with what is there (pictures aside).
. "$(dirname "$0")/lib.sh"
run help --markdown
cmp -s out "$source_dir/docs/options.md"; result $? "docs/options.md is what the tables say" "run tools/update-docs.sh"
broken=
for page in "$source_dir"/*.md "$source_dir"/docs/*.md; do
    for link in $(grep -o '](\([^)#]*\)' "$page" | sed 's/^](//' | grep -Ev '[:,]|\.(png|jpg)$'); do
        [ -e "$(dirname "$page")/$link" ] || broken="$broken $(basename "$page"):$link"
    done
done
test -z "$broken"; result $? "links between docs lead somewhere" "$broken"
finish
