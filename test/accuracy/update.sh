#!/usr/bin/env bash
# Builds accuracy_test, optimized, and rewrites test/accuracy/expected.json with what it measures now; says which
# medians changed. Arguments: none. For another build directory: cmake --build DIR --target rigel_accuracy_update
set -euo pipefail

if [[ $# -gt 0 ]]; then
  sed -n '2,3s/^# //p' "${BASH_SOURCE[0]}" >&2
  [[ $# -eq 1 && ( $1 == -h || $1 == --help ) ]] && exit 0
  exit 2
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$root/build/release
log=$root/build/accuracy_update.log
mkdir -p "$root/build"

"$root/tools/install_dependencies.sh"

quietly() {
  if ! "$@" >>"$log" 2>&1; then
    tail -n 40 "$log" >&2
    echo "failed: $*; all of its output is in $log" >&2
    exit 1
  fi
}

: >"$log"
echo "building in $build" >&2
quietly cmake -S "$root" --preset release -DRIGEL_BUILD_TESTS=ON
quietly cmake --build "$build" --target accuracy_test
exec "$build/bin/accuracy_test" --update
