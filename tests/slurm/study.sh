# What run.sh does with studies. A study is a folder of $folder; its local table is in $folder/tables.

step() { printf '\n-- %s\n' "$1"; }
fail() {
    echo "FAILED: $1" >&2
    exit 1
}

# local_table SCENARIO: the table that this machine gives without a cluster.
local_table() {
    mkdir -p "$folder/tables"
    "$sextant" sweep "$here/$1.toml" --out "$folder/tables/$1.csv" --quiet >/dev/null
    echo "$1: $(($(wc -l <"$folder/tables/$1.csv") - 1)) rows"
}

# plan SCENARIO STUDY
plan() {
    "$sextant" sweep "$here/$1.toml" --plan "$folder/$2" --no-trial | head -n 1
    [ "$(wc -l <"$folder/$2/work.jsonl")" -eq "$(($(wc -l <"$folder/tables/$1.csv") - 1))" ] ||
        fail "the work list of $2 has other rows than the table"
}

# submit STUDY FLAG..: sets $job, the number of the first array.
submit() {
    local printed
    printed=$("$sextant" sweep "$folder/$1" --submit slurm "${@:2}")
    echo "$printed"
    job=$(sed -nE 's/.*: job ([0-9]+).*/\1/p' <<<"$printed")
}

resume() { "$sextant" sweep "$folder/$1" --resume; }
status() { "$sextant" sweep "$folder/$1" --status; }
submissions() { find "$folder/$1/slurm" -mindepth 1 -maxdepth 1 -type d | wc -l; }

# has_done STUDY N: whether at least N cells are done.
has_done() {
    local status
    status=$("$sextant" sweep "$folder/$1" --status --format json)
    [ "$(grep -oE '"done": *[0-9]+' <<<"$status" | grep -oE '[0-9]+')" -ge "$2" ]
}

# wait_until_idle STUDY SECONDS: until no job of a study is left.
wait_until_idle() { wait_for "$2" "the jobs of $1" has_no_job "$1"; }
has_no_job() { ! squeue --noheader --format %o | grep -qF "$folder/$1/"; }
job_is() { scontrol show job "$1" | grep -q "JobState=$2"; }
# runs_tasks NODE N
runs_tasks() { [ "$(squeue --noheader --array --nodelist "$1" --states R | wc -l)" -ge "$2" ]; }
runs_processes() { [ -n "$(node_processes "$1")" ]; }
node_is_up() { [[ "$(node_state "$1")" =~ ^(idle|mixed|allocated)$ ]]; }

# compare STUDY SCENARIO: the collected table is the local one, byte for byte, and no cell is there twice.
compare() {
    "$sextant" sweep "$folder/$1" --collect --out "$folder/$1.csv" --quiet >/dev/null
    [ -z "$(cut -d, -f1-3 "$folder/$1.csv" | sort | uniq -d)" ] || fail "a cell is there twice"
    cmp "$folder/$1.csv" "$folder/tables/$2.csv" || fail "the tables differ"
    sha256sum "$folder/$1.csv" "$folder/tables/$2.csv" | sed "s|$folder/||"
}

# What helps to understand a failure.
show_logs() {
    squeue --array || true
    tail -n 12 "$cluster"/log/{start,slurmctld,slurmd-a,slurmd-b} || true
    find "$folder" -path '*/slurm/*' -name '*.log' -size +0 -exec tail -n 5 {} + | tail -n 60 || true
}
