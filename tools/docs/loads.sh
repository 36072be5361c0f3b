#!/usr/bin/env bash
# The table of results.md: three robots planned for their peak acceleration, for the torque of the knee, and for both. loads.sh [OPTIONS OF OPTIMIZE]; needs
# `ukemi` in the PATH or built in build/release. Rated for both: each load by the least that was found for it alone.
set -euo pipefail
cd "$(dirname "$0")/../.."
PATH="$PATH:$PWD/build/release"
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
run=(--quiet --no-report)

# value LOAD OUT: the largest value of a load, from a summary
value() { python3 -c 'import json, sys
print(next(l["value"] for l in json.load(open(sys.argv[2] + "/summary.json"))["loads"] if l["name"] == sys.argv[1]))' "$@"; }
peak() { printf '[[load]]\nname = "peak"\nkind = "acceleration"\n%s\nrating = %s\n' "$(printf "%b" "$point")" "$1"; }
knee() { printf '[[load]]\nname = "knee"\nkind = "torque"\njoint = "knee"\nrating = %s\n' "$1"; }
# scene FILE TABLES: the shipped scene with loads
scene() { { sed "s#\"\.\./robots/#\"$PWD/datasets/robots/#" "datasets/scenes/$name.toml"; echo; echo "$2"; } > "$work/$1.toml"; }
row() {  # row WORDS OPTIONS OF SIMULATE: both loads
  ukemi simulate "$work/told.toml" "${@:2}" "${run[@]}" -o "$work/told" > "$work/log" 2>&1
  printf '| %s | %s | %.1f | %.2f |\n' "$words" "$1" "$(value peak "$work/told")" "$(value knee "$work/told")"
}
plan() { ukemi optimize "$work/$1.toml" "${options[@]}" "${run[@]}" -o "$work/$1" > "$work/log" 2>&1; }

options=("$@")
echo '| robot | planned for | peak acceleration [m/s²] | knee torque [Nm] |'
echo '|---|---|---|---|'
while IFS='|' read -r name words point; do
  scene told "$(peak 1; knee 1)"
  scene for_peak "$(peak 1)"
  scene for_knee "$(knee 1)"
  plan for_peak; plan for_knee
  scene for_both "$(peak "$(value peak "$work/for_peak")"; knee "$(value knee "$work/for_knee")")"
  plan for_both
  row 'nothing: held'
  row 'peak acceleration' --motion "$work/for_peak/motion.toml"
  row 'knee torque' --motion "$work/for_knee/motion.toml"
  row 'both' --motion "$work/for_both/motion.toml"
done << 'END'
paper_friction|the paper's, friction 0.6|link = "thigh"
three_links|three_links|link = "torso"
hopper|hopper|link = "slider"\nat = [0, 0]
END
