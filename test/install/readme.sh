#!/usr/bin/env bash
# Runs the commands of README.md as they stand there, in a copy of the shipped data.
set -euo pipefail
source_dir=$1 build_dir=$2
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
ln -s "$source_dir/datasets" "$source_dir/test" "$work"
cd "$work"
export PATH="$build_dir:$PATH"
sed -n '/^```sh$/,/^```$/p' "$source_dir/README.md" | sed '/^```/d' > commands.sh
[ "$(grep -c '^ukemi ' commands.sh)" -ge 7 ]
bash -euo pipefail commands.sh > log.txt
for d in demo/compare identify predict optimize hold_it map simulate hold compare design calibrate five_seeds twenty_seeds; do [ -s "out/$d/summary.json" ]; done
tail -n 30 log.txt
