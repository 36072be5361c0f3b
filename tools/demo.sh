#!/usr/bin/env bash
# Installs what is missing, builds, and runs the whole chain on the shipped data. Results: ./ukemi-out/demo
source "$(dirname "$0")/setup.sh"
cmake --preset release -DUKEMI_TESTS=OFF -DCMAKE_UNITY_BUILD=ON >/dev/null
cmake --build --preset release --target ukemi_program
time ./build/release/ukemi demo -o ukemi-out/demo --quiet
echo "reports: ukemi-out/demo/{identify,optimize,compare}/report.html"
