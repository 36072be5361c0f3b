#!/usr/bin/env bash
# The installed headers: few and short, each compiles alone, none names a solver or dual numbers, and none of their names is in the way of
# a user's own.
set -euo pipefail
build_dir=$1 compiler=$2
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cmake --install "$build_dir" --prefix "$work" --component library >/dev/null
cd "$work/include"
find . -name '*.hpp' | sort > "$work/headers"
lines=$(xargs cat < "$work/headers" | wc -l)
echo "$(wc -l < "$work/headers") headers, $lines lines"
[ "$(wc -l < "$work/headers")" -gt 20 ] && [ "$(wc -l < "$work/headers")" -le 25 ] && [ "$lines" -le 2500 ]
if grep -riE 'ceres|nlopt|boost|jet|Eigen/' .; then exit 1; fi
compile() { "$compiler" -std=c++20 -fsyntax-only -Wall -Wextra -Wno-missing-field-initializers -Werror -I. -x c++ "$@"; }
export -f compile; export compiler
xargs -P "$(nproc)" -I{} bash -c 'compile -include {} /dev/null' < "$work/headers"
{
  sed 's#^\./\(.*\)#\#include <\1>#' "$work/headers"
  echo 'using namespace ukemi; using namespace ukemi::identify; using namespace ukemi::landing;'
  echo 'struct Clock {}; struct Matrix {}; struct Time {}; Clock c; Matrix m; Time t;'
} > "$work/all.cpp"
compile "$work/all.cpp"
# README's three, as a file of a user's holds them.
printf '#include <ukemi/%s.hpp>\n' identify/fit landing/optimize landing/scene_file > "$work/three.cpp"
time compile "$work/three.cpp"
