#!/usr/bin/env bash
# Makes the reports that tests/run.mjs opens: `make.sh SEXTANT FOLDER`, with the program and an empty folder.
set -euo pipefail
program=$(realpath "$1")
folder=$(realpath "$2")
cd "$(dirname "$0")/../../../.."
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
run() { "$program" run "scenarios/$2.toml" --out "$made/$1.mcap" --quiet "${@:3}" >"$made/$1.txt"; }
report() { "$program" report "$1" --out "$folder/$2.html" --quiet; }
run survey smoke
report "$made/survey.mcap" survey
run compare ml-tm/classics
report "$made/compare.mcap" compare
run traffic mac/one-shot-star
report "$made/traffic.mcap" traffic
run network batteries/dying-tree --set duration_s=4200
report "$made/network.mcap" network
run search target/case-1
report "$made/search.mcap" search
"$program" sweep scenarios/mac/poisson-star.toml --runs 2 --out "$made/sweep.csv" --quiet >/dev/null
report "$made/sweep.csv" sweep
"$program" reproduce 3.2 --out "$made/reproduction" --quiet >/dev/null
report "$made/reproduction" reproduction
# Names that other programs would take for code, for the end of a text, or for the order of letters.
mkdir "$made/names"
printf 'stop,x_m,y_m\n1,0,0\n2,4,0\n3,4,4\n4,0,4\n' >"$made/names/stops.csv"
{
    echo "node,stop,rssi_dbm"
    for name in '\u202eedon' '\u05e9\u05dc\u05d5\u05dd\u200f' '\u0085\u0080' '</script><b>' 'a\u2067b' '\\u202e' 'node'; do
        for stop in 1 2 3 4; do printf "\"$name\",%d,-%d\n" "$stop" "$((60 + stop))"; done
    done
} >"$made/names/receptions.csv"
"$program" report "$made/names" --algorithm rssi-centroid --out "$folder/names.html" --quiet
"$program" report "$made/survey.mcap" --algorithm auto --out "$folder/log.html" --quiet
