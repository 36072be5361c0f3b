#!/usr/bin/env bash
# The Debian packages: each has its licence, the program's its documents, whose links hold, and asks for gnuplot.
set -euo pipefail
build_dir=$1
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cd "$work"
cpack -G DEB --config "$build_dir/CPackConfig.cmake" -B "$work" > cpack.log 2>&1 || { tail -n 20 cpack.log; exit 1; }
packages=(./*.deb)
[ ${#packages[@]} -ge 2 ]
for package in "${packages[@]}"; do
  name=$(dpkg-deb -f "$package" Package)
  dpkg-deb -x "$package" files
  grep -q 'Apache License' "files/usr/share/doc/$name/copyright"
  echo "$name: $(dpkg-deb -f "$package" Depends)"
done
[ "$(dpkg-deb -f ./ukemi_*.deb Recommends)" = gnuplot-nox ]
files/usr/bin/ukemi --version
cd files/usr/share/doc/ukemi
missing=0
for page in README.md tools/docs/*.md; do
  for link in $(grep -o ']([a-z_/]*\.\(md\|svg\|png\))' "$page" | sed 's/](//; s/)//'); do
    [ -e "$(dirname "$page")/$link" ] || { echo "$page: $link is not there"; missing=1; }
  done
done
exit $missing
