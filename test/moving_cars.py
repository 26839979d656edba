#!/usr/bin/env python3
"""What cars that move by themselves cost: errors over their bounds, by their share of the matches.

  test/moving_cars.py --rig_dir=DIR [--pairs=200] [--shares=0,0.1,0.2,0.3] [--rigs=stereo,nuscenes]

Rigs drive through the street (rigel_simulate --scene=street --moving_share) among three cars, two
ahead and one behind, that move 0.5 to 2 m; --outliers of the matches are wrong besides.
rigel_compare estimates the motions with auto and unknown noise. The bound is of the matches of what
stands. Printed for each rig and share:

  rot, dir       RMS error over RMS bound of the rotation and of the direction of t; 1 is perfect
  NEES, median   the mean NEES over degrees of freedom, and its median; 1 and 0.89 are right
  over 3         pairs with a rotation error of more than three times their bound
  deg            RMS error of the rotation, degrees
  no t, fail     pairs whose direction is not observable, and pairs without a motion
"""
import tempfile

import measure


def measure_share(programs, rig, share, arguments):
    with tempfile.TemporaryDirectory() as folder:
        programs.simulate(folder, rig, arguments.pairs, num_matches=arguments.matches,
                          rotation_deg=arguments.yaw, outlier_share=arguments.outliers,
                          inter_share=arguments.inter_share, moving_share=share)
        flags = measure.apply_prior(folder, arguments.prior)
        report = programs.compare(folder, flags)
    figures = measure.compare_figures(report)
    solved = [pair["solvers"]["auto"] for pair in report["pair_results"]]
    over = sum(1 for pair in solved if "refined" in pair and "bound" in pair and
               pair["refined"]["rotation_deg"] > 3 * pair["bound"]["rotation_deg"])
    return {"rig": measure.rig_name(rig), "share": share, "over_3": over, **figures}


def main():
    parser = measure.make_parser(__doc__, pairs=100)
    measure.add_rig_dir_flag(parser)
    parser.add_argument("--rigs", default="stereo,nuscenes",
                        help="`stereo` is a rig as KITTI's (stereo,nuscenes)")
    parser.add_argument("--shares", default="0,0.1,0.2,0.3", help="of the cars (0,0.1,0.2,0.3)")
    parser.add_argument("--matches", type=int, default=300, help="matches of a pair (300)")
    parser.add_argument("--outliers", type=float, default=0, help="share of other outliers (0)")
    parser.add_argument("--inter_share", type=float, default=0,
                        help="share of matches between different cameras (0)")
    parser.add_argument("--yaw", type=float, default=1, help="turn, degrees (1)")
    measure.add_prior_flag(parser)
    arguments = parser.parse_args()
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    with tempfile.TemporaryDirectory() as folder:
        stereo = measure.write_stereo_rig(folder)
        rigs = [stereo if name == "stereo" else measure.rig_files(name, arguments.rig_dir)[0]
                for name in arguments.rigs.split(",")]
        settings = [measure_share(programs, rig, share, arguments)
                    for rig in rigs for share in measure.numbers(arguments.shares)]
    members = ["rig", "share", "pairs", "rotation", "direction", "nees_mean", "nees_median",
               "over_3", "rotation_rms_deg", "unobservable", "failures"]
    measure.print_table(["rig", "cars", "pairs", "rot", "dir", "NEES", "median", "over 3", "deg",
                         "no t", "fail"], [[s[m] for m in members] for s in settings])
    measure.finish(programs, arguments, settings=settings)


if __name__ == "__main__":
    measure.run_main(main)
