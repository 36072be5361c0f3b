#!/usr/bin/env bash
# Draws tools/docs/landing.svg, the picture of README.md: landing.sh [FILE]. Needs `ukemi` in the PATH or built in build/release.
set -euo pipefail
picture=$(realpath -m "${1:-$(dirname "$0")/landing.svg}")
cd "$(dirname "$0")/../.."
PATH="$PATH:$PWD/build/release"
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
scene=(datasets/scenes/paper.toml --actuator datasets/actuators/table2.toml --quiet --no-report)
ukemi simulate "${scene[@]}" --hold -45 -o "$work/held" >"$work/log"
ukemi optimize "${scene[@]}" --objective tolerant -o "$work/best" >>"$work/log" 2>&1
ukemi simulate "${scene[@]}" --motion "$work/best/motion.toml" -o "$work/best_played" >>"$work/log"
# The largest |ddr_0| of each 2 ms, so that no peak is lost; 600 x 240 units are 1.2 s and 500 m/s^2.
awk -F, '
  function x(t) { return 60 + 500 * t }
  function y(a) { return 270 - 0.48 * a }
  function label(px, py, text, rest) { printf "<text x=\"%d\" y=\"%d\" %s>%s</text>\n", px, py, rest, text }
  function curve(n, color, name, bin, points) {
    for (bin = 0; bin <= 600; ++bin) if ((n, bin) in most) points = points sprintf("%.1f,%.1f ", x(bin / 500), y(most[n, bin]))
    printf "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" points=\"%s\"/>\n", color, points
    label(x(when[n]) + 6, y(peak[n]) + 4, name sprintf(": %.0f m/s\302\262", peak[n]), "fill=\"" color "\"")
  }
  FNR == 1 { ++run; split("", column) }
  /^#/ { next }
  !("acc" in column) { for (i = 1; i <= NF; ++i) column[$i] = i; next }
  { t = $column["t"]; a = $column["acc"]; bin = int(500 * t); if (t > 1.2) next
    if (!((run, bin) in most) || a > most[run, bin]) most[run, bin] = a
    if (a > peak[run]) { peak[run] = a; when[run] = t } }
  END {
    print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 690 310\" font-family=\"sans-serif\" font-size=\"12\">"
    print "<rect width=\"690\" height=\"310\" fill=\"white\"/>"
    for (a = 0; a <= 500; a += 100) {
      printf "<line x1=\"60\" x2=\"660\" y1=\"%.0f\" y2=\"%.0f\" stroke=\"#ddd\"/>\n", y(a), y(a)
      label(52, y(a) + 4, a, "text-anchor=\"end\"")
    }
    for (t = 0; t <= 1.21; t += 0.2) label(x(t), 288, sprintf("%.1f", t), "text-anchor=\"middle\"")
    label(360, 304, "time after release [s]", "text-anchor=\"middle\"")
    label(16, 150, "thigh acceleration [m/s\302\262]", "text-anchor=\"middle\" transform=\"rotate(-90 16 150)\"")
    curve(1, "#c0392b", "reference held at -45\302\260")
    curve(2, "#1f6fb2", "best motion that a robot can repeat")
    print "</svg>"
  }' "$work/held/trajectory.csv" "$work/best_played/trajectory.csv" >"$work/picture"
mv "$work/picture" "$picture"
