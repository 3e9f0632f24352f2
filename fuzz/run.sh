#!/usr/bin/env bash
# Fuzzing on stable Rust, guided by coverage: looks for inputs that break a property of a target.
#   fuzz/run.sh [TARGET..] [--seconds N] [--executions N] [--jobs N]
#   fuzz/run.sh --build | --merge
# Without targets, all are run, each for a minute, as many at a time as there are cores. Inputs that reach new code go to
# target/fuzz/found/TARGET, and those that break a property to fuzz/crashes/TARGET. `--executions N` ends a target after so many
# executions instead of a time. `--build` builds the program alone. `--merge` adds the inputs in target/fuzz/found that reach
# what the corpus does not. Needs a C++ compiler, for libFuzzer.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=60
executions=
jobs=$(nproc)
action=fuzz
targets=()
while [ $# -gt 0 ]; do
    case "$1" in
        --seconds) seconds="$2"; shift ;;
        --executions) executions="$2"; shift ;;
        --jobs) jobs="$2"; shift ;;
        --build | --merge) action="${1#--}" ;;
        -*) echo "$1 is not an option; allowed: --seconds N, --executions N, --jobs N, --build, --merge"; exit 2 ;;
        *) targets+=("$1") ;;
    esac
    shift
done
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls fuzz/corpus)

program="${SEXTANT_FUZZ_PROGRAM:-}"
if [ -z "$program" ]; then
    # Build scripts are no part of it, because the triple is given.
    triple=$(rustc -vV | sed -n 's/^host: //p')
    RUSTFLAGS="--cfg fuzzing" RUSTC_WORKSPACE_WRAPPER="$PWD/fuzz/counting-rustc.sh" \
        cargo build --profile fuzz --locked -p sextant-fuzz --target "$triple" --target-dir target/fuzz
    program="$PWD/target/fuzz/$triple/fuzz/sextant-fuzz"
fi
[ "$action" != build ] || exit 0

# Temporary files are in memory where that can be.
memory=/dev/shm
[ -w "$memory" ] || memory=${TMPDIR:-/tmp}
scratch=$(mktemp -d "$memory/sextant-fuzz.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

# libfuzzer TARGET ARGUMENT..: the program for a target.
libfuzzer() {
    local target="$1"
    shift
    mkdir -p "$scratch/$target" "target/fuzz/found/$target"
    SEXTANT_FUZZ_TARGET="$target" TMPDIR="$scratch/$target" "$program" -timeout=60 -rss_limit_mb=4096 "$@"
}

# figure LOG WORD: what libFuzzer said at its end.
figure() { sed -n "s/^stat::$2: *//p" "$1"; }

# fuzz_one TARGET: runs it, and prints its figures or the input that it found.
fuzz_one() {
    local target="$1" log="target/fuzz/$1.log" found="target/fuzz/found/$1" end="-max_total_time=$seconds"
    [ -z "$executions" ] || end="-runs=$executions"
    local options=("$end" -print_final_stats=1 "-artifact_prefix=$scratch/$target/")
    [ ! -f "fuzz/words/$target.dict" ] || options+=("-dict=fuzz/words/$target.dict")
    if libfuzzer "$target" "${options[@]}" "$found" "fuzz/corpus/$target" >"$log" 2>&1; then
        printf '%-12s %12s executions %8s/s %8s edges\n' "$target" "$(figure "$log" number_of_executed_units)" \
            "$(figure "$log" average_exec_per_sec)" "$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)"
        return
    fi
    local input kept
    input=$(find "$scratch/$target" -maxdepth 1 -type f \( -name 'crash-*' -o -name 'timeout-*' -o -name 'oom-*' \) | head -n 1)
    tail -n 40 "$log"
    if [ -n "$input" ]; then
        mkdir -p "fuzz/crashes/$target"
        kept="fuzz/crashes/$target/$(basename "$input")"
        cp "$input" "$kept"
        printf '\n%s breaks a property of the target %s. To replay it:\n  cargo run -p sextant-fuzz -- %s %s\n' \
            "$kept" "$target" "$target" "$kept"
    fi
    return 1
}

# merge_one TARGET: the corpus gets what was found and reaches new code.
merge_one() {
    libfuzzer "$1" -merge=1 "fuzz/corpus/$1" "target/fuzz/found/$1" 2>&1 | tail -n 1
}

failed=0
if [ "$action" = merge ]; then
    for target in "${targets[@]}"; do merge_one "$target"; done
else
    running=0
    for target in "${targets[@]}"; do
        if [ "$running" -ge "$jobs" ]; then
            wait -n || failed=1
            running=$((running - 1))
        fi
        fuzz_one "$target" &
        running=$((running + 1))
    done
    while [ "$running" -gt 0 ]; do
        wait -n || failed=1
        running=$((running - 1))
    done
fi
exit "$failed"
