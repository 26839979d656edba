#!/usr/bin/env bash
# Runs the GNU parallel lines of docs/batch.md as they are printed there, in a directory with match
# files in DIR that state no prior, and compares the merged report with that of one run.
#
#   test/parallel_line.sh
#
# The build is $RIGEL_BUILD_DIR, by default build/release. Exit code 77 without parallel.
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,/^set /{/^set /!s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
  exit 0
fi

root=$(cd "$(dirname "$0")/.." && pwd)
build=${RIGEL_BUILD_DIR:-$root/build/release}
command -v parallel >/dev/null || {
  echo "parallel_line: GNU parallel is missing (Debian: apt install parallel)" >&2
  exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
export PATH="$build/bin:$PATH" HOME="$work"

# From the line that begins with the command to the end of the indented block.
awk '/^    parallel /{on = 1} on && !/^    /{exit} on{print substr($0, 5)}' \
  "$root/docs/batch.md" >lines.sh
[[ $(wc -l <lines.sh) -ge 3 ]] || { echo "parallel_line: no lines in docs/batch.md" >&2; exit 1; }

rigel_simulate --output=DIR --pairs=11 --num_matches=100 --inter_share=0.5 2>simulate.err
sed -i -E '/^(gravity1|gravity2|axis|normal) /d' DIR/*.matches
bash -eu lines.sh

# All pairs have a motion by each solver, and the merged report is that of one run.
grep -q '"pairs": 11' whole.json
[[ $(grep -c '"failures": 0' whole.json) -eq 2 ]]
shards=$(echo shard?.json | tr ' ' ,)
rigel_compare --merge="$shards" --no_times --json=merged.json >/dev/null
rigel_compare --matches=DIR --prior=body --solvers=4pt-axis,3pt --no_times --json=one.json >/dev/null
cmp merged.json one.json
echo "parallel_line: 8 shards of 11 pairs, merged as one run has them"
