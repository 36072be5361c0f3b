#!/usr/bin/env bash
# The table of results.md: what friction, slopes and pads change in the paper's drop. floors.sh [EVALUATIONS]; needs `ukemi` in the PATH or built in
# build/release. Each row: the posture held, the motion that is best on the paper's floor played unchanged, the motion planned anew.
set -euo pipefail
motions=${1:-8000}
cd "$(dirname "$0")/../.."
PATH="$PATH:$PWD/build/release"
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cp datasets/actuators/table2.toml "$work"
run=(--quiet --no-report)

# scene FLOOR PAD: the paper's scene with lines of [floor], and a pad on each contact
scene() {
  sed -e "s#../actuators/##" -e "${2:+/^link = /a pad = $2}" datasets/robots/paper.toml > "$work/robot.toml"
  sed -e 's#../robots/paper.toml#robot.toml#' -e '/^friction\|^stiffness_tang/d' \
      -e "s/^damping_tangential.*/$1/" datasets/scenes/paper_friction.toml > "$work/scene.toml"
}
peak() { sed -n 's/^ *"peak_acceleration": \([0-9.]*\).*/\1/p' "$work/$1/summary.json" | head -n 1; }
play() { ukemi simulate "$work/scene.toml" "${@:2}" "${run[@]}" -o "$work/$1" > "$work/log" 2>&1; }
plan() { ukemi optimize "$work/scene.toml" --evaluations "$motions" "${run[@]}" -o "$work/$1" > "$work/log" 2>&1; }
row() {
  scene "$2" "${3:-}"
  play held; play same --motion "$work/best/motion.toml"; plan anew
  printf '| %s | %.1f | %.1f | %.1f |\n' "$1" "$(peak held)" "$(peak same)" "$(peak anew)"
}
viscous="damping_tangential = 0.19"
stick() { echo "friction = $1\nstiffness_tangential = 6880\ndamping_tangential = 40"; }

scene "$viscous"; plan best
echo '| floor | held at -45° | best of the first row, unchanged | planned anew |'
echo '|---|---|---|---|'
row "the paper's" "$viscous"
for mu in 0.2 0.4 0.6 0.8 1.0 1.2; do row "friction $mu" "$(stick "$mu")"; done
for slope in -5 5; do row "slope $slope°" "$viscous\nslope_deg = $slope"; done
for mm in 5 10 20 30; do
  row "pads of $mm mm, 3,000 N/m, 60 N/(m/s)" "$viscous" "{ thickness = $(awk "BEGIN { print $mm / 1000 }"), stiffness = 3000, damping = 60 }"
done
