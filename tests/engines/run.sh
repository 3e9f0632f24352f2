#!/usr/bin/env bash
# Does a plan with other engines, as docs/campaigns.md tells, and compares the tables with the local one. An engine that is not
# installed is left out, and is named.
#
#   tests/engines/run.sh
#
# It uses GNU parallel, and the Python packages of tests/engines/requirements.txt for $PYTHON. SEXTANT names the program, else
# target/release/sextant.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
examples="$root/docs/examples/campaigns"
python=${PYTHON:-python3}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The program under its name, as the examples call it.
mkdir "$folder/bin"
ln -s "$(realpath "${SEXTANT:-$root/target/release/sextant}")" "$folder/bin/sextant"
export PATH="$folder/bin:$PATH"
# All engines keep their files here. Ray reports nothing to its makers.
export TMPDIR="$folder" RAY_TMPDIR="$folder/ray" RAY_USAGE_STATS_ENABLED=0
cd "$folder"

scenario="$root/tests/slurm/small.toml"
settings=(--set traffic.beacon.interval_s=0.1 --runs 2 --quiet)
sextant sweep "$scenario" "${settings[@]}" --out local.csv >/dev/null

# line_of_guide PROGRAM: the line of the guide that begins with it.
line_of_guide() { grep -E "^$1 " "$root/docs/campaigns.md" || { echo "the guide has no line with $1" >&2 && exit 1; }; }

failures=0
# engine NAME IS_INSTALLED COMMAND
engine() {
    if ! bash -c "$2" >/dev/null 2>&1; then
        echo "$1: NOT CHECKED, it is not installed"
        return
    fi
    rm -rf study chunks table.csv
    sextant sweep "$scenario" "${settings[@]}" --plan study --no-trial >/dev/null
    bash -c "$(line_of_guide awk)"
    local start=$SECONDS
    if ! bash -c "$3" >engine.log 2>&1; then
        echo "$1: FAILED"
        tail -n 20 engine.log
    elif ! sextant sweep study --collect --out table.csv >/dev/null || ! cmp table.csv local.csv; then
        echo "$1: FAILED, the table is not the local one"
    else
        echo "$1: $(wc -l <study/work.jsonl) runs in $(wc -l <chunks) tasks, the table is the local one ($((SECONDS - start)) s)"
        return
    fi
    failures=$((failures + 1))
}

engine "GNU parallel" "parallel --version" "$(line_of_guide parallel)"
engine "Ray" "$python -c 'import ray'" "$python $examples/cells_ray.py study chunks"
engine "Dask" "$python -c 'import dask.distributed'" "$python $examples/cells_dask.py study chunks"
engine "HyperQueue (the script, submitted by its library)" "$python -c 'import hyperqueue'" "$python $here/hyperqueue_script.py $examples/hyperqueue.sh"
engine "HTCondor (the file, read by its library; the jobs run without it)" "$python -c 'import htcondor2'" "$python $here/htcondor_jobs.py $examples/htcondor.sub"
[ $failures -eq 0 ]
