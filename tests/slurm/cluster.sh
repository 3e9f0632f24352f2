# A Slurm cluster of this machine alone: a controller and the nodes `a` and `b`. All its state is in one temporary folder.
# Sourced by run.sh. cluster_start sets SLURM_CONF, so that sbatch, squeue and scancel talk to this cluster.

PATH="$PATH:/usr/sbin:/sbin"
cluster_commands=(munged slurmctld slurmd sbatch squeue scancel scontrol)
cluster_packages=(munge slurmctld slurmd slurm-client)

# The commands that this machine lacks.
cluster_lacks() {
    local command
    for command in "${cluster_commands[@]}"; do
        command -v "$command" >/dev/null || printf '%s ' "$command"
    done
}

# Installs Slurm and starts none of its services.
cluster_install() {
    local as_root=()
    [ "$(id -u)" -eq 0 ] || as_root=(sudo -n)
    { "${as_root[@]}" apt-get update -q &&
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive SYSTEMD_OFFLINE=1 RUNLEVEL=1 \
            apt-get install -q -y --no-install-recommends "${cluster_packages[@]}"; } >"$1" 2>&1
}

# A port of 127.0.0.1 that nobody listens to. It is below those that the system gives away.
free_port() {
    local port
    while port=$((20000 + RANDOM % 12000)); do
        if ! (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; then
            echo "$port"
            return
        fi
    done
}

# cluster_start FOLDER
cluster_start() {
    cluster="$1"
    mkdir -p "$cluster"/{munge,state,spool-a,spool-b,log}
    chmod 755 "$cluster" "$cluster/munge"
    sed -e "s|@FOLDER@|$cluster|; s|@HOST@|$(hostname -s)|; s|@USER@|$(id -un)|" \
        -e "s|@PORT@|$(free_port)|; s|@PORT_A@|$(free_port)|; s|@PORT_B@|$(free_port)|" \
        "$(dirname "${BASH_SOURCE[0]}")/slurm.conf.in" >"$cluster/slurm.conf"
    # Slurm reads this file even if no part of it uses control groups.
    echo "CgroupPlugin=cgroup/v1" >"$cluster/cgroup.conf"
    export SLURM_CONF="$cluster/slurm.conf"

    head -c 128 /dev/urandom >"$cluster/munge/key"
    chmod 400 "$cluster/munge/key"
    munged --foreground --key-file="$cluster/munge/key" --socket="$cluster/munge/socket" \
        --pid-file="$cluster/munge/pid" --seed-file="$cluster/munge/seed" --log-file="$cluster/log/munged" \
        >>"$cluster/log/start" 2>&1 &
    munged_process=$!
    wait_for 10 "munge" test -S "$cluster/munge/socket"
    slurmctld -D -f "$SLURM_CONF" >>"$cluster/log/start" 2>&1 &
    slurmctld_process=$!
    node_start a
    node_start b
    wait_for 30 "the controller and both nodes" nodes_are_idle
}

node_start() {
    slurmd -D -N "$1" -f "$SLURM_CONF" >>"$cluster/log/start" 2>&1 &
    disown
}

node_state() { sinfo --noheader --nodes "$1" --format %T; }
nodes_are_idle() { [ "$(node_state a,b 2>/dev/null)" = idle ]; }

# The processes of a node: those that write its log, which are the daemon and the shepherds of its jobs, and the jobs.
# Processes that end meanwhile are no mistake.
node_processes() {
    find /proc/[0-9]*/fd -maxdepth 1 -lname "$cluster/log/slurmd-$1" 2>/dev/null | cut -d/ -f3 || true
    local environment
    for environment in $(with_setting "SLURM_CONF=$SLURM_CONF" /proc/[0-9]*/environ); do
        with_setting "SLURMD_NODENAME=$1" "$environment" | cut -d/ -f3
    done
}
with_setting() { grep -lszxF "$1" "${@:2}" || true; }

# Ends a node as a power cut does: all of its processes at once, without a word to anybody.
node_kill() {
    local processes
    while processes=$(node_processes "$1" | sort -un) && [ -n "$processes" ]; do
        # shellcheck disable=SC2086
        kill -KILL $processes 2>/dev/null || true
    done
}

# Ends whatever cluster_start and node_start started. The folder stays.
cluster_stop() {
    [ -n "${cluster:-}" ] || return 0
    node_kill a
    node_kill b
    kill ${slurmctld_process:-} ${munged_process:-} 2>/dev/null || true
    wait ${slurmctld_process:-} ${munged_process:-} 2>/dev/null || true
}

# wait_for SECONDS WHAT COMMAND..: waits until the command succeeds.
wait_for() {
    local end=$((SECONDS + $1)) what="$2"
    shift 2
    until "$@"; do
        if [ $SECONDS -ge $end ]; then
            echo "waited in vain for $what" >&2
            return 1
        fi
        sleep 0.3
    done
}
