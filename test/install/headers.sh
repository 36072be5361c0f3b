#!/usr/bin/env bash
# Every installed header compiles alone, as a user includes it. The sources under the current folder that begin with a
# header of theirs have shown it for that one.
set -euo pipefail
build_dir=$1 compiler=$2
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
find common identify landing -name '*.cpp' | while read -r source; do
  header=${source%.cpp}.hpp
  if [ "$(sed -n 's/^#include "\(.*\)"$/\1/p;/^#include/q' "$source")" = "$header" ]; then echo "./$header"; fi
done | sort > "$work/shown"
cmake --install "$build_dir" --prefix "$work" --component library >/dev/null
cd "$work/include/ukemi"
find . -name '*.hpp' | sort > "$work/headers"
[ "$(wc -l < "$work/headers")" -gt 60 ]
comm -23 "$work/headers" "$work/shown" |
  xargs -P "$(nproc)" -I{} "$compiler" -std=c++20 -fsyntax-only -Wall -Wextra -Wno-missing-field-initializers -Wno-psabi -Werror \
        -I. -isystem /usr/include/eigen3 -x c++ -include {} /dev/null
