#!/usr/bin/env bash
# clang-tidy with the repository's .clang-tidy on the library and the programs. A finding is an error.
#
#   test/tidy.sh [FILE...]        some files alone, as named from the repository's root
#
# Configures build/tidy with clang, to know how files are compiled, and builds nothing.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
build=build/tidy
mkdir -p "$build"
if ! cmake -S . -B "$build" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DRIGEL_BUILD_TESTS=OFF >"$build/configure.log" 2>&1; then
  cat "$build/configure.log"
  echo "failed: cmake"
  exit 1
fi

files=("$@")
if [[ ${#files[@]} -eq 0 ]]; then
  mapfile -t files < <(find core minimal refine problems tools -name '*.cc' | sort)
fi

# tidy FILE: silent if there is no finding. A file that is not built here, for want of OpenCV or OpenGV, is passed over.
tidy() {
  if ! grep -q "/$1\"" "$build/compile_commands.json"; then
    echo "not built here: $1"
    return
  fi
  local found
  if ! found=$(clang-tidy --quiet --warnings-as-errors='*' -p "$build" "$1" 2>/dev/null); then
    echo "$found"
    return 1
  fi
}
export -f tidy
export build

if ! printf '%s\0' "${files[@]}" | xargs -0 -P "$(nproc)" -I{} bash -c 'tidy "$1"' tidy {}; then
  echo "clang-tidy: findings above"
  exit 1
fi
echo "clang-tidy: ${#files[@]} files, no finding"
