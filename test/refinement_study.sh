#!/usr/bin/env bash
# Measures the refinement against the Cramer-Rao bound and writes docs/refinement_tables.md (five
# minutes on two cores).
#
#   test/refinement_study.sh [PAIRS]
#
# The build is $RIGEL_BUILD_DIR, by default build/release.
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,/^set /{/^set /!s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
  exit 0
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=$(cd "${RIGEL_BUILD_DIR:-$root/build/release}/bin" && pwd)
pairs=${1:-500}
out=$root/docs/refinement_tables.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# simulate NAME FLAGS...: the folder's name; made once.
simulate() {
  local dir=$work/$1
  shift
  [[ -d $dir ]] || "$bin/rigel_simulate" --output="$dir" --pairs="$pairs" "$@" >/dev/null 2>&1
  echo "$dir"
}

# compare DIR FLAGS...: rigel_compare with the exact prior.
compare() {
  local dir=$1
  shift
  "$bin/rigel_compare" --matches="$dir" --prior=truth --solvers=4pt --threads=2 "$@" 2>/dev/null
}

# The line of the solver in the second table: efficiencies and NEES.
efficiency() { awk '$1 == "4pt" { line = $0 } END { $0 = line; print $2, $3 }'; }
nees() { awk '$1 == "4pt" { line = $0 } END { $0 = line; print $4 " of " $5 " (" $6 "-" $8 ")" }'; }
# A field of a JSON report: statistic KEY of GROUP and QUANTITY.
field() {
  awk -v group="\"$2\":" -v quantity="\"$3\":" -v key="\"$4\":" '
    $1 ~ /^"(raw|refined|bound)":/ { inside = $1 == group }
    inside && $1 == quantity { found = 1 }
    found && $1 == key { gsub(/,/, "", $2); print $2; exit }' "$1"
}

{
  echo "<!-- Written by test/refinement_study.sh; do not edit. -->"
  echo
  echo "# The refinement against the Cramer-Rao bound"
  echo
  echo "## Efficiency"
  echo
  echo "RMS error over RMS bound, rotation and direction of translation. Each row has $pairs pairs, 0.5 px, exact"
  echo "vertical (\`--prior=truth\`), solver \`4pt\`, unknown noise and |t|: estimate and bound have the weak prior of the length."
  echo "The rig has two cameras that look ahead, 1 m apart, 640 x 480 pixels."
  echo "NEES: mean over its degrees of freedom, with the 99 percent interval of right covariances."
  echo
  echo "| motion | matches | cameras | turn | seed | full | bundle | prior | depths | prior-depths | algebraic | NEES of full |"
  echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
  for motion in random forward; do
    for matches in 100 600; do
      for share in 0 0.5; do
        for turn in 1 10; do
          for seed in 1 2 3; do
            dir=$(simulate "$motion-$matches-$share-$turn-$seed" --motion=$motion --num_matches=$matches \
              --inter_share=$share --rotation_deg=$turn --seed=$seed)
            flags=(--seed=$seed)
            cameras="half inter"
            if [[ $share == 0 ]]; then cameras=intra; fi
            row="| $motion | $matches | $cameras | $turn deg | $seed |"
            for form in full bundle prior depths prior-depths; do
              compare "$dir" "${flags[@]}" --refine=$form >"$work/$form"
              row+=" $(efficiency <"$work/$form") |"
            done
            row+=" $(compare "$dir" "${flags[@]}" --residual=algebraic | efficiency) |"
            row+=" $(nees <"$work/full") |"
            echo "$row"
          done
        done
      done
    done
    echo "$motion done" >&2
  done

  echo
  echo "## A prior with noise"
  echo
  echo "RMS rotation errors, degrees. The gravity of view 2 has an error of exactly that pitch, and the refinement weights it by"
  echo "that sigma (\`--use_prior_in_refine\`). $pairs pairs, 200 intra-camera matches, 1 degree, solver \`4pt\`. The bound"
  echo "includes the prior; the efficiency is RMS error over it."
  echo
  echo "| motion | noise | raw | with the prior | without | with / without | bound | efficiency |"
  echo "| --- | --- | --- | --- | --- | --- | --- | --- |"
  for motion in random forward sideways; do
    dir=$(simulate "prior-$motion" --motion=$motion --num_matches=200 --seed=1)
    for noise in 0 0.01 0.02 0.05 0.1 0.2 0.5 1; do
      # A sigma of zero would be none.
      sigma=$([[ $noise == 0 ]] && echo 0.0001 || echo $noise)
      flags=(--prior_noise_deg=$noise)
      compare "$dir" "${flags[@]}" --prior_sigma_deg=$sigma --use_prior_in_refine --json="$work/with.json" >/dev/null
      compare "$dir" "${flags[@]}" --json="$work/without.json" >/dev/null
      raw=$(field "$work/with.json" raw rotation_deg rms)
      with=$(field "$work/with.json" refined rotation_deg rms)
      without=$(field "$work/without.json" refined rotation_deg rms)
      bound=$(field "$work/with.json" bound rotation_deg rms)
      awk -v m=$motion -v n=$noise -v r="$raw" -v a="$with" -v b="$without" -v c="$bound" 'BEGIN {
        printf "| %s | %s deg | %.4f | %.4f | %.4f | %.3f | %.4f | %.3f |\n", m, n, r, a, b, a / b, c, a / c }'
    done
    echo "prior, $motion done" >&2
  done
} >"$work/tables.md"
mv "$work/tables.md" "$out"
echo "wrote $out"
