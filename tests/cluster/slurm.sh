#!/bin/sh
# A SLURM of this one machine, for tests: munged, slurmctld and slurmd with all their files in one folder, and
# /etc/slurm/slurm.conf, without which jobs would not know it.
#
#   tests/cluster/slurm.sh start DIR
#   tests/cluster/slurm.sh fail DIR     the node dies with all that runs on it
#   tests/cluster/slurm.sh repair DIR   the node comes back
#   tests/cluster/slurm.sh stop DIR
#
# Needs root and Debian's slurm-wlm and munge.
set -eu
action=$1
mkdir -p "$2"
dir=$(cd "$2" && pwd)
conf=/etc/slurm/slurm.conf

running() { [ -f "$1" ] && kill -0 "$(cat "$1" 2>/dev/null)" 2>/dev/null; }

end() {
    running "$1" && kill "$(cat "$1")"
    while running "$1"; do sleep 0.1; done
    rm -f "$1"
}

until_state() {
    for _ in $(seq 100); do
        case $(sinfo --noheader --format=%T 2>/dev/null) in $1) return ;; esac
        sleep 0.2
    done
    echo "the node is not $1: $(sinfo --noheader --format='%T %E')" >&2
    exit 1
}

node() { slurmd -f "$conf" -N node; }

case $action in
start)
    if [ -e "$conf" ]; then
        echo "$conf is there already: this machine has a SLURM" >&2
        exit 1
    fi
    mkdir -p /etc/slurm "$dir/state" "$dir/spool"
    # Munge refuses folders that others may write, and does not run as root.
    munge=$(mktemp -d /run/munge-test-XXXXXX)
    echo "$munge" >"$dir/munge"
    head -c 1024 /dev/urandom >"$munge/key"
    chmod 400 "$munge/key"
    chmod 755 "$munge"
    chown -R munge: "$munge"
    setpriv --reuid=munge --regid=munge --clear-groups munged --force --key-file="$munge/key" \
        --socket="$munge/socket" --pid-file="$munge/pid" --log-file="$munge/log" --seed-file="$munge/seed"
    cat >"$conf" <<END
ClusterName=one
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$munge/socket
CredType=cred/munge
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SlurmdTimeout=10
MinJobAge=300
JobRequeue=0
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=node NodeHostname=$(hostname) NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$(free -m | awk '/^Mem/ {print int($2 * 0.9)}')
PartitionName=main Nodes=node Default=YES MaxTime=INFINITE State=UP
END
    slurmctld -c
    node
    until_state idle
    ;;
fail)
    end "$dir/slurmd.pid"
    for steps in $(pgrep slurmstepd); do pkill -KILL -P "$steps" || true; kill -KILL "$steps" || true; done
    scontrol update nodename=node state=down reason=test
    ;;
repair)
    node
    # Refused where the node that registered is back already (ReturnToService).
    scontrol update nodename=node state=resume 2>/dev/null || true
    until_state '[im]*'
    ;;
stop)
    scancel --user="$(id -un)" 2>/dev/null || true
    end "$dir/slurmd.pid" || true
    end "$dir/slurmctld.pid" || true
    munge=$(cat "$dir/munge")
    end "$munge/pid" || true
    rm -rf "$munge" "$conf"
    ;;
*)
    sed -n 2,10p "$0"
    exit 2
    ;;
esac
