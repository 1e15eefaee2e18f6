#!/bin/sh
# slurm.sh SOURCE RHEOLOG [SEEDS]: makes the sweep of docs/sweeps.md as a Slurm job array, as printed but with SEEDS seeds for each
# of its 4 orders (6; the page has 50), with a slurmctld and a slurmd of its own on the loopback address. Cancels the array, crashes
# the node, tears a recording, and submits again. The recordings must have the bytes of a sweep that nothing disturbed. Needs root,
# and of Debian the packages slurmctld, slurmd and slurm-client; munge is not used. No other test starts it.
set -eu
source=$(realpath "$1") rheolog=$(realpath "$2") seeds=${3:-6}
for program in slurmctld slurmd sbatch scancel squeue ps; do
    command -v "$program" >/dev/null || { echo "there is no $program"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "slurmd needs root"; exit 77; }
tmp=$(mktemp -d)
controller='' node=''
trap 'stop; rm -rf "$tmp"' EXIT
. "$source/tests/fails.sh"
. "$source/tests/sweep_support.sh"
export SLURM_CONF="$tmp/slurm.conf"

descendants() { # of a process, and itself
    echo "$1"
    for child in $(ps --ppid "$1" -o pid=); do
        descendants "$child"
    done
}
steps_of_node() { # the daemons of its jobs, which are no children of slurmd, and what they started
    for pid in $(ps -C slurmstepd -o pid=); do
        grep -qz "^SLURM_CONF=$SLURM_CONF$" "/proc/$pid/environ" 2>/dev/null && descendants "$pid"
    done
    true
}
stop() {
    # shellcheck disable=SC2046 # lists
    [ -z "$node$controller" ] || kill -9 $node $(steps_of_node) $controller 2>/dev/null || true
}
fail() {
    echo "$1"
    tail -n 20 "$tmp"/*.log
    exit 1
}
wait_until() { # wait_until SECONDS WHAT COMMAND...
    seconds=$1 what=$2 i=0
    shift 2
    until "$@"; do
        i=$((i + 1))
        [ $i -le $((seconds * 5)) ] || fail "$what does not come: $(squeue 2>&1)"
        sleep 0.2
    done
}
start_node() {
    slurmd -D -N one >"$tmp/slurmd.out" 2>&1 &
    node=$!
    wait_until 60 "the node" node_is_idle
}
node_is_idle() {
    sinfo -h -o %T 2>/dev/null | grep -Eq 'idle|mixed|allocated'
}
no_job() {
    [ -z "$(squeue -h 2>&1)" ]
}
are_recordings() { # are_recordings COUNT
    [ "$(recordings)" -ge "$1" ]
}
submit() { # the command of the page
    sh -c "$(grep '^sbatch' "$source/docs/sweeps.md")" >said 2>&1 || fail "sbatch: $(cat said)"
    job=$(sed -n 's/^Submitted batch job //p' said)
}

mkdir "$tmp/state" "$tmp/spool"
port=$((20000 + $$ % 20000))
cat >"$SLURM_CONF" <<END
ClusterName=sweeps
SlurmctldHost=$(hostname -s)(127.0.0.1)
AuthType=auth/none
CredType=cred/none
SlurmUser=root
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmctldPidFile=$tmp/slurmctld.pid
SlurmdPidFile=$tmp/slurmd.pid
SlurmctldLogFile=$tmp/slurmctld.log
SlurmdLogFile=$tmp/slurmd.log
StateSaveLocation=$tmp/state
SlurmdSpoolDir=$tmp/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=5
KillWait=5
ReturnToService=2
NodeName=one NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=2 State=UNKNOWN
PartitionName=all Nodes=one Default=YES MaxTime=60
END

prepare
undisturbed
slurmctld -D -i >"$tmp/slurmctld.out" 2>&1 &
controller=$!
start_node

echo $((all / 4 + 2)) >"$tmp/hold"
submit
wait_until 300 "a quarter of the recordings" are_recordings $((all / 4))
scancel "$job"
wait_until 60 "the end of the array" no_job
echo "after scancel: $(count_complete) of $all recordings are complete"

echo $((all / 2 + 2)) >"$tmp/hold"
submit
wait_until 300 "half of the recordings" are_recordings $((all / 2))
# shellcheck disable=SC2046 # a list
kill -9 $node $(steps_of_node) 2>/dev/null || true
echo "after a crash of the node: $(count_complete) of $all recordings are complete"
tear
rm "$tmp/hold"
start_node # Slurm starts the tasks again that the node has lost, and goes on with the array
wait_until 900 "the end of the array" no_job
echo "after the node came back: $(count_complete) of $all recordings are complete"
submit
wait_until 900 "the end of the array" no_job
compare
table_of_page
echo "slurm: $all runs as a job array, cancelled, crashed and torn in between, have the bytes of an undisturbed sweep"
