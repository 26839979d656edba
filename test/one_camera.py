#!/usr/bin/env python3
"""One front camera 1.7 m ahead of the axle, in turns: is what is said of t true?

  test/one_camera.py --bin=build/release/bin [--pairs=50] [--turns=1,5,10] [--drive=DIR,...]

Writes match files of a street-like scene (ground, facades, far points, clutter): the body's origin
is at the axle, turns are Ackermann's, |t| is log-uniform from 0.3 to 3 m, 300 matches, 0.5 pixels
of noise, 20 percent outliers, no prior. rigel_estimate runs with unknown noise. The matches do not
say |t| then, and in a turn the direction of t at the axle depends on it. Printed for each turn:

  flagged        pairs whose direction of t is stated as observable
  err/sd flag    RMS of the error of the direction of t over its stated sigma, over these pairs
  err/sd all     the same over all pairs with a covariance
  rig err/sd     the same of the direction of the rig's own motion, `-` if that is not stated
  sd > 10        flagged pairs with a stated sigma above 10 degrees, which should be none
  max |t|        the largest of any output, in metres
  at cap         pairs with a |t| of 100 m or more whose direction or scale is stated as observable
  fail           pairs without a refined motion or without a covariance

Then a quarter circle of 18 turns of 5 degrees with a stated `distance`: the error of its end, in
percent of the path. --drive adds directories of such drives, with truth.
"""
import math
import os
import random
import tempfile

import measure

CAMERA = "camera 0 pinhole 1260 1260 800 450 1600 900 -0.5 0.5 -0.5 0.5 1.7 0 1.5".split()
NOISE_PX = 0.5
GROUND_M = -0.35  # below the axle
CAP_M = 100
MAX_SD_DEG = 10


def random_point(generator):
    """A point of the street in the body frame, x forward and z up."""
    kind, far = generator.random(), math.exp(generator.uniform(math.log(4), math.log(60)))
    side = measure.random_sign(generator)
    if kind < 0.25:  # clutter, nearer than the facades
        return [generator.uniform(4, 25), side * generator.uniform(1.5, 7),
                generator.uniform(GROUND_M, 2.5)]
    if kind < 0.5:
        return [far, generator.uniform(-7, 7), GROUND_M]
    if kind < 0.8:
        return [far, side * generator.uniform(7, 13), generator.uniform(GROUND_M, 12)]
    distance = math.exp(generator.uniform(math.log(30), math.log(200)))
    bearing = generator.uniform(-0.55, 0.55)
    return [distance * math.cos(bearing), distance * math.sin(bearing),
            generator.uniform(GROUND_M, 0.2 * distance)]


def turn(turn_deg, length):
    """The motion of an axle's centre on a circle: a turn to the left, and the chord."""
    angle = math.radians(turn_deg)
    cosine, sine = math.cos(angle), math.sin(angle)
    rotation = [[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]]
    chord = [length * math.cos(angle / 2), length * math.sin(angle / 2), 0.0]
    return rotation, measure.scaled(measure.apply(rotation, chord), -1)


def quaternion_about_z(turn_deg):
    half = -math.radians(turn_deg) / 2
    return [math.cos(half), 0.0, 0.0, math.sin(half)]


def words_of(values):
    return [repr(value) for value in values]


class Scene:
    """What a match file of one pair is made of."""

    def __init__(self, generator, turn_deg, length, matches=300, outliers=0.2):
        self.generator, self.camera = generator, measure.Camera(CAMERA)
        self.motion, self.turn_deg = turn(turn_deg, length), turn_deg
        wrong = round(outliers * matches)
        self.rows = [self.row(k < wrong) for k in range(matches)]

    def row(self, is_outlier):
        while True:
            point = random_point(self.generator)
            moved = measure.add(measure.apply(self.motion[0], point), self.motion[1])
            first, second = self.camera.project(point), self.camera.project(moved)
            if is_outlier:
                second = (self.generator.uniform(0, self.camera.width),
                          self.generator.uniform(0, self.camera.height))
            if self.camera.sees(first) and self.camera.sees(second):
                noisy = [x + self.generator.gauss(0, NOISE_PX) for x in first + second]
                return ["0"] + words_of(noisy[:2]) + ["0"] + words_of(noisy[2:]) + ["0"]

    def write(self, path, further_lines=()):
        header = [["format", "rigmatch", "1"], CAMERA,
                  ["truth"] + words_of(quaternion_about_z(self.turn_deg) + self.motion[1]),
                  *further_lines, ["matches", str(len(self.rows))]]
        with open(path, "w", encoding="ascii") as file:
            file.write("\n".join(" ".join(words) for words in header + self.rows) + "\n")


