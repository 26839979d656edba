#!/usr/bin/env python3
"""How far motions of match files are from the true ones of other files of the same frames.

  test/motion_error.py --matches=DIR --truth=FILE[,FILE] [--seeds=20] [FLAG OF rigel_estimate ...]

For match files without a truth, as rigel_match makes them of a rig's images. The files of --truth
have a line `truth`, one for each file of DIR, in the order of their names. Printed for each pair:

  rotation, direction  degrees from the truth, the median and the largest over the seeds
  scale                | |t| / true |t| - 1 |, percent, likewise the median
  inliers              of how many matches, of the first seed
"""
import measure


def main():
    parser = measure.make_parser(__doc__)
    parser.add_argument("--matches", required=True, metavar="DIR", help="directory of match files")
    parser.add_argument("--truth", required=True, help="files with the truth, comma separated")
    parser.add_argument("--seeds", type=int, default=20, help="runs of rigel_estimate (20)")
    arguments, flags = parser.parse_known_args()
    files = measure.match_files(arguments.matches)
    truths = [measure.MatchFile(path).truth() for path in arguments.truth.split(",")]
    if len(truths) != len(files) or None in truths:
        raise measure.Failure("--truth: expected %d files with a line 'truth'" % len(files))
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    runs = []
    for programs.seed in range(arguments.seed, arguments.seed + arguments.seeds):
        results, _ = programs.estimate(arguments.matches, flags)
        runs.append(list(results.values()))
    rows, figures = [], []
    for number, truth in enumerate(truths):
        motions = [measure.refined_motion(run[number]) for run in runs]
        if None in motions:
            raise measure.Failure("%s: no motion" % files[number])
        rotation = [measure.rotation_error_deg(motion, truth) for motion in motions]
        direction = [measure.angle_deg(motion[1], truth[1]) for motion in motions]
        scale = [100 * abs(measure.norm(motion[1]) / measure.norm(truth[1]) - 1)
                 for motion in motions]
        first = runs[0][number]
        figures.append({"pair": measure.MatchFile(files[number]).name,
                        "rotation_deg": measure.median(rotation),
                        "rotation_max_deg": max(rotation),
                        "direction_deg": measure.median(direction),
                        "direction_max_deg": max(direction),
                        "scale_percent": measure.median(scale),
                        "inliers": first["inliers"], "matches": first["matches"]})
        rows.append(list(figures[-1].values())[:-2] +
                    ["%d of %d" % (first["inliers"], first["matches"])])
    measure.print_table(["pair", "rotation", "max", "direction", "max", "scale", "inliers"], rows)
    measure.finish(programs, arguments, pairs=figures)


if __name__ == "__main__":
    measure.run_main(main)
