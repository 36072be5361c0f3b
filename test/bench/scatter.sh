#!/usr/bin/env bash
# Plans for drops that scatter (1 deg, 1 cm, 3 cm/s, assumed): scatter.sh scenes|ratings|solvers [SEEDS]. Each plan is played over fresh
# drops, the same for every plan of a scene. Peaks in m/s^2; the tables of tools/docs/benchmarks_plans.md.
set -euo pipefail
cd "$(dirname "$0")/../.."
program=${UKEMI:-build/release/ukemi} out=$(mktemp -d) seeds=${2:-5}
trap 'rm -rf "$out"' EXIT
actuator=datasets/actuators/table2.toml
plan() { "$program" optimize "$@" --quiet --no-report -o "$out" >/dev/null 2>&1; }  # SCENE OPTIONS...
tell() { python3 - "$out/summary.json" "$@" <<'PY'
import json, sys
s = json.load(open(sys.argv[1]))
d = s
for key in sys.argv[2].split('/'): d = d[key]
print(" | ".join(f"{d[k]:.0f}" for k in sys.argv[3:]), end="")
PY
}
scenes() {
  echo "| scene | held: mean | worst tenth | Eq. 6: mean | worst tenth | --robust mean: mean | worst tenth | --robust cvar: mean | worst tenth |"
  echo "|---|---|---|---|---|---|---|---|---|"
  for scene in paper paper_soft paper_rough_a paper_rough_b low high fast tilted straight hard; do
    file=datasets/scenes/$scene.toml
    plan $file --actuator $actuator "$@"
    echo -n "| $scene | $(tell scatter/held mean cvar90) | $(tell scatter/planned mean cvar90) | "
    plan $file --actuator $actuator --robust mean "$@"
    echo -n "$(tell scatter/planned mean cvar90) | "
    plan $file --actuator $actuator --robust cvar "$@"
    echo "$(tell scatter/planned mean cvar90) |"
  done
}
ratings() {
  echo "| rated speed, torque | Eq. 6: mean | worst tenth | --robust mean: mean | worst tenth | drops of 10,000 that break the ratings |"
  echo "|---|---|---|---|---|---|"
  for rating in "3.14 20" "6.28 20" "9.42 30"; do
    read -r speed torque <<<"$rating"
    { sed -n '/^\[actuator\]/,/^$/p' $actuator | grep -v -e tau_max -e speed_max; echo "tau_max = $torque"; echo "speed_max = $speed"; } > "$out.toml"
    plan datasets/scenes/paper.toml --actuator "$out.toml" --respect-ratings --bumps 2
    echo -n "| $speed rad/s, $torque Nm | $(tell scatter/planned mean cvar90) | "
    plan datasets/scenes/paper.toml --actuator "$out.toml" --respect-ratings --bumps 2 --robust mean
    echo "$(tell scatter/planned mean cvar90) | $(tell scatter broken) |"
    rm "$out.toml"
  done
}
solvers() {
  echo "| deadline | auto | de | cma |"
  echo "|---|---|---|---|"
  for deadline in 0.3 1 3 10; do
    echo -n "| $deadline s |"
    for solver in auto de cma; do
      for seed in $(seq "$seeds"); do
        rm -f "$out/summary.json"
        plan datasets/scenes/paper.toml --actuator $actuator --bumps 2 --robust mean --solver $solver --deadline $deadline --seed "$seed" || true
        tell robust promised 2>/dev/null || true  # nothing was found in the time: no line
        echo
      done | sort -n | awk -v of="$seeds" 'NF {v[++n]=$1} END {
        if (n < of) printf " found %d of %d |", n, of; else printf " %.0f (%.0f to %.0f) |", v[int((n+1)/2)], v[1], v[n]}'
    done
    echo
  done
}
"$1" "${@:3}"
