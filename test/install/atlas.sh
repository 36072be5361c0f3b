#!/usr/bin/env bash
# Three shards of a small atlas by GNU parallel and by a Slurm array on this host: merged, each is the single run. What is not installed or does
# not start is skipped with a message.
set -euo pipefail
source_dir=$1 build_dir=$2
work=$(mktemp -d)
daemons=()
finish() { for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null || true; done; wait; rm -rf "$work"; }
trap finish EXIT
cd "$work"
export PATH="$build_dir:$PATH:/usr/sbin"
cp "$source_dir/datasets/scenes/paper.toml" scene.toml
cp "$source_dir/datasets/actuators/table2.toml" actuator.toml
export DROPS="scene.toml --actuator actuator.toml --height 0.3:0.6:4 --speed 0:1:3 --pitch-deg 0:30:4 --evaluations 150 --threads 1 --quiet"
table() { grep -v '^#' "$1/atlas.csv"; }
same() { [ "$(wc -l < "$1/atlas.csv")" -gt 48 ]; diff <(table single) <(table "$1"); cmp single/atlas.bin "$1/atlas.bin"; }

ukemi atlas $DROPS -o single

if command -v parallel >/dev/null; then
  parallel --will-cite ukemi atlas $DROPS --shard {}/3 -o shards/{} ::: 1 2 3
  ukemi atlas --merge shards/1 shards/2 shards/3 -o by_parallel
  same by_parallel
  echo "GNU parallel: three shards are the single run"
else
  echo "skipped: GNU parallel is not installed"
fi

if ! command -v slurmctld slurmd sbatch >/dev/null; then echo "skipped: Slurm is not installed"; exit 0; fi
port=$((20000 + RANDOM % 20000))
mkdir spool state
cat > slurm.conf <<CONF
ClusterName=test
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/none
CryptoType=crypto/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SchedulerType=sched/builtin
SelectType=select/cons_tres
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
sed -i '/^CryptoType/d' slurm.conf
export SLURM_CONF=$work/slurm.conf
slurmctld -D > slurmctld.log 2>&1 & daemons+=($!)
slurmd -D > slurmd.log 2>&1 & daemons+=($!)
ready() { sinfo -h -o %T 2>/dev/null | grep -qx idle; }
for _ in $(seq 30); do ready && break; sleep 0.5; done
if ! ready; then
  echo "skipped: Slurm does not start here: $(grep -hE 'error|fatal' slurmctld.log slurmd.log | head -n 3 | tr '\n' ' ')"
  exit 0
fi
rm -rf shards
timeout 120 sbatch --wait --array=1-3 --wrap "ukemi atlas $DROPS --shard \$SLURM_ARRAY_TASK_ID/3 -o shards/\$SLURM_ARRAY_TASK_ID" || { cat slurm-*.out slurmd.log; exit 1; }
ukemi atlas --merge shards/1 shards/2 shards/3 -o by_slurm
same by_slurm
echo "Slurm: three shards are the single run"
