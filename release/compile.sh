#!/usr/bin/env bash
# Builds the program as it is published: profile `dist`, all features, and no path of this machine in it.
#
#   release/compile.sh SOURCE TARGET     the folder of the source, and the one that cargo builds in (TARGET/dist/sextant)
set -euo pipefail
source=$(realpath "$1")
mkdir -p "$2"
target=$(realpath "$2")
cd "$source"
cargo_home=$(realpath "${CARGO_HOME:-$HOME/.cargo}")
sysroot=$(rustc --print sysroot)
# The last one that fits counts, so the folder of the build comes after the one that it may be in.
export RUSTFLAGS="--remap-path-prefix=$cargo_home=/cargo --remap-path-prefix=$sysroot=/rust --remap-path-prefix=$source=/sextant --remap-path-prefix=$target=/target"
export CFLAGS="-ffile-prefix-map=$cargo_home=/cargo -ffile-prefix-map=$source=/sextant -ffile-prefix-map=$target=/target"
export CARGO_INCREMENTAL=0
exec cargo build --profile "${PROFILE:-dist}" --locked --package sextant-cli --all-features --target-dir "$target"
