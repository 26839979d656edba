#!/usr/bin/env bash
# Fuzzes every target of test/fuzz with libFuzzer under the address and undefined-behaviour sanitizers, with clang:
#
#   test/fuzz.sh SECONDS [TARGET...]     seconds in total, shared evenly; all targets unless some are named (estimate)
#
# Begins with the seeds in test/fuzz/seeds and what earlier runs found in build/fuzz/corpus. Prints executions and
# seconds of each target; exits with 1 and names the input if one crashes, leaks or takes more than 5 seconds.
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,/^set /{/^set /!s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
  exit 0
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/fuzz
seconds=${1:?seconds in total}
shift
mkdir -p "$build"

sanitizers=address,undefined,float-cast-overflow
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_CXX_COMPILER="${CLANGXX:-clang++}" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g -fno-omit-frame-pointer" -DRIGEL_BUILD_FUZZERS=ON \
  -DCMAKE_CXX_FLAGS="-fsanitize=fuzzer-no-link,$sanitizers -fno-sanitize-recover=all" >"$build.log" 2>&1 &&
  cmake --build "$build" --target rigel_fuzzers >>"$build.log" 2>&1 || { cat "$build.log"; exit 1; }

targets=("$@")
if [[ ${#targets[@]} -eq 0 ]]; then
  for program in "$build"/bin/*_fuzz; do
    name=$(basename "$program")
    targets+=("${name%_fuzz}")
  done
fi
each=$((seconds / ${#targets[@]}))
failed=0
export UBSAN_OPTIONS=print_stacktrace=1 ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1
for name in "${targets[@]}"; do
  corpus=$build/corpus/$name
  mkdir -p "$corpus"
  log=$build/$name.log
  if "$build/bin/${name}_fuzz" -max_total_time="$each" -timeout=5 -rss_limit_mb=2048 -print_final_stats=1 \
    -artifact_prefix="$build/$name-" "$corpus" "$root/test/fuzz/seeds/$name" >"$log" 2>&1; then
    verdict=ok
  else
    verdict="FAILED, see $log"
    failed=1
  fi
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  printf '%-18s %10s executions %6s s  %s\n' "$name" "${executions:-?}" "$each" "$verdict"
done
exit $failed
