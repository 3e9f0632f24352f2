#!/usr/bin/env bash
# Compares what the program computes on other machines, octet by octet: recordings, captures, summaries, maps, tables.
#
#   tests/numbers/run.sh [calls] [avx2] [old-processor] [c-library] [aarch64]     all that can run here, if none is named
#
#   calls           the functions of the C library's mathematics that the program calls, and who calls them, are those of calls.txt;
#                   they are those of a release build with default features
#   avx2            the program built for AVX2 and FMA
#   old-processor   the same program on a processor without AVX and FMA (needs qemu-x86_64)
#   c-library       the same program with another C library: SEXTANT_C_LIBRARY names a folder with its ld-linux-x86-64.so.2 and libm.so.6
#   aarch64         the program built for 64-bit ARM (needs qemu-aarch64, aarch64-linux-gnu-gcc and the target of rustup)
#
# SEXTANT names the program that the others are compared with, else target/release/sextant. SCENARIOS names scenarios, else one of each
# kind. Builds go to target/numbers. It takes minutes with the first three, and an hour with emulated processors.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
program=$(realpath "${SEXTANT:-target/release/sextant}")
folder="$PWD/target/numbers"
mkdir -p "$folder"
read -r -a scenarios <<<"${SCENARIOS:-scenarios/smoke.toml scenarios/ml-tm/circular.toml scenarios/ml-tm/classics.toml scenarios/ml-tm/sensitivity.toml \
    scenarios/mmtm/warehouse-vaa.toml scenarios/dmtm/ss-warehouse.toml scenarios/mac/acknowledged-star.toml scenarios/mac/beacon-enabled.toml \
    scenarios/target/case-1.toml scenarios/seek/one-source.toml scenarios/sensing/targets-and-fields.toml docs/examples/walk}"

# wrapped NAME COMMAND..: a program that runs the command.
wrapped() {
    printf '#!/bin/sh\nexec %s "$@"\n' "${*:2}" >"$folder/$1"
    chmod +x "$folder/$1"
    echo "$folder/$1"
}
same() { benches/same_bytes.py "$program" "$1" "${scenarios[@]}" --limit "$2"; }
has() {
    for tool in "${@:2}"; do
        command -v "$tool" >/dev/null || { echo "$1 is left out: $tool is missing"; return 1; }
    done
}

calls() {
    has calls objdump || return 0
    # With the names of functions, which a release build leaves out.
    cargo build --release --locked --package sextant-cli --config 'profile.release.package.sextant-cli.strip="none"'
    "$here/calls.py" target/release/sextant | diff "$here/calls.txt" - && echo "calls of the C library's mathematics are those of calls.txt"
}

avx2() {
    RUSTFLAGS="-C target-feature=+avx2,+fma,+bmi2" cargo build --release --locked --package sextant-cli --target-dir "$folder/avx2"
    same "$folder/avx2/release/sextant" 240
}

old-processor() {
    has old-processor qemu-x86_64 || return 0
    same "$(wrapped old-processor qemu-x86_64 -cpu Nehalem "$program")" 1200
}

c-library() {
    if [ -z "${SEXTANT_C_LIBRARY:-}" ]; then
        echo "c-library is left out: SEXTANT_C_LIBRARY is not set"
        return 0
    fi
    local loader="$SEXTANT_C_LIBRARY/ld-linux-x86-64.so.2" unwinder
    unwinder=$(ldconfig -p | sed -n 's/.*libgcc_s.so.1 (libc6,x86-64) => //p' | head -n 1)
    mkdir -p "$folder/unwinder"
    cp "$unwinder" "$folder/unwinder"
    same "$(wrapped c-library "$loader" --library-path "$SEXTANT_C_LIBRARY:$folder/unwinder" "$program")" 240
}

aarch64() {
    has aarch64 qemu-aarch64 aarch64-linux-gnu-gcc || return 0
    CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc CC_aarch64_unknown_linux_gnu=aarch64-linux-gnu-gcc \
        cargo build --release --locked --package sextant-cli --target aarch64-unknown-linux-gnu --target-dir "$folder/aarch64"
    same "$(wrapped arm qemu-aarch64 -L /usr/aarch64-linux-gnu "$folder/aarch64/aarch64-unknown-linux-gnu/release/sextant")" 1200
}

failed=0
for part in "${@:-calls avx2 old-processor c-library aarch64}"; do
    for name in $part; do
        printf '\n== %s\n' "$name"
        case "$name" in
            calls | avx2 | old-processor | c-library | aarch64) "$name" || failed=1 ;;
            *) echo "\`$name\` is unknown; allowed are calls, avx2, old-processor, c-library and aarch64"; exit 2 ;;
        esac
    done
done
exit "$failed"
