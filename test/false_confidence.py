#!/usr/bin/env python3
"""How many motions are wrong and nobody says so?

  test/false_confidence.py --poses=KITTI/poses/00.txt --rig_dir=DIR [--pairs=200]

Rigs drive through the street with the motions of a recorded drive: a stereo rig as KITTI's without
any outlier, and the rigs of --rigs with --outliers. rigel_estimate runs with each solver and, with
--prior=body, no sensor. Noise is unknown. Printed for each rig and solver:

  not ok    pairs whose status is not ok
  wrong     pairs with status ok and a rotation error above --limit_deg
  doubtful  those of them that are called doubtful
  unknown   those of them whose rotation is stated as not observable
  quiet     those of them that are neither: nobody says so
  p99, max  the 99th percentile and the largest rotation error of the pairs with status ok, degrees

--pairs are taken at equal distances from the drive.
"""
import os
import tempfile

import measure

SOLVERS = "auto,4pt-axis,3pt"


def judge(results, truths, limit_deg):
    """The figures of one run of rigel_estimate."""
    figures = {"pairs": len(truths), "not_ok": 0, "wrong": 0, "doubtful": 0, "unknown": 0,
               "quiet": 0, "quiet_pairs": []}
    errors = []
    for name, truth in truths.items():
        pair = results.get(name, {})
        motion = measure.refined_motion(pair)
        if pair.get("status") != "ok" or motion is None:
            figures["not_ok"] += 1
            continue
        errors.append(measure.rotation_error_deg(motion, truth))
        if errors[-1] <= limit_deg:
            continue
        doubtful, unknown = bool(pair.get("doubtful")), not pair.get("rotation_observable")
        figures["wrong"] += 1
        figures["doubtful"] += doubtful
        figures["unknown"] += unknown
        if not doubtful and not unknown:
            figures["quiet"] += 1
            figures["quiet_pairs"].append(name)
    errors.sort()
    figures["p99_deg"] = errors[int(0.99 * len(errors))] if errors else None
    figures["max_deg"] = errors[-1] if errors else None
    return figures


def measure_rig(programs, rig, outliers, arguments):
    """The figures of a rig, one for each solver."""
    every = max(1, measure.count_poses(arguments.poses) // arguments.pairs)
    with tempfile.TemporaryDirectory() as folder:
        programs.simulate(folder, rig, arguments.pairs, poses=arguments.poses, every=every,
                          num_matches=arguments.matches, outlier_share=outliers,
                          inter_share=arguments.inter_share)
        truths = {file.name: file.truth()
                  for file in map(measure.MatchFile, measure.match_files(folder))}
        figures = []
        for solver in arguments.solvers.split(","):
            results, _ = programs.estimate(folder, ["--solver=" + solver, "--prior=body"])
            figures.append({"rig": measure.rig_name(rig), "outliers": outliers, "solver": solver,
                            **judge(results, truths, arguments.limit_deg)})
    return figures


def main():
    parser = measure.make_parser(__doc__, pairs=200)
    parser.add_argument("--poses", required=True, help="file of KITTI poses, or a directory")
    measure.add_rig_dir_flag(parser)
    parser.add_argument("--rigs", default="stereo,waymo,nuscenes",
                        help="`stereo` has no outliers (stereo,waymo,nuscenes)")
    parser.add_argument("--solvers", default=SOLVERS, help="comma separated (%s)" % SOLVERS)
    parser.add_argument("--matches", type=int, default=300, help="matches of a pair (300)")
    parser.add_argument("--outliers", type=float, default=0.2,
                        help="share of outliers, but of the stereo rig (0.2)")
    parser.add_argument("--inter_share", type=float, default=0,
                        help="share of matches between different cameras (0)")
    parser.add_argument("--limit_deg", type=float, default=0.2,
                        help="a larger rotation error is wrong, degrees (0.2)")
    arguments = parser.parse_args()
    if not os.path.exists(arguments.poses):
        parser.error("--poses: %s is not there" % arguments.poses)
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    settings = []
    with tempfile.TemporaryDirectory() as folder:
        stereo = measure.write_stereo_rig(folder)
        for name in arguments.rigs.split(","):
            if name == "stereo":
                settings += measure_rig(programs, stereo, 0, arguments)
            else:
                rig = measure.rig_files(name, arguments.rig_dir)[0]
                settings += measure_rig(programs, rig, arguments.outliers, arguments)
    members = ["pairs", "not_ok", "wrong", "doubtful", "unknown", "quiet", "p99_deg", "max_deg"]
    measure.print_table(["rig", "outl.", "solver", "pairs", "not ok", "wrong", "doubtful",
                         "unknown", "quiet", "p99", "max"],
                        [[s["rig"], s["outliers"], s["solver"]] + [s[m] for m in members]
                         for s in settings])
    measure.finish(programs, arguments, settings=settings)


if __name__ == "__main__":
    measure.run_main(main)
