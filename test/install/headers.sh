#!/usr/bin/env bash
# Every installed header compiles alone, as a user includes it.
set -euo pipefail
build_dir=$1 compiler=$2
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cmake --install "$build_dir" --prefix "$work" --component library >/dev/null
cd "$work/include/ukemi"
find . -name '*.hpp' | sort > "$work/headers"
[ "$(wc -l < "$work/headers")" -gt 60 ]
xargs -P "$(nproc)" -I{} "$compiler" -std=c++20 -fsyntax-only -Wall -Wextra -Wno-missing-field-initializers -Wno-psabi -Werror \
      -I. -isystem /usr/include/eigen3 -x c++ -include {} /dev/null < "$work/headers"
