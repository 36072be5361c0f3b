#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test.
source "$(dirname "$0")/setup.sh" catch2 parallel slurm-wlm
cmake --preset release -DUKEMI_TESTS=ON ${UKEMI_WERROR:+-DUKEMI_WERROR=ON} >/dev/null
cmake --build --preset release
ctest --preset release -j "$(nproc)"
