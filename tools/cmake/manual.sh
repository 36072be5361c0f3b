#!/usr/bin/env bash
# manual.sh PROGRAM FOLDER: bash completion, and a man page for the program and each of its verbs by help2man.
set -euo pipefail
export PATH="$(dirname "$1"):$PATH"
mkdir -p "$2"
ukemi manual "$2"
command -v help2man >/dev/null || { echo "no help2man: no man pages"; exit; }
page() {
  local name=${1// /-}
  help2man --no-info --name="$2" --version-string="$(ukemi --version)" "$1" |
    sed "s/^\\.TH UKEMI /.TH ${name^^} /; s/^ukemi \\\\- /${name//-/\\\\-} \\\\- /" >"$3/$name.1"
}
export -f page
xargs -d '\n' -P "$(nproc)" -I{} bash -c 'IFS=$(printf "\t") read -r words does <<<"$1"; page "$words" "$does" "$2"' _ {} "$2" <"$2/pages"
