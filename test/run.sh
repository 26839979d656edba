#!/usr/bin/env bash
# Builds everything, optimized and with warnings as errors, and runs the tests. Arguments go to ctest:
#
#   test/run.sh                  all tests
#   test/run.sh -R match_file    those whose name matches
#
# Installs the Debian packages that are missing. The output of the build is shown only if it fails.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release
log=$root/build/test_build.log
mkdir -p "$root/build"

"$root/tools/install_dependencies.sh"

quietly() {
  if ! "$@" >>"$log" 2>&1; then
    cat "$log"
    echo "failed: $*"
    exit 1
  fi
}

: >"$log"
echo "building in $build"
quietly cmake -S "$root" --preset release -DRIGEL_WERROR=ON -DRIGEL_BUILD_TOOLS=ON -DRIGEL_BUILD_TESTS=ON
quietly cmake --build "$build"

exec ctest --test-dir "$build" --output-on-failure --no-tests=error -j2 "$@"
