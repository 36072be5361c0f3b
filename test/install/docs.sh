#!/usr/bin/env bash
# Runs the commands of README.md and of tools/docs as they stand there, in a copy of the shipped data: the ```sh blocks (but those
# under a line "<!-- not run: why -->"), the table of results, the picture; answers.py looks at what README's answer. And
# tools/docs/verbs.md names the options that there are.
set -euo pipefail
source_dir=$1 build_dir=$2
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
ln -s "$source_dir/datasets" "$source_dir/test" "$work"
cd "$work"
export PATH="$build_dir:$PATH"

pages=$(cd "$source_dir/tools/docs" && grep -l '^```sh$' ./*.md | sed 's#^\./##; s#\.md$##')
[ "$(wc -w <<< "$pages")" -ge 19 ]
for page in README $pages; do
  file="$source_dir/tools/docs/$page.md"; [ $page = README ] && file="$source_dir/README.md"
  awk '/^<!-- not run: [^ ]/ { skip = 1; next }
       /^```sh$/ { inside = !skip; skip = 0; next }
       /^```/ { inside = 0; next }
       inside' "$file" > $page.sh
  sed -i "s#^ukemi #echo \"$page: line \$LINENO\" >&2; ukemi #" $page.sh
  [ "$(grep -c 'ukemi ' $page.sh)" -ge 1 ]
  bash -euo pipefail $page.sh > $page.log 2> $page.err || { tail -n 5 $page.err; exit 1; }
  [ $page != README ] || cp -r out answers  # later pages write to the same folders
done
for d in demo/compare identify predict optimize simulate design compare calibrate plan watch hold_it map hold falling fallen ratings risk worst \
         robust plans five_seeds twenty_seeds files scene robot_file log_file exported fit_files landing_files bench_scenes bench_integrators \
         search two_bumps theory words play warned first first_landing actuator_file; do
  [ -s "out/$d/summary.json" ]
done

awk -F'`' '/^\| .*\| `ukemi / { print $2 " -o out/table_" ++n " --quiet" }' "$source_dir/README.md" |
  sed 's#PAPER#datasets/scenes/paper.toml --actuator datasets/actuators/table2.toml#' > table.sh
[ "$(wc -l < table.sh)" = 5 ]
bash -euo pipefail table.sh > table.log 2>&1 || { tail -n 5 table.log; exit 1; }
grep '^peak' table.log
cp -r out/table_* answers
python3 "$source_dir/test/install/answers.py" answers "$source_dir/README.md"

"$source_dir/tools/docs/landing.sh" landing.svg 2> picture.err
"$source_dir/tools/docs/leg.sh" leg.svg 2>> picture.err
for peak in 42 98; do grep -q "foot $peak m/s" leg.svg; grep -q "foot $peak m/s" "$source_dir/tools/docs/leg.svg"; done
for peak in 466 187; do grep -q ": $peak m/s" landing.svg; grep -q ": $peak m/s" "$source_dir/tools/docs/landing.svg"; done

verbs="identify predict design simulate optimize map ratings risk robot trade atlas compare calibrate demo"
for v in $verbs; do ukemi "$v" --help; done > help.txt
for b in integrators identify optimizers stability scenes; do ukemi bench $b --help; done >> help.txt
options() { grep -o -e '--[a-z][a-z-]*' "$1" | sort -u; }
diff <(sed '/^Example/d' help.txt | grep -o '^ *\(-., *\)\?\(-.,\)\?--[a-z][a-z-]*' | grep -o -e '--[a-z-]*' | grep -v -e '--help' | sort -u) \
     <(options "$source_dir/tools/docs/verbs.md" | grep -v -e '--help' -e '--version')
