#!/usr/bin/env python3
"""A rig that stands still or turns on the spot: is its rotation good, and is no direction claimed?

  test/still.py --rig_dir=DIR [--pairs=100] [--rigs=stereo,nuscenes] [--recorded=DIR[,DIR]]

Simulated: `box` (the scene of rigel_simulate) and rigs in the street, `stereo` as KITTI's, with
--motion=still and --motion=turn; 0.5 pixels of noise and --outliers. rigel_estimate runs with
unknown noise and no prior. Printed for each:

  rot deg   RMS rotation error, degrees
  over      that over the RMS bound of the rotation. Of a standing rig the bound is that of a model
            of rotation alone, in which both pixel components say it; of a turn that of six
            parameters, since cameras off the body's origin move
  NEES      mean NEES of the rotation over its three degrees of freedom; 1 is right
  median    its median over that of chi2; 1 is right
  dir, |t|  pairs that claim an observable direction of t and an observable length
  t err/sd  RMS of |t| over its stated standard deviation (root of the trace); `-` without one
  fail      pairs without a refined motion

Recorded directories of a standing rig have no truth that is good enough. Their even and odd matches
are compared: `rot deg` is the RMS difference of the rotations, `over` the RMS of that over its
stated standard deviation, and NEES and median are those of the difference. The claims are those of
all matches.
"""
import math
import os
import tempfile

import measure
import splits

NOISE_PX = 0.5


def claims(results, names):
    """How many of the files have a claim, or no motion."""
    pairs = [results.get(name, {}) for name in names]
    return {"direction": sum(bool(pair.get("translation_observable")) for pair in pairs),
            "length": sum(bool(pair.get("scale_observable")) for pair in pairs),
            "fail": sum(measure.refined_motion(pair) is None for pair in pairs)}


def bound_of(file, motion):
    """The variance of the bound of the rotation, or None."""
    cameras, truth = file.cameras(), file.truth()
    if motion == "still":
        intra = [match for match in exact_inliers(file) if match[0] == match[3]]
        covariance = measure.rotation_bound(intra, cameras, truth[0], NOISE_PX)
    else:
        covariance = measure.bound(exact_inliers(file), cameras, truth, [NOISE_PX] * len(cameras),
                                   length_sd=1e6)
    return None if covariance is None else sum(covariance[k][k] for k in range(3))


def exact_inliers(file):
    """Right matches of a simulated file at their exact pixels."""
    columns = [file.column(name) for name in ("i", "u0", "v0", "j", "u20", "v20", "inlier")]
    rows = [[row[k] for k in columns] for row in file.rows]
    return [(int(i), float(u), float(v), int(j), float(u2), float(v2))
            for i, u, v, j, u2, v2, inlier in rows if inlier == "1"]


def judge(results, files, motion):
    """The figures of simulated pairs."""
    errors, variances, values, ratios = [], [], [], []
    for file in files:
        pair, truth = results.get(file.name, {}), file.truth()
        estimate, covariance = measure.refined_motion(pair), measure.rotation_covariance(pair)
        if estimate is None:
            continue
        errors.append(measure.rotation_error_deg(estimate, truth))
        variances.append(bound_of(file, motion))
        if covariance:
            values.append(measure.nees(measure.rotation_difference(estimate, truth), covariance))
        if "covariance" in pair:
            part = measure.block(pair["covariance"], 3)
            sd = math.sqrt(sum(part[k][k] for k in range(3)))
            if sd > 0:
                ratios.append(measure.norm(estimate[1]) / sd)
    variance = measure.mean(variances)
    error = measure.rms(errors)
    values = [value for value in values if value is not None]
    return {"error_deg": error,
            "over": error / math.degrees(math.sqrt(variance)) if error and variance else None,
            "nees": measure.mean([value / 3 for value in values]),
            "median": measure.median([value / measure.CHI2_MEDIAN[3] for value in values]),
            "t_over_sd": measure.rms(ratios), **claims(results, [file.name for file in files])}


