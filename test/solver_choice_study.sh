#!/usr/bin/env bash
# Measures which solver wins where and writes docs/solver_choice.md (a minute on two cores):
# test/solver_choice_study.sh [BUILD_DIR [PAIRS]]
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=$(cd "${1:-$root/build/release}/bin" && pwd)
pairs=${2:-100}
out=$root/docs/solver_choice.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
solvers=3pt,4pt,4pt-axis,5pt+1,auto

{
  echo "<!-- Written by test/solver_choice_study.sh; do not edit. -->"
  echo
  echo "# Which solver, and what \`auto\` does"
  echo
  echo "\`--solver=auto\` takes the most constrained solver that the priors allow: \`3pt\` (planar motion), \`4pt\` (known"
  echo "vertical), \`4pt-axis\` (known axis), in the end \`5pt+1\`, which needs none. While fewer than half of the matches agree"
  echo "with the motion, or it has turned away from the prior by more than 2 degrees, the next one joins, and the best score"
  echo "wins. The refinement does not hold the prior, so that what a prior is worth is time: with many outliers the smaller"
  echo "sample needs fewer iterations, and with a wrong prior the less constrained solver still finds the motion. What is"
  echo "weighed in the refinement (\`--use_prior_in_refine\`) must be right. Where more than half of the matches are outliers, all"
  echo "solvers of the list run."
  echo
  echo "$pairs pairs a row, 300 intra-camera matches, 50 percent outliers, 0.5 px; \`planar\` is motion in the plane, \`random\`"
  echo "has vertical motion, which the prior of \`3pt\` denies; noise is the error of the prior (\`--prior=body"
  echo "--prior_noise_deg\`, about a random axis). Each cell: median of the raw"
  echo "and of the refined rotation error, degrees, and the median time, ms."
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
} >"$work/tables"
mv "$work/tables" "$out"
echo "wrote $out" >&2
