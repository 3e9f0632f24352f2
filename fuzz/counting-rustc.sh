#!/usr/bin/env bash
# The compiler for our crates: it counts how often each edge of the code is taken, as `cargo fuzz` asks it to. No sanitizer is on,
# because that needs nightly. Other crates are not counted, so that they are built and run faster.
set -euo pipefail
options=(-Cpasses=sancov-module)
for option in level=4 inline-8bit-counters pc-table trace-compares; do
    options+=("-Cllvm-args=-sanitizer-coverage-$option")
done
exec "$@" "${options[@]}"
