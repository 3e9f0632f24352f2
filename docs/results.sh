#!/bin/sh
# Makes the results of the reproduction in docs/results again: `docs/results.sh RELEASE_PROGRAM FOLDER`. The tree must have no
# changes. FOLDER gets all runs; if it has them already (`sextant reproduce --all --readings --out FOLDER`, or tables of
# `sextant sweep` with the same names beside a copy of the scenarios), only pages, tables and charts are made, with the pictures
# that are in FOLDER/figures/SCENARIO (`sextant run` of the scenario, then `sextant figure`). Set ONLY to the
# ids that are wanted, to make a part.
set -eu
cd "$(dirname "$0")/.."
[ $# -eq 2 ] || { echo "usage: docs/results.sh RELEASE_PROGRAM FOLDER" >&2; exit 2; }
program=$1 folder=$2
[ -n "${ALLOW_CHANGES-}" ] || [ -z "$(git status --porcelain -- crates scenarios)" ] || { echo "the tree has changes" >&2; exit 1; }
[ -d "$folder/scenarios" ] || "$program" reproduce ${ONLY-"--all"} --readings --quiet --out "$folder" >/dev/null
pages=$(mktemp -d)
trap 'rm -rf "$pages"' EXIT
"$program" reproduce ${ONLY-"--all"} --from "$folder" --quiet --out "$pages/new" >/dev/null
rm -rf docs/results/*.csv docs/results/*.svg docs/results/figures
for file in "$pages"/new/*.md "$pages"/new/*.csv "$pages"/new/*.svg; do
    cp "$file" docs/results/
done
[ ! -d "$pages/new/figures" ] || cp -r "$pages/new/figures" docs/results/
