#!/bin/sh
# Writes docs/options.md from the option tables.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
"${1:-$root/build/nocturne}" help --markdown >"$root/docs/options.md.new"
mv "$root/docs/options.md.new" "$root/docs/options.md"
