#!/usr/bin/env bash
# From a fresh clone to a table of how accurate each solver is.
#
#   tools/quickstart.sh          on a simulated drive of a car with two cameras, 50 frame pairs
#   tools/quickstart.sh DIR      on the match files (*.matches) in DIR
#
# Installs the Debian packages that are missing and builds the programs, both only where needed. The table goes to
# stdout, all else to stderr; the exit code is that of rigel_compare.
set -euo pipefail

say() { echo "quickstart: $*" >&2; }

usage="usage: quickstart.sh [DIRECTORY OF MATCH FILES]"
if [[ $# -eq 1 && ( $1 == -h || $1 == --help ) ]]; then
  echo "$usage"
  exit 0
fi
if [[ $# -gt 1 || ${1-} == -* ]]; then
  echo "$usage" >&2
  exit 2
fi
if [[ $# -eq 1 && ! -d $1 ]]; then
  say "$1: not a directory"
  exit 1
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release
log=$root/build/quickstart.log
mkdir -p "$root/build"

"$root/tools/install_dependencies.sh"

# quietly COMMAND...: its output goes to the log, whose end is shown if it fails.
quietly() {
  if ! "$@" >>"$log" 2>&1; then
    tail -n 40 "$log" >&2
    say "failed: $*; all of its output is in $log"
    exit 1
  fi
}

say "building in $build (the first time takes some minutes)"
: >"$log"
quietly cmake -S "$root" --preset release -DRIGEL_BUILD_TOOLS=ON
quietly cmake --build "$build" --target rigel_simulate rigel_compare

if [[ $# -eq 1 ]]; then
  matches=$1
else
  matches=$root/build/quickstart
  rm -rf "$matches"
  mkdir -p "$matches"
  say "simulating 50 frame pairs in $matches"
  quietly "$build/bin/rigel_simulate" --output="$matches" --pairs=50 --num_matches=200 \
    --noise_px=0.5 --rotation_deg=1 --motion=forward --inter_share=0.25 --outlier_share=0.2 --seed=1
fi

say "comparing the solvers on $matches"
exec "$build/bin/rigel_compare" --matches="$matches" --solvers=4pt-approx,4pt,17pt-li,6pt-ventura,5pt+1
