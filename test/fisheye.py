#!/usr/bin/env python3
"""How near to the bound of raw pixels the motions of fisheye rigs are, and how long they take.

  test/fisheye.py --bin=build/release/bin [--pairs=200] [--json=FILE]

Four cameras look ahead, to both sides and back. Each kind of lens makes a rig of its own:

  pinhole   half field of view 60 degrees, the rig that the times are compared with
  narrow    opencv_fisheye, 60 degrees to the left and right border of the image
  wide      opencv_fisheye, 95 degrees there, and more in the corners
  mixed     wide ones ahead and back, pinholes to the sides

rigel_simulate drives each through the street, with noise on raw pixels; rigel_compare estimates the
motions with auto and unknown noise. Printed for each rig:

  rot, dir, rig dir  RMS error over RMS bound of the rotation, of the direction of t and of the
                     direction of the rig's own motion; 1 is perfect
  own                RMS bound of the rotation over that of measure.py, which has its own lenses
  NEES, median       the mean NEES over degrees of freedom, and its median over pairs; with right
                     covariances 1 and 0.89
  no t, fail         pairs whose direction is not observable, and pairs without a motion
  >90                percent of the right matches with a ray beyond 90 degrees of an optical axis
  ms, times          median time of a pair, and that over the time of `pinhole`
"""
import json
import math
import os
import tempfile

import measure

PINHOLE = ("pinhole", [369.5, 369.5, 640, 483])
LENSES = {
    # With these k 60 and 95 degrees are 1.0041 and 1.5310 focal lengths from the centre.
    "narrow": ("opencv_fisheye", [640 / 1.0041, 640 / 1.0041, 640, 483, -0.04, 0.003, -0.0007, 0]),
    "wide": ("opencv_fisheye", [640 / 1.5310, 640 / 1.5310, 640, 483, -0.03, -0.0006, 0.0005, 0]),
}
RIGS = {"pinhole": [PINHOLE] * 4, "narrow": [LENSES["narrow"]] * 4, "wide": [LENSES["wide"]] * 4,
        "mixed": [LENSES["wide"], PINHOLE] * 2}
# Ahead, to the right, back, to the left, of a body with z forward and y down: quaternions and
# positions in metres.
PLACES = [([math.cos(angle / 2), 0, math.sin(angle / 2), 0], place) for angle, place in (
    (0, [0, 0, 1.9]), (math.pi / 2, [0.9, 0, 0.8]), (math.pi, [0, 0, -1.9]),
    (-math.pi / 2, [-0.9, 0, 0.8]))]


def write_rig(directory, name):
    cameras = [{"model": model, "parameters": parameters, "width": 1280, "height": 966, "q": q,
                "s": s} for (model, parameters), (q, s) in zip(RIGS[name], PLACES)]
    path = os.path.join(directory, name + ".json")
    with open(path, "w", encoding="ascii") as file:
        json.dump({"format": "rigel-rig 1", "name": name, "ground_m": 0.9, "down": [0, 1, 0],
                   "forward": [0, 0, 1], "cameras": cameras}, file)
    return path


def right_matches(file):
    """The exact pixels of the matches that are right, as (i, u, v, j, u2, v2)."""
    names = ("i", "u0", "v0", "j", "u20", "v20", "inlier")
    i, u, v, j, u2, v2, inlier = (file.column(name) for name in names)
    return [(int(row[i]), float(row[u]), float(row[v]), int(row[j]), float(row[u2]), float(row[v2]))
            for row in file.rows if int(row[inlier])]


def is_wide(camera, pixel):
    """Whether the ray is more than 90 degrees from the optical axis."""
    return measure.dot(camera.ray(*pixel), measure.transposed(camera.rotation)[2]) < 0


def share_beyond_90(files):
    wide = [is_wide(cameras[i], (u, v)) or is_wide(cameras[j], (u2, v2))
            for cameras, matches in ((file.cameras(), right_matches(file)) for file in files)
            for i, u, v, j, u2, v2 in matches]
    return 100 * sum(wide) / len(wide)


def own_rotation_bound_deg(files, noise_px):
    """RMS over the files."""
    squares = []
    for file in files:
        cameras = file.cameras()
        covariance = measure.bound(right_matches(file), cameras, file.truth(),
                                   [noise_px] * len(cameras))
        squares.append(sum(covariance[k][k] for k in range(3)))
    return math.degrees(math.sqrt(sum(squares) / len(squares)))


def measure_rig(programs, name, arguments):
    with tempfile.TemporaryDirectory() as folder:
        programs.simulate(folder, write_rig(folder, name), arguments.pairs,
                          num_matches=arguments.num_matches, outlier_share=0.15,
                          inter_share=arguments.inter_share, noise_px=arguments.noise_px,
                          rotation_deg=arguments.yaw)
        flags = measure.apply_prior(folder, arguments.prior)
        report = programs.compare(folder, flags, times=True)
        files = [measure.MatchFile(path) for path in measure.match_files(folder)]
        figures = measure.compare_figures(report)
        figures["beyond_90_percent"] = share_beyond_90(files)
        figures["bound_over_own"] = (figures["rotation_bound_deg"] /
                                     own_rotation_bound_deg(files, arguments.noise_px))
        times = report["results"][0]["time_ms"]
        figures["time_ms"] = times["ransac"]["median"] + times["refine"]["median"]
    return {"rig": name, **figures}


def main():
    parser = measure.make_parser(__doc__, pairs=200)
    parser.add_argument("--rigs", default=",".join(RIGS), help="comma separated (all)")
    parser.add_argument("--num_matches", type=int, default=400, help="matches of a pair (400)")
    parser.add_argument("--noise_px", type=float, default=0.5, help="noise of raw pixels (0.5)")
    parser.add_argument("--yaw", type=float, default=1, help="turn, degrees (1)")
    parser.add_argument("--inter_share", type=float, default=0.2,
                        help="share of matches between different cameras (0.2)")
    measure.add_prior_flag(parser)
    arguments = parser.parse_args()
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    rigs = [measure_rig(programs, name, arguments) for name in arguments.rigs.split(",")]
    pinhole = next((rig["time_ms"] for rig in rigs if rig["rig"] == "pinhole"), None)
    for rig in rigs:
        rig["times_pinhole"] = rig["time_ms"] / pinhole if pinhole else None
    members = ["rotation", "direction", "rig_direction", "bound_over_own", "nees_mean",
               "nees_median", "unobservable", "failures", "beyond_90_percent", "time_ms",
               "times_pinhole"]
    measure.print_table(["rig", "rot", "dir", "rig dir", "own", "NEES", "median", "no t", "fail",
                         ">90", "ms", "times"],
                        [[rig["rig"]] + [rig[member] for member in members] for rig in rigs])
    measure.finish(programs, arguments, rigs=rigs)


if __name__ == "__main__":
    measure.run_main(main)
