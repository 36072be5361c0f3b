#!/usr/bin/env bash
# clang-tidy with the checks of .clang-tidy, on the sources that are named: tidy.sh [FILE...]. Without one, on what reads files, with the headers that
# it includes: some 4 s a source. The others take 10 to 30 s each (Eigen, Jets, JSON), more than .ci/run has: name them to check them.
source "$(dirname "$0")/setup.sh" clang-tidy
[ $# -gt 0 ] || set -- $(git ls-files 'common/*.cpp' 'identify/logs/*.cpp' 'identify/rig/*.cpp' 'landing/model/*.cpp' |
                         grep -v common/drive_stability.cpp)  # Jets: 25 s
cmake --preset release -B build/tidy -DUKEMI_TESTS=ON >/dev/null  # for its compile commands
# -Wno-restrict is GCC's.
printf '%s\0' "$@" | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build/tidy --quiet --extra-arg=-Wno-unknown-warning-option 2>/dev/null
echo "clang-tidy: clean"
