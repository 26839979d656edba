#!/usr/bin/env python3
"""Do the matches tell that a rig is off, and only then?

  test/rig_test.py --rig_dir=DIR [--data=kitti_stereo_06,...] [--pairs=1000] [--runs=100]

rigel_estimate tests the calibration of the rig: each pair, and the run. Rigs drive through the
street (rigel_simulate), with matches between cameras. Then the files state another rig: one camera
is turned about one of its axes.

  pairs   a stereo rig as KITTI's, camera 1 off by --stereo_deg in pitch: the share of single pairs
          with p below 0.01, of the right rig and of the wrong one; the median turn that they state
  runs    --runs runs of --run_pairs pairs with the nuScenes rig, and --runs_off with camera
          --camera off by --surround_deg in pitch, yaw or roll: runs with p below 0.001, runs that
          are told as off, and those that name this camera
  data    recorded matches: what a run over each directory says
"""
import math
import os
import tempfile

import measure

AXES = ("pitch", "yaw", "roll")


def turned_camera(words, axis, turn_deg):
    """A `camera` line with Q turned in the camera's frame: Q Exp(turn)."""
    w, x, y, z = (float(word) for word in words[-7:-3])
    half = math.radians(turn_deg) / 2
    c, s = math.cos(half), [math.sin(half) if k == axis else 0.0 for k in range(3)]
    turned = (w * c - x * s[0] - y * s[1] - z * s[2], x * c + w * s[0] + y * s[2] - z * s[1],
              y * c + w * s[1] + z * s[0] - x * s[2], z * c + w * s[2] + x * s[1] - y * s[0])
    return words[:-7] + ["%.15g" % value for value in turned] + words[-3:]


def turn_camera(source, target, camera, axis, turn_deg):
    """Writes the files of a directory with one camera of the rig turned."""
    for file in map(measure.MatchFile, measure.match_files(source)):
        file.header = [turned_camera(words, axis, turn_deg)
                       if words[:2] == ["camera", str(camera)] else words for words in file.header]
        file.write(target)


def share_below(tests, limit):
    return sum(test["p"] < limit for test in tests) / len(tests) if tests else None


def measure_pairs(programs, arguments):
    """Single pairs of a stereo rig: as it is, and with one camera off."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        rig = measure.write_stereo_rig(folder)
        right, off = os.path.join(folder, "right"), os.path.join(folder, "off")
        programs.simulate(right, rig, arguments.pairs, num_matches=arguments.matches,
                          inter_share=arguments.inter_share, outlier_share=arguments.outliers)
        turn_camera(right, off, 1, 0, arguments.stereo_deg)
        for files, turn in ((right, 0.0), (off, arguments.stereo_deg)):
            results, _ = programs.estimate(files, ["--prior=body"])
            tests = [pair["rig_test"] for pair in results.values() if "rig_test" in pair]
            stated = [test["cameras"][0] for test in tests if "cameras" in test]
            rows.append({"turn_deg": turn, "pairs": len(results), "tested": len(tests),
                         "below_0.01": share_below(tests, 0.01),
                         "below_0.1": share_below(tests, 0.1),
                         "below_0.5": share_below(tests, 0.5),
                         "pitch_deg": measure.median([c["turn_deg"]["pitch"] for c in stated
                                                      if "pitch" in c["turn_deg"]]),
                         "pitch_sd_deg": measure.median([c["turn_sd_deg"]["pitch"] for c in stated
                                                         if "pitch" in c["turn_sd_deg"]])})
    return rows


def is_told(test):
    return test["p_with_calibration"] < 1e-3


def names_camera(test, camera):
    return is_told(test) and any(c["camera"] == camera and c["p_with_calibration"] < 1e-3
                                 for c in test.get("cameras", []))


def measure_runs(programs, arguments):
    """Runs of a surround rig: as it is, and with a side camera off about each of its axes."""
    rig = measure.rig_files(arguments.rig, arguments.rig_dir)[0]
    tests = {"right": []}
    with tempfile.TemporaryDirectory() as folder:
        for run in range(arguments.runs):
            right = os.path.join(folder, "right%d" % run)
            programs.simulate(right, rig, arguments.run_pairs, seed=arguments.seed + run,
                              num_matches=arguments.matches, inter_share=arguments.inter_share,
                              outlier_share=arguments.outliers)
            tests["right"].append(programs.estimate(right, ["--prior=body"])[1].get("rig_test"))
            for axis in range(3) if run < arguments.runs_off else ():
                off = os.path.join(folder, "off%d%s" % (run, AXES[axis]))
                turn_camera(right, off, arguments.camera, axis, arguments.surround_deg)
                tests.setdefault(AXES[axis], []).append(
                    programs.estimate(off, ["--prior=body"])[1].get("rig_test"))
    rows = []
    for name, of_name in tests.items():
        tested = [test for test in of_name if test]
        rows.append({"off": name, "runs": len(of_name), "tested": len(tested),
                     "below_0.001": sum(test["p"] < 1e-3 for test in tested),
                     "below_0.1": share_below(tested, 0.1), "below_0.5": share_below(tested, 0.5),
                     "told": sum(map(is_told, tested)),
                     "named": sum(names_camera(test, arguments.camera) for test in tested)})
    return rows


def measure_data(programs, path):
    """A row for each camera of a run over recorded matches."""
    _, report = programs.estimate(path, ["--prior=body"])
    test = report.get("rig_test", {})
    rows = []
    for camera in test.get("cameras", []):
        rows.append({"data": os.path.basename(path), "pairs": test["pairs"],
                     "camera": camera["camera"], "p": test["p"],
                     "p_with_calibration": test["p_with_calibration"],
                     **{axis: camera["turn_deg"].get(axis) for axis in AXES},
                     **{axis + "_sd": camera["turn_sd_deg"].get(axis) for axis in AXES}})
    return rows


def print_rows(rows):
    if rows:
        measure.print_table(list(rows[0]), [list(row.values()) for row in rows])
        print()


def main():
    parser = measure.make_parser(__doc__, pairs=1000)
    measure.add_rig_dir_flag(parser)
    parser.add_argument("--data", default="", help="directories of match files, comma separated")
    parser.add_argument("--runs", type=int, default=100, help="runs with the right rig (100)")
    parser.add_argument("--runs_off", type=int, default=5,
                        help="of these also with the camera off, for each axis (5)")
    parser.add_argument("--run_pairs", type=int, default=50, help="pairs of a run (50)")
    parser.add_argument("--rig", default="nuscenes", help="rig of the runs (nuscenes)")
    parser.add_argument("--camera", type=int, default=1, help="the camera that is off (1)")
    parser.add_argument("--stereo_deg", type=float, default=0.05, help="degrees (0.05)")
    parser.add_argument("--surround_deg", type=float, default=0.2, help="degrees (0.2)")
    parser.add_argument("--matches", type=int, default=300, help="matches of a pair (300)")
    parser.add_argument("--outliers", type=float, default=0.2, help="share of outliers (0.2)")
    parser.add_argument("--inter_share", type=float, default=0.3,
                        help="share of matches between different cameras (0.3)")
    arguments = parser.parse_args()
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    pairs = measure_pairs(programs, arguments) if arguments.pairs else []
    print_rows(pairs)
    runs = measure_runs(programs, arguments) if arguments.runs else []
    print_rows(runs)
    data = []
    for path in filter(None, arguments.data.split(",")):
        data += measure_data(programs, path.rstrip("/"))
    print_rows(data)
    measure.finish(programs, arguments, pairs=pairs, runs=runs, data=data)


if __name__ == "__main__":
    measure.run_main(main)