def judge(results, directory):
    """The figures of a directory of pairs."""
    flagged, everywhere, rig, largest = [], [], [], 0.0
    figures = {"pairs": 0, "flagged": 0, "too_wide": 0, "at_cap": 0, "fail": 0}
    for path in measure.match_files(directory):
        file = measure.MatchFile(path)
        pair, truth, cameras = results.get(file.name, {}), file.truth(), file.cameras()
        figures["pairs"] += 1
        for member in ("raw", "refined"):
            if member in pair:
                largest = max(largest, measure.norm(pair[member]["t"]))
        motion = measure.refined_motion(pair)
        sd = measure.translation_direction_sd_deg(pair) if motion else None
        if not sd:
            figures["fail"] += 1
            continue
        ratio = measure.angle_deg(motion[1], truth[1]) / sd
        everywhere.append(ratio)
        if pair.get("translation_observable"):
            flagged.append(ratio)
            figures["too_wide"] += sd > MAX_SD_DEG
        if measure.norm(motion[1]) >= 0.999 * CAP_M:
            figures["at_cap"] += bool(pair.get("translation_observable") or
                                      pair.get("scale_observable"))
        stated = measure.rig_direction(pair)
        if stated:
            rig.append(measure.angle_deg(stated[0], measure.rig_motion(truth, cameras)) / stated[1])
    figures.update(flagged=len(flagged), flagged_ratio=measure.rms(flagged),
                   all_ratio=measure.rms(everywhere), rig_ratio=measure.rms(rig), largest_t=largest)
    return figures


def measure_turn(programs, turn_deg, arguments):
    generator = random.Random("%d %g" % (arguments.seed, turn_deg))
    with tempfile.TemporaryDirectory() as folder:
        for number in range(arguments.pairs):
            length = math.exp(generator.uniform(math.log(0.3), math.log(3)))
            scene = Scene(generator, measure.random_sign(generator) * turn_deg, length)
            scene.write(os.path.join(folder, "%04d.matches" % number))
        flags = ["--prior=body"] if arguments.prior == "body" else []
        return {"turn_deg": turn_deg, **judge(programs.estimate(folder, flags)[0], folder)}


def write_quarter_circle(directory, seed):
    """18 turns of 5 degrees on a radius of 4.8 m, each with its distance and the true axis."""
    generator = random.Random("quarter circle %d" % seed)
    length = 2 * 4.8 * math.sin(math.radians(2.5))
    for number in range(18):
        lines = [["time", "%.1f" % (0.1 * number), "%.1f" % (0.1 * (number + 1))],
                 ["axis", "0", "0", "1"], ["distance", repr(length), "0.005"]]
        scene = Scene(generator, 5.0, length, matches=150)
        scene.write(os.path.join(directory, "%02d.matches" % number), lines)


def measure_drive(programs, directory, name):
    """The error of the end of a drive, in percent of the path, from the report of --drift."""
    _, report = programs.estimate(directory, ["--drift"])
    drives = report.get("trajectories", [])
    end = drives[0].get("refined", {}).get("end") if len(drives) == 1 else None
    return {"drive": name, "pairs": len(report["pairs"]), "trajectories": len(drives),
            "end_percent": end["translation_percent"] if end else None,
            "end_deg": end["rotation_deg"] if end else None}


def main():
    parser = measure.make_parser(__doc__, pairs=50)
    parser.add_argument("--turns", default="1,5,10", help="degrees, comma separated (1,5,10)")
    parser.add_argument("--prior", choices=("none", "body"), default="none",
                        help="prior of the solvers: none, or body, which is exact here (none)")
    parser.add_argument("--drive", help="directories of drives with truth, comma separated")
    arguments = parser.parse_args()
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    turns = [measure_turn(programs, turn_deg, arguments)
             for turn_deg in measure.numbers(arguments.turns)]
    measure.print_table(
        ("turn deg", "pairs", "flagged", "err/sd flag", "err/sd all", "rig err/sd", "sd > 10",
         "max |t|", "at cap", "fail"),
        [(("%g" % t["turn_deg"]), t["pairs"], t["flagged"], t["flagged_ratio"], t["all_ratio"],
          t["rig_ratio"], t["too_wide"], t["largest_t"], t["at_cap"], t["fail"]) for t in turns])
    with tempfile.TemporaryDirectory() as folder:
        write_quarter_circle(folder, arguments.seed)
        drives = [measure_drive(programs, folder, "quarter circle")]
    for directory in arguments.drive.split(",") if arguments.drive else []:
        drives.append(measure_drive(programs, directory,
                                    os.path.basename(os.path.normpath(directory))))
    print()
    measure.print_table(("drive", "pairs", "trajectories", "end, percent", "end, deg"),
                        [list(drive.values()) for drive in drives])
    measure.finish(programs, arguments, turns=turns, drives=drives)


if __name__ == "__main__":
    measure.run_main(main)
