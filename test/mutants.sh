#!/usr/bin/env bash
# Ten faults seeded into the equations, one at a time, each in a copy of the sources; the test that is named must fail, and pass without the fault.
#   test/mutants.sh [BUILD_FOLDER]      some minutes; the libraries are taken from the build folder
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath "${1:-build/release}")
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cp -r common identify landing test "$work"

# file | what stands there | the fault | test file | sources that hold the equation beside the test
faults=$(cat <<'FAULTS'
common/sea.hpp|const T d = s.phi_m - s.phi;|const T d = s.phi_m + s.phi;|unit/sea|
common/sea.hpp|return p.k_p * (ref.phi - s.phi) + p.k_d * (ref.dphi - s.dphi);|return p.k_p * (ref.phi - s.phi) - p.k_d * (ref.dphi - s.dphi);|unit/sea|
common/sea.hpp|rate += T(3) * p.k_sea_cubic|rate += T(2) * p.k_sea_cubic|unit/sea|
common/sea.hpp|T torque = tau_mot - tau_sea;|T torque = tau_mot + tau_sea;|unit/sea|
identify/rig/one_link.hpp|dy[kOmega] = torque[kOutputSide] * T(inverse_inertia_);|dy[kOmega] = torque[kOutputSide] * T(2 * inverse_inertia_);|unit/one_link|identify/rollout/rollout.cpp identify/rollout/rollout_methods.cpp
landing/model/motion.hpp|(T(10) + s * (T(-15) + T(6) * s))|(T(10) + s * (T(-15) + T(5) * s))|unit/motion|landing/model/motion.cpp
landing/model/motion.hpp|const T window = T(64) * rest * rest;|const T window = T(32) * rest * rest;|unit/motion|landing/model/motion.cpp
landing/body/equations.hpp|right[k] += p.omega[j] * p.omega[j] * h;|right[k] -= p.omega[j] * p.omega[j] * h;|legs/laws|
landing/body/equations.hpp|return r.a[j] * p.sin[j] + r.b[j] * p.cos[j];|return r.a[j] * p.sin[j] - r.b[j] * p.cos[j];|legs/laws|
landing/body/equations.hpp|const T c = p.cos[j] * p.cos[k] + p.sin[j] * p.sin[k], s =|const T c = p.cos[j] * p.cos[k] - p.sin[j] * p.sin[k], s =|legs/laws|
FAULTS
)

# Compiles a test with the equations of the copy, which go before those of the libraries, and runs it.
passes() {
  local test=$1; shift
  (cd "$work" && "${CXX:-g++}" -std=c++20 -O0 -w -I. -isystem /usr/include/eigen3 -DUKEMI_DATASETS="\"$OLDPWD/datasets\"" -DUKEMI_SOURCE="\"$OLDPWD\"" \
     "test/$test.cpp" "$@" -o "$work/run" -Wl,--allow-multiple-definition -Wl,--start-group "$build"/libukemi_{identify,landing,common}.a -Wl,--end-group \
     -lCatch2WithMain -lceres -lglog -lnlopt -lfmt -lpthread -lcholmod -lcxsparse -llapack -lblas) || exit 2
  "$work/run" >"$work/said" 2>&1
}

found=0 seeded=0
for test in $(cut -d'|' -f4 <<<"$faults" | sort -u); do
  passes "$test" || { echo "$test fails without a fault"; tail -n 20 "$work/said"; exit 1; }
done
while IFS='|' read -r file from to test sources; do
  seeded=$((seeded + 1))
  FROM=$from TO=$to perl -0pe 'BEGIN { $f = $ENV{FROM}; $t = $ENV{TO} } $n = s/\Q$f\E/$t/; END { exit($n ? 0 : 1) }' "$file" > "$work/$file" ||
    { echo "$file: not there any more: $from"; exit 1; }
  # shellcheck disable=SC2086
  if passes "$test" $sources; then echo "NOT FOUND: $file: $to"; else
    found=$((found + 1)); echo "found by $test ($(grep -c FAILED "$work/said" || true) checks): $file: $to"; fi
  cp "$file" "$work/$file"
done <<<"$faults"
echo "$found of $seeded faults found"
[ "$found" = "$seeded" ]