def measure_simulated(programs, name, rig, motion, arguments):
    with tempfile.TemporaryDirectory() as folder:
        settings = {"rotation_deg": arguments.yaw} if motion == "turn" else {}
        programs.simulate(folder, rig, arguments.pairs, motion=motion, noise_px=NOISE_PX,
                          num_matches=arguments.matches, outlier_share=arguments.outliers,
                          inter_share=arguments.inter_share, **settings)
        flags = measure.apply_prior(folder, "none")
        results, _ = programs.estimate(folder, flags)
        files = [measure.MatchFile(path) for path in measure.match_files(folder)]
    return {"rig": name, "motion": motion, "pairs": len(files), **judge(results, files, motion)}


def measure_recorded(programs, directory):
    files = [measure.MatchFile(path) for path in measure.match_files(directory)]
    results, _ = programs.estimate(directory)
    with tempfile.TemporaryDirectory() as folder:
        for file in files:
            for name, rows in zip("ab", splits.halves_of(file, None)):
                file.write(os.path.join(folder, name), rows)
        halves = [programs.estimate(os.path.join(folder, name))[0] for name in "ab"]
    differences, ratios, values = [], [], []
    for file in files:
        pair = [half.get(file.name, {}) for half in halves]
        motions = [measure.refined_motion(result) for result in pair]
        if None in motions:
            continue
        differences.append(measure.norm(measure.rotation_difference(*motions)))
        value = measure.difference_nees(*pair)
        if value is not None:
            values.append(value)
            variance = sum(measure.rotation_covariance(p)[k][k] for p in pair for k in range(3))
            ratios.append(differences[-1] / math.sqrt(variance))
    names = [file.name for file in files]
    return {"rig": os.path.basename(os.path.normpath(directory)), "motion": "recorded",
            "pairs": len(files), "over": measure.rms(ratios),
            "error_deg": math.degrees(measure.rms(differences)) if differences else None,
            "nees": measure.mean([value / 3 for value in values]),
            "median": measure.median([value / measure.CHI2_MEDIAN[3] for value in values]),
            "t_over_sd": None, **claims(results, names)}


def main():
    parser = measure.make_parser(__doc__, pairs=100)
    measure.add_rig_dir_flag(parser)
    parser.add_argument("--rigs", default="box,stereo,nuscenes",
                        help="comma separated (box,stereo,nuscenes)")
    parser.add_argument("--motions", default="still,turn", help="comma separated (still,turn)")
    parser.add_argument("--matches", type=int, default=200, help="matches of a pair (200)")
    parser.add_argument("--outliers", type=float, default=0.2, help="share of outliers (0.2)")
    parser.add_argument("--inter_share", type=float, default=0,
                        help="share of matches between different cameras (0)")
    parser.add_argument("--yaw", type=float, default=5, help="of a turn, degrees (5)")
    parser.add_argument("--recorded", help="directories of a standing rig, comma separated")
    arguments = parser.parse_args()
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        built_in = {"box": "scene", "stereo": measure.write_stereo_rig(folder)}
        for name in arguments.rigs.split(","):
            rig = built_in.get(name) or measure.rig_files(name, arguments.rig_dir)[0]
            figures += [measure_simulated(programs, name, rig, motion, arguments)
                        for motion in arguments.motions.split(",")]
    figures += [measure_recorded(programs, directory)
                for directory in (arguments.recorded.split(",") if arguments.recorded else [])]
    members = ["rig", "motion", "pairs", "error_deg", "over", "nees", "median", "direction",
               "length", "t_over_sd", "fail"]
    measure.print_table(["rig", "motion", "pairs", "rot deg", "over", "NEES", "median", "dir",
                         "|t|", "t err/sd", "fail"], [[f[m] for m in members] for f in figures])
    measure.finish(programs, arguments, figures=figures)


if __name__ == "__main__":
    measure.run_main(main)
