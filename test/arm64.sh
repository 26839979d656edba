#!/usr/bin/env bash
# Cross-builds core and minimal for arm64, runs their tests under qemu, and compares the inliers of seeded RANSAC runs of
# every solver with those of a build for this machine: the same lines on both.
#
#   test/arm64.sh
#
# Installs Debian's cross compiler and qemu where they are missing. Builds into build/arm64 and build/arm64_host, on as
# many cores as CMAKE_BUILD_PARALLEL_LEVEL says. Exit code 0: all tests pass and the inliers are the same.
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,/^set /{/^set /!s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
  exit 0
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
arm=$root/build/arm64
host=$root/build/arm64_host
triple=aarch64-linux-gnu
mkdir -p "$root/build"

"$root/tools/install_dependencies.sh" "g++-$triple" qemu-user-static googletest

quietly() {
  if ! "$@" >>"$arm.log" 2>&1; then
    cat "$arm.log"
    echo "failed: $*"
    exit 1
  fi
}

: >"$arm.log"
echo "building in $arm"
quietly cmake -S "$root/test/arm64" -B "$arm" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_CXX_COMPILER="$triple-g++" \
  -DCMAKE_C_COMPILER="$triple-gcc" "-DCMAKE_CROSSCOMPILING_EMULATOR=qemu-aarch64-static;-L;/usr/$triple"
quietly cmake --build "$arm" --target core_test minimal_test ransac_inliers
echo "building in $host"
quietly cmake -S "$root/test/arm64" -B "$host" -G Ninja -DCMAKE_BUILD_TYPE=Release
quietly cmake --build "$host" --target ransac_inliers

ctest --test-dir "$arm" --output-on-failure --no-tests=error
"$host/ransac_inliers" >"$host/inliers.txt"
qemu-aarch64-static -L "/usr/$triple" "$arm/ransac_inliers" >"$arm/inliers.txt"
if ! diff "$host/inliers.txt" "$arm/inliers.txt"; then
  echo "failed: other inliers on arm64 (>) than on $(uname -m) (<)"
  exit 1
fi
echo "arm64: $(wc -l <"$arm/inliers.txt") RANSAC runs with the same inliers as on $(uname -m)"
