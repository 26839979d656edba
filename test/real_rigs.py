#!/usr/bin/env python3
"""How near to the bound the motions of real rigs are, over rigs, matches, turns and outliers.

  test/real_rigs.py --bin=build/release/bin [--quick] [--rigs=nuscenes,waymo] [--json=FILE]

For each setting rigel_simulate drives the rig 1 m through the street (--scene=street), and
rigel_compare estimates the motions with auto and unknown noise. Printed for each setting, and as
means over the settings:

  rot, dir, rig dir  RMS error over RMS bound of the rotation, of the direction of t and of the
                     direction of the rig's own motion; 1 is perfect
  |t|                RMS of the bound's relative standard deviation of |t|
  NEES, median       the mean NEES over degrees of freedom, and its median over pairs; with right
                     covariances 1 and 0.89
  no t, fail         pairs whose direction is not observable, and pairs without a motion

What the programs do not state is "-"; the last line has the number of settings in each mean. With
--marginals rigel_estimate runs, too, and further columns have the mean NEES over degrees of freedom
of the rotation alone (n rot) and of the rig's direction (n rig).

Rigs are files of --rig_dir, paths of such files, `scene`, `sceneN` (the built-in scene with N
cameras) or `ringN` (N cameras that look around). The last three need no street.
With --poses the motions are those of recorded drives, as one more "yaw", `poses`.
"""
import tempfile

import measure

RIGS = "nuscenes,argoverse2,waymo,ddad_scene_02,pandaset"


def marginals(results, directory):
    """Mean NEES over degrees of freedom of the rotation and of the rig's direction."""
    rotations, directions = [], []
    for path in measure.match_files(directory):
        file = measure.MatchFile(path)
        pair, truth = results.get(file.name, {}), file.truth()
        motion, covariance = measure.refined_motion(pair), measure.rotation_covariance(pair)
        if motion and covariance:
            value = measure.nees(measure.rotation_difference(motion, truth), covariance)
            rotations.append(None if value is None else value / 3)
        stated = measure.rig_direction(pair)
        if stated:
            along = measure.rig_motion(truth, file.cameras())
            # The stated standard deviation is that of both components together.
            directions.append((measure.angle_deg(stated[0], along) / stated[1]) ** 2)
    return measure.mean(rotations), measure.mean(directions)


def measure_setting(programs, rig, matches, yaw, outliers, arguments):
    settings = {"num_matches": matches, "outlier_share": outliers,
                "inter_share": arguments.inter_share}
    if yaw == "poses":
        settings.update(poses=arguments.poses,
                        every=max(1, measure.count_poses(arguments.poses) // arguments.pairs))
    else:
        settings.update(rotation_deg=yaw)
    with tempfile.TemporaryDirectory() as folder:
        programs.simulate(folder, rig, arguments.pairs, **settings)
        flags = measure.apply_prior(folder, arguments.prior)
        figures = measure.compare_figures(programs.compare(folder, flags))
        if arguments.marginals:
            results, _ = programs.estimate(folder, flags)
            figures["nees_rotation"], figures["nees_rig_direction"] = marginals(results, folder)
    return {"rig": measure.rig_name(rig), "matches": matches, "yaw": yaw, "outliers": outliers,
            **figures}


def main():
    parser = measure.make_parser(__doc__, pairs=100)
    parser.add_argument("--rigs", default=RIGS, help="comma separated (%s)" % RIGS)
    measure.add_rig_dir_flag(parser)
    parser.add_argument("--matches", default="300,1000", help="matches of a pair (300,1000)")
    parser.add_argument("--yaw", default="0.3,1,5", help="turns, degrees (0.3,1,5)")
    parser.add_argument("--outliers", default="0.2,0.4", help="shares of outliers (0.2,0.4)")
    parser.add_argument("--inter_share", type=float, default=0,
                        help="share of matches between different cameras (0)")
    parser.add_argument("--poses", help="directory of KITTI poses")
    parser.add_argument("--marginals", action="store_true", help="run rigel_estimate, too")
    parser.add_argument("--quick", action="store_true",
                        help="20 pairs, 300 matches, 20 percent outliers only")
    measure.add_prior_flag(parser)
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.pairs, arguments.matches, arguments.outliers = 20, "300", "0.2"

    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    yaws = measure.numbers(arguments.yaw) + (["poses"] if arguments.poses else [])
    settings = [measure_setting(programs, rig, int(matches), yaw, outliers, arguments)
                for rig in measure.rig_files(arguments.rigs, arguments.rig_dir)
                for matches in measure.numbers(arguments.matches)
                for yaw in yaws
                for outliers in measure.numbers(arguments.outliers)]

    head = ["rig", "rows", "yaw", "outl.", "rot", "dir", "rig dir", "|t|", "NEES", "median", "no t",
            "fail"]
    members = ["rotation", "direction", "rig_direction", "bound_scale", "nees_mean", "nees_median",
               "unobservable", "failures"]
    if arguments.marginals:
        head += ["n rot", "n rig"]
        members += ["nees_rotation", "nees_rig_direction"]
    means = {member: measure.mean([s[member] for s in settings]) for member in members}
    largest = {member: max((s[member] for s in settings if s[member] is not None), default=None)
               for member in members}
    rows = [[s[name] for name in ("rig", "matches", "yaw", "outliers")] + [s[m] for m in members]
            for s in settings]
    counted = {member: sum(s[member] is not None for s in settings) for member in members}
    rows += [[name, "", "", ""] + [figures[m] for m in members]
             for name, figures in (("mean", means), ("largest", largest), ("settings", counted))]
    measure.print_table(head, rows)
    measure.finish(programs, arguments, settings=settings, mean=means, largest=largest,
                   counted=counted)


if __name__ == "__main__":
    measure.run_main(main)
