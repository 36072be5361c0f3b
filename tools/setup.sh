#!/usr/bin/env bash
# Sourced by demo.sh and test.sh: installs what is missing (Debian 12 packages) and goes to the project's root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
packages=(g++ cmake ninja-build ccache git ca-certificates libeigen3-dev libceres-dev libnlopt-dev libfmt-dev libtomlplusplus-dev
          libcli11-dev nlohmann-json3-dev libboost-dev gnuplot-nox help2man liburdfdom-dev "$@")
missing=()
for p in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$p" 2>/dev/null | grep -q 'install ok installed' || missing+=("$p")
done
if [ ${#missing[@]} -gt 0 ]; then
  echo "installing: ${missing[*]}"
  as_root=(); [ "$(id -u)" = 0 ] || as_root=(sudo)
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi
export CCACHE_DIR="${CCACHE_DIR:-$HOME/.cache/ccache}"
