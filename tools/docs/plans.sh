#!/usr/bin/env bash
# The table of results.md: what shape terms and scatter change in plans of robots of links. plans.sh [OPTIONS OF OPTIMIZE]; needs `ukemi` in the PATH or
# built in build/release. Some ten minutes on two cores.
set -euo pipefail
cd "$(dirname "$0")/../.."
PATH="$PATH:$PWD/build/release"
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT

# told OUT PATH...: numbers of a summary
told() { python3 -c 'import json, sys
s = json.load(open(sys.argv[1] + "/summary.json"))
for path in sys.argv[2:]:
    v = s
    for key in path.split("."): v = v[key]
    print("%.1f" % v, end=" | ")' "$@"; }

echo '| scene | motion | planned for the drop itself: peak | mean over fresh drops | worst tenth | s | `--robust cvar`: peak | mean | worst tenth | s |'
echo '|---|---|---|---|---|---|---|---|---|---|'
for scene in paper_friction three_links; do
  for bumps in 0 2 4; do
    printf '| %s | %s | ' $scene "$([ $bumps = 0 ] && echo quintic || echo "$bumps shape terms a joint")"
    for goal in '--scatter pitch_deg=1,height=0.01,forward_speed=0.03' '--robust cvar'; do
      begin=$SECONDS
      # shellcheck disable=SC2086
      ukemi optimize datasets/scenes/$scene.toml --bumps $bumps $goal --no-report --quiet -o "$work/out" "$@" > "$work/log" 2>&1
      took=$((SECONDS - begin))
      told "$work/out" peak_acceleration scatter.planned.mean scatter.planned.cvar90
      printf '%s | ' $took
      rm -rf "$work/out"
    done
    echo
  done
done
