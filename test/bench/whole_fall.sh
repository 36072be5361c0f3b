#!/usr/bin/env bash
# Medians over seeds of the searches with more than the paper's three variables, on one thread: whole_fall.sh [SEEDS]. Each
# line: median, lowest and highest value [m/s^2], median of the motions tried, options. The table of tools/docs/benchmarks_plans.md.
set -euo pipefail
cd "$(dirname "$0")/../.."
seeds=${1:-20} program=${UKEMI:-build/release/ukemi} out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
value() { grep -o "^  \"$1\": [0-9.]*" "$out/summary.json" | grep -o '[0-9.]*$'; }
air="--release-phi -45 --release-from 0.1"
while read -r options; do
  key=peak_acceleration
  [[ $options == *tolerant* ]] && key=tolerant_peak
  for seed in $(seq "$seeds"); do
    # shellcheck disable=SC2086
    "$program" optimize datasets/scenes/paper.toml --actuator datasets/actuators/table2.toml --threads 1 --seed "$seed" --quiet \
      --no-report -o "$out" $options >/dev/null 2>&1
    echo "$(value $key) $(value evaluations)"
  done | sort -n | awk -v options="$options" '{v[NR]=$1; m[NR]=$2} END {
    k=int((NR+1)/2); printf "%8.2f %8.2f %8.2f %8d  %s\n", v[k], v[1], v[NR], m[k], options}'
done <<LIST
--deadline 0.1
--deadline 1
--bumps 2 --deadline 0.3
--bumps 2 --deadline 3
--bumps 4 --deadline 3
--bumps 4 --deadline 10
--bumps 2 $air --deadline 0.1
--bumps 2 $air --deadline 0.3
--bumps 2 $air --deadline 3
--bumps 4 $air --deadline 10
--bumps 2 --objective tolerant --deadline 1
--objective tolerant $air --deadline 0.1
--bumps 2 --objective tolerant $air --deadline 0.3
--bumps 2 --objective tolerant $air --deadline 3
LIST
