#!/usr/bin/env bash
# What more freedom is worth on every shipped scene, beside the two limits of its drop: limits.sh [SEEDS]. Best peaks of the paper's motion in 1 s,
# with two shape terms in 3 s, with four in 6 s, on one thread, the median of the seeds; then the same within the actuator's ratings
# (3.14 rad/s, 20 Nm). m/s^2; the table of tools/docs/benchmarks_plans.md.
set -euo pipefail
cd "$(dirname "$0")/../.."
seeds=${1:-3} program=${UKEMI:-build/release/ukemi} out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
value() { python3 -c 'import json, sys
s = json.load(open(sys.argv[1]))
for key in sys.argv[2].split("/"): s = (s or {}).get(key)
print("none" if s is None else f"{s:.1f}")' "$out/summary.json" "$1" 2>/dev/null || echo none; }
search() {  # SCENE OPTIONS...
  local scene=$1; shift
  rm -f "$out/summary.json"
  "$program" optimize datasets/scenes/$scene.toml --actuator datasets/actuators/table2.toml --threads 1 --quiet --no-report -o "$out" "$@" \
    >/dev/null 2>&1 || true
}
plan() {  # SCENE OPTIONS...: the median of the seeds
  local scene=$1; shift
  for seed in $(seq "$seeds"); do
    search "$scene" --seed "$seed" "$@"
    value peak_acceleration
  done | sort -n | sed -n "$(((seeds + 1) / 2))p"
}
echo "| scene | held | least jump | first contact held | quintic | two terms | four | rated: quintic | two terms | four |"
echo "|---|---|---|---|---|---|---|---|---|---|"
for scene in paper paper_soft paper_rough_a paper_rough_b low high fast tilted straight hard; do
  search $scene --evaluations 200  # the limits are told where there is no deadline
  row="| $scene | $(value hold/peak_acceleration) | $(value limit/jump) | $(value limit/first_contact)"
  for ratings in "" --respect-ratings; do
    row+=" | $(plan $scene --deadline 1 $ratings) | $(plan $scene --bumps 2 --deadline 3 $ratings) | $(plan $scene --bumps 4 --deadline 6 $ratings)"
  done
  echo "$row |"
done
