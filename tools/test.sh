#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test.
source "$(dirname "$0")/setup.sh" catch2 pybind11-dev python3-dev python3-numpy python3-pytest doxygen chromium parallel slurm-wlm libsdformat-dev libmujoco-dev dart-doc file dpkg-dev
cmake --preset release -DUKEMI_TESTS=ON -DUKEMI_PYTHON=ON -DCMAKE_UNITY_BUILD=ON ${UKEMI_WERROR:+-DUKEMI_WERROR=ON} >/dev/null
cmake --build --preset release
ctest --preset release -j "$(nproc)"
