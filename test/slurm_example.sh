#!/usr/bin/env bash
# Runs the Slurm jobs of docs/batch.md as they are printed there, on the Slurm that SLURM_CONF names: all that is changed are
# the match files, four tasks instead of 16 and one processor instead of 8. The merged report has to be that of one run.
#
#   SLURM_CONF=DIR/slurm.conf test/slurm_example.sh
#
# The build is $RIGEL_BUILD_DIR, by default build/release. Exit code 77 without a Slurm.
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,/^set /{/^set /!s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
  exit 0
fi

root=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "${RIGEL_BUILD_DIR:-$root/build/release}" && pwd)
if [[ -z ${SLURM_CONF:-} ]] || ! command -v sbatch >/dev/null || ! sinfo -h >/dev/null; then
  echo "slurm_example: SLURM_CONF names no Slurm that runs" >&2
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
export PATH="$build/bin:$PATH"

# The indented blocks that begin with #!/bin/bash: job1.sh, job2.sh.
awk '/^    #!\/bin\/bash$/{on = 1; ++job} on && !/^    /{on = 0} on{print substr($0, 5) > ("job" job ".sh")}' \
  "$root/docs/batch.md"
sed -i 's#/data/drive#DIR#; s/--array=0-15$/--array=0-3/; s/--cpus-per-task=8$/--cpus-per-task=1/' job1.sh
for change in 'matches=DIR ' 'array=0-3$' 'cpus-per-task=1$'; do
  grep -q -- "$change" job1.sh || { echo "slurm_example: docs/batch.md has another job" >&2; exit 1; }
done
cat job1.sh job2.sh

rigel_simulate --output=DIR --pairs=23 --num_matches=100 --inter_share=0.5 2>simulate.err
array=$(sbatch --parsable job1.sh)
merge=$(sbatch --parsable --dependency=afterok:"$array" job2.sh)
echo "array job $array, merge job $merge"
for _ in $(seq 240); do
  [[ -z $(squeue -h -j "$array,$merge" 2>/dev/null) ]] && break
  sleep 0.5
done
ls shard*.json whole.json

rigel_compare --matches=DIR --prior=body --solvers=4pt-axis,3pt --no_times --json=one.json >/dev/null
cmp whole.json one.json
grep -q '"pairs": 23' whole.json
echo "slurm_example: 4 shards of 23 pairs, merged as one run has them: cmp finds no difference"
