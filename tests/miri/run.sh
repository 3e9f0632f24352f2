#!/usr/bin/env bash
# Interprets tests of the lowest crates with Miri, which finds undefined behaviour, in their dependencies too.
#
#   tests/miri/run.sh [kernel] [channel] [mac]      all three, if none is named
#
# It needs a nightly toolchain: `rustup toolchain install nightly --component miri,rust-src`. Tests of millions of steps are left out,
# because Miri takes a thousand times as long; properties are tried with two cases each.
set -euo pipefail
cd "$(dirname "$0")/../.."
cargo +nightly miri --version || { echo "Miri is missing; install it with: rustup toolchain install nightly --component miri,rust-src"; exit 1; }
# Proptest looks for the file of earlier failures.
export MIRIFLAGS="-Zmiri-disable-isolation" PROPTEST_CASES=2 PROPTEST_DISABLE_FAILURE_PERSISTENCE=true

# left_out CRATE: the tests whose names hold one of these words take minutes.
left_out() {
    sed -n "s/^$1 //p" tests/miri/left_out.txt
}

for crate in "${@:-kernel channel mac}"; do
    for name in $crate; do
        skips=()
        while read -r word; do skips+=(--skip "$word"); done < <(left_out "$name")
        printf '\n== %s\n' "$name"
        # The square root of libm is assembly, which Miri cannot interpret, unless it is computed.
        cargo +nightly miri test --package "sextant-$name" --all-features --features libm/force-soft-floats --lib --locked \
            --target-dir target/miri -- "${skips[@]}"
    done
done
