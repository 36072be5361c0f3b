#!/usr/bin/env bash
# clang-tidy with the checks of .clang-tidy on the sources that are named: tidy.sh [FILE...]. Without one, on what reads files, with the headers that
# it includes, a room at once: the headers of Eigen and fmt are then read once for a room. The others take 10 to 30 s each (Jets, JSON), more than
# .ci/run has: name them to check them.
source "$(dirname "$0")/setup.sh" clang-tidy
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
if [ $# -eq 0 ]; then
  for room in common identify/logs identify/rig landing/model; do
    find "$room" -name '*.cpp' | sort | grep -v drive_stability | sed 's/.*/#include "&"/' > "$work/${room//\//_}.cpp"  # drive_stability: 25 s
  done
  set -- "$work"/*.cpp
fi
printf '%s\0' "$@" | xargs -0 -n 1 -P "$(nproc)" -I{} clang-tidy --quiet --config-file=.clang-tidy --checks=-bugprone-suspicious-include --header-filter="$PWD/(common|identify|landing|tools)/.*" \
  {} -- -std=c++20 -I. -isystem /usr/include/eigen3 -Wno-unknown-warning-option 2>/dev/null
echo "clang-tidy: clean"
