#!/usr/bin/env bash
# Measures which solver wins where and writes docs/solver_choice.md (some minutes on two cores; with the
# real set where RIGEL_REAL_DATA names the folder of real data).
#
#   test/solver_choice_study.sh [PAIRS]
#
# The build is $RIGEL_BUILD_DIR, by default build/release.
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,/^set /{/^set /!s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
  exit 0
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=$(cd "${RIGEL_BUILD_DIR:-$root/build/release}/bin" && pwd)
pairs=${1:-100}
out=$root/docs/solver_choice.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
solvers=3pt,4pt,4pt-axis,5pt+1,auto

{
  echo "<!-- Written by test/solver_choice_study.sh; do not edit. -->"
  echo
  echo "# Which solver, and what \`auto\` does"
  echo
  echo "\`--solver=auto\` begins with the most constrained solver that the priors allow: \`3pt\` (planar motion), \`4pt\` (known"
  echo "vertical), \`4pt-axis\` (known axis). It runs 50 iterations. If its motion is doubtful, others follow:"
  echo
  echo "1. The solvers without a prior run 100 iterations each: first \`5pt+1\`. If most matches are of camera pairs with fewer"
  echo "   than five matches, \`6pt-ventura\` and \`17pt-li\` run too. The other constrained solvers come after them."
  echo "2. The first solver whose motion is not doubtful continues alone."
  echo "3. If there is none, the best constrained solver and those without a prior take turns. They stop when the best one has"
  echo "   drawn a sample of inliers with the required confidence."
  echo
  echo "All solvers share one budget, \`--max_iterations\`. A motion is doubtful for one of three reasons:"
  echo
  echo "- fewer than half of the matches agree with it;"
  echo "- at twice the threshold, 10 percent more matches agree;"
  echo "- it deviates from the prior by more than 2 degrees."
  echo
  echo "\`auto\` in the JSON of rigel_estimate says what was tried and why."
  echo
  echo "The refinement does not hold the prior, so a prior only saves time. With many outliers a smaller sample needs fewer"
  echo "iterations. A wrong prior costs the time of the first 50 iterations. But a prior that is weighted in the refinement"
  echo "(\`--use_prior_in_refine\`) must be right."
  echo
  echo "$pairs pairs for each row, 300 intra-camera matches, 50 percent outliers, 0.5 px. \`planar\` is motion in the plane."
  echo "\`random\` has vertical motion, which contradicts the prior of \`3pt\`. Noise is the error of the prior, about a random axis"
  echo "(\`--prior=body --prior_noise_deg\`). A cell has the medians of the raw and of the refined rotation error, in degrees, and"
  echo "the median time in ms."
  echo
  echo "| motion | turn | noise | 3pt | 4pt | 4pt-axis | 5pt+1 | auto |"
  echo "| --- | --- | --- | --- | --- | --- | --- | --- |"
  for motion in planar random; do
    for turn in 0.2 1 10 20; do
      dir=$work/$motion-$turn
      "$bin/rigel_simulate" --output="$dir" --pairs="$pairs" --motion=$motion --rotation_deg=$turn --num_matches=300 \
        --outlier_share=0.5 >/dev/null 2>&1
      for noise in 0 1 20; do
        "$bin/rigel_compare" --matches="$dir" --solvers=$solvers --prior=body --prior_noise_deg=$noise \
          --prior_noise_axis=random --threads=2 >"$work/table" 2>/dev/null
        row="| $motion | $turn deg | $noise deg |"
        for solver in ${solvers//,/ }; do
          row+=" $(awk -v s="$solver" '$1 == s && !found { found = 1; print $3 " / " $4 " / " $NF }' "$work/table") |"
        done
        echo "$row"
      done
    done
    echo "$motion done" >&2
  done
  echo
  echo "## What a wrong prior costs"
  echo
  echo "\`auto\` with \`--prior=body\` against \`5pt+1\`, which needs no prior. 400 matches, 30 percent outliers, 0.5 px. The rig is"
  echo "two forward cameras (\`stereo\`) or a ring of 4 or 8. It turns about the body's down, where the prior is right, or about a"
  echo "random axis, where it is wrong.${RIGEL_REAL_DATA:+ euroc_loop is a real drone that turns by 26 degrees.}"
  echo
  echo "A cell has the median / 90th percentile over the pairs: of the time of a pair over that of \`5pt+1\`, of the times in ms,"
  echo "and of the refined rotation errors in degrees. A time is the shortest of 9 runs, which alternate between the two solvers"
  echo "(\`test/solver_choice_times.py\`)."
  echo
  echo "| rig, turn | pairs | time over 5pt+1's | auto, ms | 5pt+1, ms | auto, deg | 5pt+1, deg |"
  echo "| --- | --- | --- | --- | --- | --- | --- |"
  sets=()
  many=$((5 * pairs))  # medians of as many still differ by some percent
  for rig in stereo "ring of 4" "ring of 8"; do
    flags=()
    [[ $rig == stereo ]] || flags=(--ring --num_cameras="${rig##* }")
    for axis in y random; do
      for turn in 1 10 30; do
        dir=$work/${rig// /_}-$axis-$turn
        "$bin/rigel_simulate" --output="$dir" --pairs="$many" "${flags[@]}" --num_matches=400 --outlier_share=0.3 \
          --rotation_deg=$turn --rotation_axis=$axis >/dev/null 2>&1
        name="$rig, $turn deg about $([[ $axis == y ]] && echo down || echo "a random axis")"
        sets+=("$name=$dir")
      done
    done
  done
  [[ -z ${RIGEL_REAL_DATA:-} ]] || sets+=("euroc_loop=$RIGEL_REAL_DATA/euroc_loop")
  "$root/test/solver_choice_times.py" "$bin" "${sets[@]}"
} >"$work/tables"
mv "$work/tables" "$out"
echo "wrote $out" >&2
