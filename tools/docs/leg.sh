#!/usr/bin/env bash
# Draws tools/docs/leg.svg, the second picture of README.md: leg.sh [FILE]. Needs `ukemi` in the PATH or built in build/release.
set -euo pipefail
picture=$(realpath -m "${1:-$(dirname "$0")/leg.svg}")
cd "$(dirname "$0")/../.."
PATH="$PATH:$PWD/build/release"
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
scene=datasets/scenes/hopper.toml
ukemi optimize "$scene" --evaluations 4000 --quiet --no-report -o "$work/best" >"$work/log" 2>&1
ukemi simulate "$scene" --motion "$work/best/motion.toml" --figures svg --quiet -o "$work/played" >>"$work/log"
sed '/<metadata>/,/<\/metadata>/d' "$work/played/postures.svg" >"$work/picture"
mv "$work/picture" "$picture"
