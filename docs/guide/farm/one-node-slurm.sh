#!/bin/bash
# Slurm on this machine alone, for trying recipes: one-node-slurm.sh start, or stop. Needs root and `slurm-wlm` of Debian.
set -euo pipefail
folder=/tmp/one-node-slurm
case ${1:-} in
start)
    mkdir -p $folder/state $folder/spool /run/munge /etc/slurm
    [[ -s /etc/munge/munge.key ]] || /usr/sbin/mungekey
    chown -R munge: /run/munge /etc/munge
    pgrep -x munged > /dev/null || runuser -u munge -- /usr/sbin/munged
    cat > /etc/slurm/slurm.conf << END
ClusterName=one
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobRequeue=1
MinJobAge=300
ReturnToService=2
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
    slurmctld
    slurmd
    for _ in $(seq 30); do
        sinfo -h -o %t 2> /dev/null | grep -q idle && break
        sleep 1
    done
    sinfo
    ;;
stop)
    pkill -x slurmd || true
    pkill -x slurmctld || true
    ;;
*)
    echo "usage: one-node-slurm.sh start|stop" >&2
    exit 2
    ;;
esac
