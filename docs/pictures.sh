#!/usr/bin/env bash
# Draws the pictures of the guide's chapters into docs/pictures/, or into the folder $1. $SEXTANT names the program.
# Those of the algorithms' pages are drawn by docs/pictures/algorithms.sh.
# The same program draws the same bytes: after a change that alters a picture, run this and look at what changed.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
mkdir -p "${1:-docs/pictures}"
out=$(cd "${1:-docs/pictures}" && pwd)
sextant=${SEXTANT:-$root/target/release/sextant}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
ln -s "$root/scenarios" "$work/scenarios"
cd "$work"

# files PAGE: writes the files that a page of the guide shows.
files() {
    awk '/^<!-- (file|append): / { name = $3; if ($2 == "file:") printf "" > name; next }
         /^```/ { if (inside) { inside = 0; close(name); name = "" } else if (name != "") inside = 1; next }
         inside { print >> name }' "$root/docs/$1"
}

# run SCENARIO [OPTION..]: its recording and the figures of that, in NAME.figures.
run() {
    local name
    name=$(basename "$1" .toml)
    "$sextant" run "$@" --quiet --out "$name.mcap" > /dev/null
    "$sextant" figure "$name.mcap" --out "$name.figures" > /dev/null
}

# keep FIGURE PICTURE
keep() {
    cp "$1.svg" "$out/$2.svg"
}

run scenarios/ml-tm/circular.toml
keep circular.figures/network circular-network
keep circular.figures/map-ml-tm circular-map
run scenarios/smoke.toml
keep smoke.figures/map-ml-tm smoke-map
run scenarios/routing/collection-tree.toml
keep collection-tree.figures/tree collection-tree
run scenarios/batteries/slots-tree.toml --set recording.packets=true --set recording.frames=true --set duration_s=3600
keep slots-tree.figures/time-line slots-time-line
run scenarios/sleep/csl-corridor.toml --set recording.packets=true --set recording.frames=true
keep csl-corridor.figures/time-line sleep-time-line
"$sextant" init network --out network.toml > /dev/null
run network.toml
keep network.figures/tree-changes network-tree-changes
run scenarios/ml-tm/two-robots.toml
keep two-robots.figures/network two-robots-network

mkdir -p my-log
files tutorial.md
run hall.toml --set radio.tx_power_dbm=-25
keep hall.figures/map-self-calibrated tutorial-map
"$sextant" sweep hall.toml --out power.csv --quiet > /dev/null
"$sextant" figure power.csv --out power.figures > /dev/null
keep power.figures/power-position_error_m-mean tutorial-power
"$sextant" map my-log --figure log.figures --quiet > /dev/null
keep log.figures/map-auto tutorial-log

files robots.md
run spiral.toml
keep spiral.figures/network spiral-network

"$sextant" map "$root/docs/examples/uwb" --truth "$root/docs/examples/uwb/nodes.csv" --estimate-path --figure uwb.figures --quiet > /dev/null 2>&1
keep uwb.figures/network uwb-path

"$sextant" init building --out building.toml > /dev/null
run building.toml
keep building.figures/network building-network
run scenarios/ranges/odometry-drift.toml
keep odometry-drift.figures/map-believed ranges-believed
keep odometry-drift.figures/map-estimated ranges-estimated

"$sextant" sweep scenarios/mac/hidden-nodes.toml --out hidden.csv --runs 3 --quiet > /dev/null
"$sextant" figure hidden.csv --out hidden.figures > /dev/null
keep hidden.figures/hidden-mac-prr hidden-prr
