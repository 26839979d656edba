#!/usr/bin/env python3
"""Is a length |t| that is claimed to be observable as near to the truth as its stated sigma says?

  test/observable_length.py --data=DIR [--seeds=5] [--sets=sim,sim_c,dgp]

DIR is a folder of recorded and simulated match files with truth. rigel_estimate runs on each set of
pairs with several seeds, with auto, unknown noise and the priors of the files:

  sim    surround_sim/*: simulated streets on the rigs of cars, an exact calibration
  sim_c  surround_sim/*_c0.1: with a calibration that is off by 0.1 degrees and 2 cm
  dgp    surround_dgp: a recorded drive; its calibration is taken to be good to 0.2 degrees and 2 cm

The error of the calibration is stated to programs that take it. Printed for each folder and set:

  runs       pairs times seeds
  claimed    percent of the runs whose |t| is claimed to be observable
  if < 3 %   the same of the runs whose bound of |t| is below 3 percent, where the calibration is
             exact and the files state their noise
  in 3, in 5 percent of the claimed ones with | |t| / |t_gt| - 1 | within so many stated sigmas
  least      the least number of claimed lengths within 5 sigma of any pair, of so many seeds
  all in 3   as `in 3`, of all runs and their length_sd, which is stated for other lengths, too
  least 3    the least number of these of any pair, of so many seeds
  |t| err    the median error of the claimed lengths, percent
  rot, dir   median errors of all runs, degrees
"""
import glob
import math
import os

import measure

# Degrees and metres: what is stated of each set's calibration; None for an exact one.
SETS = {"sim": ("surround_sim/*", None), "sim_c": ("surround_sim/*_c0.1", (0.1, 0.02)),
        "dgp": ("surround_dgp", (0.2, 0.02))}
GOOD_BOUND = 0.03
INLIER_SIGMAS = 3.75


def folders_of(name, data):
    """The directories of a set."""
    paths = sorted(glob.glob(os.path.join(glob.escape(data), SETS[name][0])))
    if name == "sim":
        paths = [path for path in paths if not path.endswith("_c0.1")]
    if not paths:
        raise measure.Failure("%s: no %s" % (data, SETS[name][0]))
    return paths


def bound_of(file):
    """The bound of |t| as a fraction, of the matches that agree with the truth; None for a file
    that does not state its noise."""
    stated = file.line("noise_px")
    if stated is None:
        return None
    cameras, truth = file.cameras(), file.truth()
    sigmas = [float(stated[0])] * len(cameras)
    inliers = []
    for match in file.matches():
        value, _, sd = measure.constraint(match, cameras, truth, sigmas)
        if abs(value) <= INLIER_SIGMAS * sd:
            inliers.append(match)
    covariance = measure.bound(inliers, cameras, truth, sigmas, length_sd=1e6)
    if covariance is None:
        return None
    length = measure.norm(truth[1])
    along = measure.scaled(truth[1], 1 / length)
    variance = measure.dot(along, measure.apply(measure.block(covariance, 3), along))
    return math.sqrt(variance) / length


def measure_folder(programs, folder, flags, has_bounds, seeds):
    """The runs of a folder: a dictionary each."""
    files = [measure.MatchFile(path) for path in measure.match_files(folder)]
    truths = {file.name: file.truth() for file in files}
    # With an error of the calibration the truth does not fit.
    bounds = {file.name: bound_of(file) for file in files} if has_bounds else {}
    runs = []
    for seed in range(1, seeds + 1):
        programs.seed = seed
        results, _ = programs.estimate(folder, flags)
        for name, truth in truths.items():
            pair = results.get(name, {})
            motion, sd = measure.refined_motion(pair), pair.get("relative_scale_sd")
            run = {"pair": name, "seed": seed, "bound": bounds.get(name), "claimed": False}
            if motion:
                error = measure.norm(motion[1]) / measure.norm(truth[1]) - 1
                run.update(rotation_deg=measure.rotation_error_deg(motion, truth),
                           direction_deg=measure.angle_deg(motion[1], truth[1]), error=error)
                if pair.get("length_sd"):
                    run["length_sigmas"] = abs(error) / pair["length_sd"]
                if pair.get("scale_observable") and sd:
                    run.update(claimed=True, sigmas=abs(error) / sd)
            runs.append(run)
    return runs


def percent(part, whole):
    return 100 * len(part) / len(whole) if whole else None


def summary(runs):
    """The figures of runs."""
    claimed = [run for run in runs if run["claimed"]]
    good = [run for run in runs if run["bound"] is not None and run["bound"] < GOOD_BOUND]
    within = {}
    for run in claimed:
        within[run["pair"]] = within.get(run["pair"], 0) + (run["sigmas"] <= 5)
    stated = [run for run in runs if "length_sigmas" in run]
    within_3 = {run["pair"]: 0 for run in runs}
    for run in stated:
        within_3[run["pair"]] += run["length_sigmas"] <= 3
    return {"all_in_3": percent([run for run in stated if run["length_sigmas"] <= 3], runs),
            "least_3": min(within_3.values()), "runs": len(runs), "claimed": percent(claimed, runs),
            "claimed_if_good": percent([run for run in good if run["claimed"]], good),
            "in_3": percent([run for run in claimed if run["sigmas"] <= 3], claimed),
            "in_5": percent([run for run in claimed if run["sigmas"] <= 5], claimed),
            "least": min(within.values(), default=None),
            "error_percent": measure.median([100 * abs(run["error"]) for run in claimed]),
            "rotation_deg": measure.median([r["rotation_deg"] for r in runs if "error" in r]),
            "direction_deg": measure.median([r["direction_deg"] for r in runs if "error" in r])}


def main():
    parser = measure.make_parser(__doc__)
    data = os.environ.get("RIGEL_REAL_DATA")
    parser.add_argument("--data", default=data, help="the folder; by default $RIGEL_REAL_DATA")
    parser.add_argument("--sets", default=",".join(SETS), help="comma separated (sim,sim_c,dgp)")
    parser.add_argument("--seeds", type=int, default=5, help="runs of each pair (5)")
    arguments = parser.parse_args()
    if not arguments.data:
        parser.error("--data: name the folder")
    names = arguments.sets.split(",")
    if any(name not in SETS for name in names):
        parser.error("--sets: expected %s" % ", ".join(SETS))
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    figures = []
    for name in names:
        sigmas = SETS[name][1]
        flags = programs.calibration_error("rigel_estimate", *sigmas) if sigmas else []
        everything = []
        folders = folders_of(name, arguments.data)
        for folder in folders:
            runs = measure_folder(programs, folder, flags, not sigmas, arguments.seeds)
            # The pairs of all folders have the same names.
            everything += [{**run, "pair": os.path.join(folder, run["pair"])} for run in runs]
            figures.append({"set": name, "folder": os.path.basename(folder), **summary(runs)})
        if len(folders) > 1:
            figures.append({"set": name, "folder": "all of " + name, **summary(everything)})
    members = ["runs", "claimed", "claimed_if_good", "in_3", "in_5", "least", "all_in_3",
               "least_3", "error_percent", "rotation_deg", "direction_deg"]
    measure.print_table(["folder", "runs", "claimed", "if < 3 %", "in 3", "in 5", "least",
                         "all in 3", "least 3", "|t| err", "rot", "dir"],
                        [[f["folder"]] + [f[m] for m in members] for f in figures])
    measure.finish(programs, arguments, sets=figures)


if __name__ == "__main__":
    measure.run_main(main)
