#!/usr/bin/env bash
# The table of results.md: the peak, the knee's torque and both, planned for each; and the figures of trade.md. loads.sh [EVALUATIONS]; needs python3, and
# `ukemi` in the PATH or built in build/release.
set -euo pipefail
motions=${1:-40000}
cd "$(dirname "$0")/../.."
docs=$PWD/tools/docs
PATH="$PATH:$PWD/build/release"
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cp -r datasets "$work"
cd "$work/datasets/scenes"

# scene NAME PEAK TORQUE: a scene with a load for each number that is not "-", its rating
scene() {
  { cat "$1.toml"; printf '\n'
    [ "$2" = - ] || printf '[[load]]\nname = "body"\nkind = "acceleration"\nlink = "%s"\nrating = %s\n' "${link[$1]}" "$2"
    [ "$3" = - ] || printf '[[load]]\nname = "knee"\nkind = "torque"\njoint = "knee"\nrating = %s\n' "$3"; } > planned.toml
}
declare -A link=([paper_friction]=thigh [three_links]=torso [hopper]=slider)
value() { python3 -c 'import json,sys; print("{:.4g}".format({l["load"]: l["value"] for l in json.load(open(sys.argv[1]))["loads"]}[sys.argv[2]]))' "$@"; }
both() { scene "$1" 1 1; ukemi simulate planned.toml "${@:2}" --quiet --no-report -o both > log 2>&1; }
row() {
  printf '| `%s` | %s | %s | %s |\n' "$1" "$2" "$(value both/summary.json body)" "$(value both/summary.json knee)"
}
planned() {
  scene "$1" "$3" "$4"
  ukemi optimize planned.toml --evaluations "$motions" --quiet --no-report -o best > log 2>&1
  both "$1" --motion best/motion.toml
  row "$1" "$2"
}

echo '| scene | planned for | peak [m/s²] | knee [Nm] |'
echo '|---|---|---|---|'
for name in paper_friction three_links hopper; do
  both "$name"; row "$name" 'held'
  peak=$(value both/summary.json body) torque=$(value both/summary.json knee)
  planned "$name" 'the peak' 1 -
  planned "$name" "the knee's torque" - 1
  planned "$name" 'both, as parts of the held' "$peak" "$torque"
done

# figure FILE ARGUMENT...
figure() {
  local begin=$SECONDS
  ukemi trade "${@:2}" --quiet --figures svg -o figure > log 2>&1
  cp figure/trade.svg "$docs/$1"
  echo "$1: $((SECONDS - begin)) s" >&2
}
figure trade_spring.svg paper_friction.toml --vary drive.knee.k_sea=20:500:9
sed '/^link = /a pad = { thickness = 0.01, stiffness = 3000, damping = 60 }' ../robots/paper.toml > ../robots/padded.toml
sed 's#robots/paper.toml#robots/padded.toml#' paper_friction.toml > padded.toml
figure trade_pad.svg padded.toml --vary 'robot.contact.*.pad.thickness=0:0.03:7'
figure trade_motor.svg paper_friction.toml --vary drive.knee.speed_max=1:15:8 --respect-ratings --evaluations 10000
