#!/usr/bin/env bash
# Draws the pictures of docs/algorithms/ from small scenarios, or into the folder $1. $SEXTANT names the program.
# The same program draws the same bytes: after a change that alters a picture, run this and look at what changed.
set -euo pipefail
cd "$(dirname "$0")/../.."
sextant=${SEXTANT:-target/release/sextant}
scenarios=docs/pictures
out=${1:-docs/algorithms/pictures}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$out"

# simulate SCENARIO: its recording, and the figures of that.
simulate() {
    local name
    name=$(basename "$1" .toml)
    "$sextant" run "$1" --out "$work/$name.mcap" --quiet > "$work/$name.txt"
    "$sextant" figure "$work/$name.mcap" --out "$work/$name" > /dev/null
}

# map RECORDING ALGORITHM: the figures of a map of a recorded log.
map() {
    "$sextant" map "$work/$1.mcap" --algorithm "$2" --figure "$work/$1-$2" --quiet > /dev/null
}

# keep FIGURE PICTURE
keep() {
    cp "$work/$1.svg" "$out/$2.svg"
}

simulate "$scenarios/planar.toml"
keep planar/network network
for name in ml-tm tpm smacof rss-ml rss-grid rssi-triangle-centroid least-squares dv-hop; do
    keep "planar/map-$name" "$name"
done
keep planar/likelihood-ml-tm-n70 ml-tm-likelihood
map planar ml-tm
keep planar-ml-tm/curve-ml-tm fitted-curve

simulate "$scenarios/walls.toml"
map walls self-calibrated
keep walls-self-calibrated/map-self-calibrated self-calibrated
keep walls-self-calibrated/curve-self-calibrated self-calibrated-curve

simulate "$scenarios/linked.toml"
map linked link-model
keep linked-link-model/map-link-model link-model
map linked packet-centroid
keep linked-packet-centroid/map-packet-centroid packet-centroid

simulate "$scenarios/bands.toml"
keep bands/sectors sectors
keep bands/map-mmtm mmtm
keep bands/map-joint joint

simulate "$scenarios/nodes.toml"
keep nodes/map-dmmtm-ss dmmtm-ss
simulate "$scenarios/nodes-improved.toml"
keep nodes-improved/map-dmmtm-ss dmmtm-improved
simulate "$scenarios/nodes-mobile.toml"
keep nodes-mobile/map-dmmtm-hs dmmtm-hs

simulate scenarios/target/case-3.toml
keep case-3/application-detarsk detarsk
keep case-3/application-p-g p-g

simulate "$scenarios/seek.toml"
keep seek/application-level-set level-set
keep seek/application-level-set-thesis level-set-thesis
keep seek/application-gradient gradient

for path in s spiral hilbert random; do
    simulate "scenarios/ml-tm/trajectory-$path.toml"
    keep "trajectory-$path/network" "path-$path"
done
