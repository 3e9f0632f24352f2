#!/usr/bin/env bash
# Builds the program twice, in two folders, and compares the two octet by octet.
#
#   release/reproducible.sh              profile dist: about half an hour on two cores
#   PROFILE=dev release/reproducible.sh  a quick look
#
# Both builds are of the last commit. What is equal there is equal on each machine with the same compilers.
set -euo pipefail
cd "$(dirname "$0")/.."
profile=${PROFILE:-dist}
output=${profile/#dev/debug}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH

for place in here another/place/with/a/longer/name; do
    mkdir -p "$folder/$place"
    git archive HEAD | tar --extract --directory "$folder/$place"
    release/compile.sh "$folder/$place" "$folder/$place/target"
    cp "$folder/$place/target/$output/sextant" "$folder/${place%%/*}-sextant"
    rm -r "$folder/$place/target"
done
sha256sum "$folder"/*-sextant
if strings -a "$folder/here-sextant" | grep -F -e "$folder" -e "${CARGO_HOME:-$HOME/.cargo}" | head -n 5 | grep .; then
    echo "the program names folders of this machine"
    exit 1
fi
cmp "$folder/here-sextant" "$folder/another-sextant" && echo "the two builds are equal"
