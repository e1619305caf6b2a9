#!/usr/bin/env bash
# A sweep on Slurm: munge, a controller and two nodes on this host. Array tasks are killed, cancelled and requeued, and a node
# is lost; the results must have the bytes of one process alone.
#
#   apt-get install slurm-wlm munge
#   tests/cluster/slurm.sh target/release/sim-host
#
# Needs root, for munge and the nodes; says so and ends with 0 otherwise. Takes about three minutes.
set -euo pipefail

sim_host=$(realpath "${1:?the program sim-host}")
for tool in munged slurmctld slurmd; do
  command -v "$tool" >/dev/null || { echo "skipped: no $tool (apt-get install slurm-wlm munge)"; exit 0; }
done
[ "$(id -u)" = 0 ] || { echo "skipped: not root"; exit 0; }

folder=$(mktemp -d)
cd "$folder"
daemons=()
end() {
  scancel --quiet --user=root 2>/dev/null || true
  sleep 1
  kill "${daemons[@]}" 2>/dev/null || true
  wait 2>/dev/null || true
  rm -rf "$folder"
}
trap end EXIT

# 150 cells of a few tenths of a second.
sweep="$sim_host sweep --over torque-limit=0.5:20/log50 --over law=h,f,none --speeds 3:7:1 --max-rate 12 --scan-step 1
  --tolerance 0.1 --threads 1 -q"

head -c 1024 /dev/urandom >munge.key
chmod 400 munge.key
munged --force --foreground --key-file=munge.key --socket="$folder/munge.socket" --pid-file=munge.pid \
  --seed-file=munge.seed >munge.log 2>&1 &
daemons+=($!)

export SLURM_CONF="$folder/slurm.conf"
cat >slurm.conf <<END
ClusterName=one
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmctldPidFile=$folder/controller.pid
SlurmctldPort=26817
SlurmctldLogFile=$folder/controller.log
SlurmdPidFile=$folder/%n.pid
SlurmdSpoolDir=$folder/spool.%n
SlurmdLogFile=$folder/%n.log
SlurmdParameters=config_overrides
SlurmdTimeout=10
ReturnToService=2
KillWait=10
MpiDefault=none
JobRequeue=1
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=2
NodeName=node1 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=26818 CPUs=4
NodeName=node2 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=26819 CPUs=4
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
mkdir state spool.node1 spool.node2
slurmctld -D >controller.out 2>&1 &
daemons+=($!)
start_node() {
  slurmd -D -N "$1" >"$1.out" 2>&1 &
  daemons+=($!)
}
start_node node1
start_node node2
node2=$!
until [ "$(sinfo --noheader --states=idle --format=%D 2>/dev/null)" = 2 ]; do sleep 0.5; done

# Waits for all jobs.
finished() {
  until [ -z "$(squeue --noheader)" ]; do sleep 1; done
}
# Waits until a number of cells are done in a folder.
cells_done() {
  until [ "$(find "$1/units" -name '*.json' 2>/dev/null | wc -l)" -ge "$2" ]; do sleep 0.2; done
}
# The process of an array task.
process() {
  grep -lz "^SLURM_ARRAY_TASK_ID=$1\$" $(pgrep -f "^$sim_host sweep" | sed 's|.*|/proc/&/environ|') 2>/dev/null | cut -d/ -f3 | head -1
}
same() {
  diff -r --exclude='.sim-host-*' one "$1" || { echo "FAILED: $1 differs from one process alone"; exit 1; }
  echo "same bytes: $1"
}

echo "one process alone"
$sweep --out one

cat >shared.sh <<END
#!/bin/sh
#SBATCH --array=1-6 --cpus-per-task=1 --requeue --open-mode=append --output=$folder/shared-%a.log
exec $(echo $sweep) --out $folder/shared
END
echo "an array of six tasks on one folder"
job=$(sbatch --parsable shared.sh)
cells_done shared 15
"$sim_host" sweep --status shared
echo "task 1 killed, 2 cancelled, 3 requeued"
kill -KILL "$(process 1)"
scancel "${job}_2"
scontrol requeue "${job}_3"
cells_done shared 60
echo "node2 lost"
kill -KILL "$node2"
squeue --noheader --array --nodelist=node2 --states=running --format='%A %K' | while read -r id task; do
  kill -KILL $(pgrep -f "^slurmstepd: \[$id\.") "$(process "$task")"
done
"$sim_host" sweep --status shared
finished
"$sim_host" sweep --status shared
cat shared-*.log
scontrol --oneliner show job | sed -nE 's/.*ArrayTaskId=([0-9]+) .*JobState=([A-Z]+) .*Restarts=([0-9]+) .*/task \1: \2, restarts: \3/p' | sort
same shared

start_node node2
cat >parts.sh <<END
#!/bin/sh
#SBATCH --array=1-3 --cpus-per-task=1 --requeue
exec $(echo $sweep) --out $folder/part\$SLURM_ARRAY_TASK_ID --shard \$SLURM_ARRAY_TASK_ID/3
END
echo "an array of three shards, each with its own folder; one cancelled and submitted again; merged"
job=$(sbatch --parsable parts.sh)
cells_done part2 10
scancel "${job}_2"
finished
"$sim_host" sweep --status part2
"$sim_host" sweep merge part1 part2 part3 --out merged 2>&1 | head -2 || true
sbatch --parsable --array=2 parts.sh
finished
"$sim_host" sweep merge part1 part2 part3 --out merged --quiet
same merged
echo "passed"
