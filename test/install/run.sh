#!/usr/bin/env bash
# Builds a consumer against the installed package and one by add_subdirectory, and runs both.
set -euo pipefail
source_dir=$1 build_dir=$2 compiler=$3 flags=${4:-}
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cmake --install "$build_dir" --prefix "$work/prefix" >/dev/null
"$work/prefix/bin/ukemi" --version
common=(-G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags")
cmake -S "$source_dir/test/install/consumer" -B "$work/a" "${common[@]}" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/a" && "$work/a/consumer"
# Each half without what the other links.
for half in identify:NLopt landing:Ceres; do
  cmake -S "$source_dir/test/install/consumer" -B "$work/${half%:*}" "${common[@]}" -DCMAKE_PREFIX_PATH="$work/prefix" -DUKEMI_COMPONENT=${half%:*} \
        -DCMAKE_DISABLE_FIND_PACKAGE_${half#*:}=ON >/dev/null
  cmake --build "$work/${half%:*}" && "$work/${half%:*}/consumer"
done
if ldd "$work/identify/consumer" | grep nlopt || ldd "$work/landing/consumer" | grep -e ceres -e glog; then exit 1; fi
command -v ccache >/dev/null && common+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
# That the project builds inside another is seen by its smallest library.
cmake -S "$source_dir/test/install/consumer" -B "$work/b" "${common[@]}" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DUKEMI_SOURCE="$source_dir" >/dev/null
cmake --build "$work/b" && "$work/b/consumer"
