#!/usr/bin/env bash
# Runs studies on a real Slurm cluster of this machine, breaks nodes, jobs and disks, and compares the tables with local ones.
#
#   tests/slurm/run.sh [--install]
#
# With --install, or if CI is set, Slurm is installed from Debian's packages where it is missing. Where it is missing and cannot
# be installed, nothing is checked: the script says so and ends with 0. SEXTANT names the program, else target/release/sextant.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
sextant=$(realpath "${SEXTANT:-$here/../../target/release/sextant}")
. "$here/cluster.sh"
. "$here/study.sh"

folder=$(mktemp -d)
chmod 711 "$folder" # munge wants others to reach its socket
full_disk=""
clean() {
    local result=$?
    trap - EXIT INT TERM HUP
    if [ $result -ne 0 ] && [ -n "${cluster:-}" ]; then show_logs; fi
    cluster_stop
    if [ -n "$full_disk" ]; then umount "$full_disk" || true; fi
    rm -rf "$folder"
    exit $result
}
trap clean EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

if [ -n "$(cluster_lacks)" ] && { [ -n "${CI:-}" ] || [ "${1:-}" = --install ]; }; then
    cluster_install "$folder/install.log" || tail -n 3 "$folder/install.log"
fi
if [ -n "$(cluster_lacks)" ]; then
    echo "Slurm: NOT CHECKED, this machine lacks $(cluster_lacks)"
    echo "install it with: apt-get install ${cluster_packages[*]}"
    exit 0
fi

step "local tables"
local_table study
local_table small

step "a cluster with the nodes a and b"
cluster_start "$folder/cluster"
sbatch --version
sinfo

step "a job with more work than time, on node b"
plan study limited
submit limited --chunk 64 --time 0:05 --option=--nodelist=b
limited_job=$job
wait_for 30 "the job to start" job_is "$limited_job" RUNNING
sleep 5
# Its cells take for ever: the job is stopped, and Slurm ends it at its limit, which it rounds to a minute.
scancel --signal=STOP --full "$limited_job"
scontrol show job "$limited_job" | grep -o 'TimeLimit=[^ ]*'

step "a node dies in the middle"
plan study dying
submit dying --chunk 4
wait_for 60 "the middle of the study" has_done dying 12
wait_for 20 "jobs on node a" runs_tasks a 2
echo "jobs of node a when it dies: $(squeue --noheader --array --nodelist a --states R --format %F_%K | xargs)"
node_kill a
if runs_processes a; then fail "processes of node a survived"; fi
echo "node a was killed with its jobs at $(date +%T)"
status dying
wait_until_idle dying 120
echo "what the controller saw:"
grep -E 'not responding|due to failure of node' "$cluster/log/slurmctld" | cut -c1-120
grep -q 'requeue job .* due to failure of node a' "$cluster/log/slurmctld" || fail "no job was started again"
status dying
has_done dying 64 || fail "cells are missing"
compare dying study

step "the dead node returns"
node_start a
wait_for 30 "node a" node_is_up a
sinfo

step "a job is told to end (SIGTERM, as before preemption)"
plan small ended
submit ended --chunk 8
wait_for 30 "the job to start" job_is "$job" RUNNING
sleep 2
scancel --signal=TERM --full "$job"
wait_until_idle ended 30
scontrol show job "$job" | grep -oE '(JobState|ExitCode)=[^ ]*' | tr '\n' ' '
echo
scontrol show job "$job" | grep -q 'ExitCode=75:0' || fail "the exit code is not 75"
status ended
if has_done ended 8; then fail "the job came to its end before it was told to"; fi
resume ended
wait_until_idle ended 60
compare ended small

step "a full disk"
plan small full
mkdir -p "$folder/full/parts"
if mount -t tmpfs -o size=64k sextant-test "$folder/full/parts" 2>"$folder/mount.log"; then
    full_disk="$folder/full/parts"
    # Room for two pages. The file looks like one that is being written, which is no part.
    head -c 56k /dev/zero >"$full_disk/filler.part"
    submit full --chunk 1 --max-running 2
    wait_until_idle full 60
    df --output=size,used,avail "$full_disk"
    status full
    echo "what the jobs printed:"
    cat "$folder"/full/slurm/000001/*.log | sort | uniq -c
    if has_done full 8; then fail "the disk was not full"; fi
    rm "$full_disk/filler.part"
    resume full
    wait_until_idle full 60
    compare full small
else
    echo "NOT CHECKED, no file system can be mounted here: $(head -n 1 "$folder/mount.log")"
fi

step "jobs are cancelled; two go on at once"
plan small twice
submit twice --chunk 1 --max-running 1
wait_for 60 "a part" has_done twice 1
"$sextant" sweep "$folder/twice" --cancel
wait_until_idle twice 30
status twice
if has_done twice 8; then fail "nothing was cancelled"; fi
before=$(submissions twice)
for one in 1 2; do
    { "$sextant" sweep "$folder/twice" --resume >"$folder/resume-$one.log" 2>&1 && echo 0 || echo $?; } >"$folder/resume-$one.code" &
    resumes[one]=$!
done
wait "${resumes[@]}"
for one in 1 2; do
    echo "resume $one ended with $(cat "$folder/resume-$one.code"):"
    sed 's/^/  /' "$folder/resume-$one.log"
done
[ "$(submissions twice)" -eq $((before + 1)) ] || fail "both submitted"
wait_until_idle twice 60
status twice
compare twice small

step "a map in tiles: an array makes them, and a job joins them"
"$sextant" run "$here/../../scenarios/ml-tm/circular.toml" --out "$folder/run.mcap" --quiet >/dev/null
map() { "$sextant" map "$folder/run.mcap" --algorithm ml-tm --quiet "$@"; }
map --out "$folder/whole.csv" >/dev/null
map --tiles 6 --keep-tiles "$folder/tiles" --out "$folder/tiled.csv" --submit slurm --chunk 2
wait_for 60 "the map" test -s "$folder/tiled.csv"
find "$folder/tiles" -name '*.csv' | sed "s|$folder/||" | sort
[ "$(find "$folder/tiles/ml-tm" -name '*.csv' | wc -l)" -eq 6 ] || fail "tiles are missing"
cmp "$folder/whole.csv" "$folder/tiled.csv" || fail "the maps differ"
sha256sum "$folder/whole.csv" "$folder/tiled.csv" | sed "s|$folder/||"

step "the job with more work than time has come to its limit"
wait_for 100 "its end" job_is "$limited_job" TIMEOUT
scontrol show job "$limited_job" | grep -oE '(JobState|RunTime|TimeLimit)=[^ ]*' | tr '\n' ' '
echo
status limited
has_done limited 1 || fail "what was done is lost"
if has_done limited 64; then fail "the limit was not too short"; fi
"$sextant" sweep "$folder/limited" --resume --chunk 4 --time 5
wait_until_idle limited 120
status limited
compare limited study

printf '\nSlurm: all tables are those of this machine, byte for byte (%s s)\n' "$SECONDS"
