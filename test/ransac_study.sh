#!/usr/bin/env bash
# Measures RANSAC with the refinement and writes docs/ransac_tables.md (two hours, most of them for the hostile pairs;
# RIGEL_HOSTILE_PAIRS=20 makes it ten minutes). Wants a core that has nothing else to do.
#
#   test/ransac_study.sh [PAIRS [MATCHES]]     MATCHES: a directory of match files of real images
#
# The build is $RIGEL_BUILD_DIR, by default build/release.
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,/^set /{/^set /!s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
  exit 0
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=$(cd "${RIGEL_BUILD_DIR:-$root/build/release}/bin" && pwd)
hostile=${RIGEL_HOSTILE_PAIRS:-1000}
pairs=${1:-200}
matches=${2:-}
out=$root/docs/ransac_tables.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# table FLAGS...: what rigel_benchmark prints, as a block.
table() {
  "$bin/rigel_benchmark" "$@" 2>/dev/null | sed 's/^\(.\)/    \1/'
  echo "$* done" >&2
}

{
  echo "<!-- Written by test/ransac_study.sh; do not edit. -->"
  echo
  echo "# RANSAC and refinement together"
  echo
  echo "One thread, $pairs pairs for each row, random motion (planar for \`3pt\`), 1 degree, 0.5 px, exact priors. Times are the"
  echo "shortest of three runs of a pair. The columns:"
  echo
  echo "- success: the share of pairs whose rotation error is within three times the pair's own Cramer-Rao bound;"
  echo "- bound: RMS error over RMS bound of the pairs that succeed;"
  echo "- clean: median error over that of the same pairs without outliers;"
  echo "- missed: failed pairs that succeed if they are refined from the truth."
  echo
  echo "## Time: 626 matches, 30 percent outliers"
  echo
  echo "OpenGV's rows need a build with \`RIGEL_WITH_OPENGV\`."
  echo
  table --ransac=speed --pairs="$pairs"
  if [[ -n $matches ]]; then
    echo
    echo "## Time on $(basename "$matches")"
    echo
    echo "The error includes that of the ground truth. The prior is that a car turns about its vertical."
    echo
    table --ransac=speed --matches="$matches" --prior=body
  fi
  echo
  echo "## 10 to 80 percent outliers, 300 inliers"
  echo
  table --ransac=outliers --pairs="$pairs"
  echo
  echo "## Parts left out or added"
  echo
  echo "The errors are the same in all rows. The finalists cost time here, and so do more iterations than needed. The bail-out"
  echo "test saves time among many outliers; after it early termination saves little. Times that differ by less than a tenth"
  echo "may be the machine's noise."
  echo
  table --ransac=ablation --pairs="$pairs"
  echo
  echo "## A car that moves by itself"
  echo
  echo "Static: the share of pairs whose motion fits nine in ten of the static matches that the true motion fits."
  echo
  table --ransac=moving --pairs="$pairs"
  echo
  echo "## No match that follows any motion"
  echo
  echo "Default options, two cameras, half of the matches between them, all points anywhere in the images. Times are processor"
  echo "times; the largest is that over the pairs of a row. Any motion as an answer would be wrong. Measured by"
  echo "\`rigel_benchmark --ransac=hostile --pairs=$hostile\`."
  echo
  table --ransac=hostile --pairs="$hostile"
} >"$work/tables.md"
mv "$work/tables.md" "$out"
echo "wrote $out"
