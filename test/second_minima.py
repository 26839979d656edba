#!/usr/bin/env python3
"""Scenes in which other motions fit nearly as well: is what is said of the motion true?

  test/second_minima.py --bin=build/release/bin [--pairs=100] [--scenes=facade,line] [--cameras=1]

Writes match files of points that are

  facade  on a plane 8 to 15 m ahead that is turned by up to 40 degrees
  far     at 50 to 200 m, log-uniform
  cell    in a cube of 0.1 m, 10 m ahead
  line    on a line in space that crosses the view at 8 to 15 m

as seen by a rig that turns by 1 degree and moves by 1 m in any direction: one camera, or two that
look ahead, 1 m apart; 200 matches between a camera and itself, 0.5 pixels of noise, no outliers, no
time and no prior. rigel_estimate runs with unknown noise. Printed for each scene and rig:

  no cov   pairs without a valid covariance of the rotation
  n rot    median NEES of the rotation over that of chi2, of the others; 1 is right
  n dir    the same of the direction of the rig's motion, where that is stated
  rot, dir the pairs whose rotation and whose direction of t are stated as observable
  gross    of these, pairs with an observable rotation that is off by more than 1 degree and 5 of
           its stated sigmas, or an observable direction off by more than 10 degrees and 5 sigmas
  percent  the same of all pairs
  err      median rotation error of all motions, degrees
"""
import math
import os
import random
import tempfile

import measure

NOISE_PX, NUM_MATCHES = 0.5, 200
TURN_DEG = 1.0
# Body: x right, y down, z forward.
CAMERAS = {1: [(0.0, 0.0, 0.0)], 2: [(-0.5, 0.0, 0.0), (0.5, 0.0, 0.0)]}
GROSS_DEG, GROSS_DIRECTION_DEG, GROSS_SIGMAS = 1.0, 10.0, 5.0
MAX_DRAWS = 100000


def unit_vector(generator):
    v = [generator.gauss(0, 1) for _ in range(3)]
    return measure.scaled(v, 1 / measure.norm(v))


def rotation_about(axis, angle):
    half = angle / 2
    q = [math.cos(half)] + measure.scaled(axis, math.sin(half))
    return q, measure.matrix_of(q)


def ray_ahead(generator):
    """Somewhere in the view of a camera of 640 x 480 pixels and 77 degrees."""
    return [generator.uniform(-0.8, 0.8), generator.uniform(-0.6, 0.6), 1.0]


def facade(generator):
    middle = [0.0, 0.0, generator.uniform(8, 15)]
    tilt = math.radians(generator.uniform(0, 40))
    normal = measure.apply(rotation_about(unit_vector(generator), tilt)[1], [0.0, 0.0, 1.0])

    def draw():
        ray = ray_ahead(generator)
        return measure.scaled(ray, measure.dot(normal, middle) / measure.dot(normal, ray))
    return draw


def far(generator):
    def draw():
        ray = ray_ahead(generator)
        distance = math.exp(generator.uniform(math.log(50), math.log(200)))
        return measure.scaled(ray, distance / measure.norm(ray))
    return draw


def cell(generator):
    middle = measure.scaled([generator.uniform(-0.4, 0.4), generator.uniform(-0.3, 0.3), 1.0], 10)
    return lambda: [x + generator.uniform(-0.05, 0.05) for x in middle]


def line(generator):
    middle = measure.scaled([generator.uniform(-0.3, 0.3), generator.uniform(-0.2, 0.2), 1.0],
                            generator.uniform(8, 15))
    along = unit_vector(generator)
    return lambda: measure.add(middle, measure.scaled(along, generator.uniform(-15, 15)))


SCENES = {"facade": facade, "far": far, "cell": cell, "line": line}


def rows_of(generator, draw, cameras, motion):
    """Rows of a match file, or None if too few points are seen."""
    rows = []
    for _ in range(MAX_DRAWS):
        k = len(rows) % len(cameras)
        point = draw()
        moved = measure.add(measure.apply(motion[0], point), motion[1])
        first, second = cameras[k].project(point), cameras[k].project(moved)
        if cameras[k].sees(first) and cameras[k].sees(second):
            noisy = [repr(x + generator.gauss(0, NOISE_PX)) for x in first + second]
            rows.append([str(k), *noisy[:2], str(k), *noisy[2:], "0"])
            if len(rows) == NUM_MATCHES:
                return rows
    return None


def write_pair(path, scene, num_cameras, generator):
    lines = [["camera", str(k), "pinhole", "400", "400", "320", "240", "640", "480", "1", "0", "0",
              "0"] + [repr(x) for x in place] for k, place in enumerate(CAMERAS[num_cameras])]
    cameras = [measure.Camera(words) for words in lines]
    rows = None
    while rows is None:
        q, rotation = rotation_about(unit_vector(generator), math.radians(TURN_DEG))
        t = unit_vector(generator)
        rows = rows_of(generator, SCENES[scene](generator), cameras, (rotation, t))
    header = [["format", "rigmatch", "1"], *lines, ["truth"] + [repr(x) for x in q + t],
              ["noise_px", repr(NOISE_PX)], ["matches", str(len(rows))]]
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(" ".join(words) for words in header + rows) + "\n")


def judge_pair(pair, truth, cameras):
    """What is stated of a pair, and how it compares with the truth."""
    motion = measure.refined_motion(pair)
    if motion is None:
        return {"motion": False}
    turn = measure.rotation_error_deg(motion, truth)
    aside = measure.angle_deg(motion[1], truth[1])
    result = {"motion": True, "rotation_deg": turn, "direction_deg": aside, "gross": False,
              "rotation": bool(pair.get("rotation_observable")),
              "direction": bool(pair.get("translation_observable"))}
    for observable, error, sd, least in (
            ("rotation", turn, pair.get("rotation_sd_deg"), GROSS_DEG),
            ("direction", aside, measure.translation_direction_sd_deg(pair), GROSS_DIRECTION_DEG)):
        if result[observable] and error > max(least, GROSS_SIGMAS * (sd or 0)):
            result["gross"] = True
    covariance = measure.rotation_covariance(pair)
    if covariance:
        value = measure.nees(measure.rotation_difference(motion, truth), covariance)
        result["nees_rotation"] = None if value is None else value / measure.CHI2_MEDIAN[3]
    stated = measure.rig_direction(pair)
    if stated and pair.get("covariance_valid", True):
        along = measure.rig_motion(truth, cameras)
        # The stated sigma is that of both components together.
        value = 2 * (measure.angle_deg(stated[0], along) / stated[1]) ** 2
        result["nees_direction"] = value / measure.CHI2_MEDIAN[2]
    return result


def measure_scene(programs, scene, num_cameras, arguments):
    with tempfile.TemporaryDirectory() as folder:
        for number in range(arguments.pairs):
            # Each pair is the same whatever other pairs there are.
            generator = random.Random("%s %d %d %d" % (scene, num_cameras, arguments.seed, number))
            write_pair(os.path.join(folder, "%06d.matches" % number), scene, num_cameras, generator)
        results, _ = programs.estimate(folder)
        pairs = []
        for path in measure.match_files(folder):
            file = measure.MatchFile(path)
            pairs.append({"pair": file.name, **judge_pair(results.get(file.name, {}), file.truth(),
                                                          file.cameras())})
    moved = [pair for pair in pairs if pair["motion"]]

    def stated(name):
        return [pair[name] for pair in moved if pair.get(name) is not None]
    gross = sum(stated("gross"))
    return {"scene": scene, "cameras": num_cameras, "pairs": len(pairs),
            "no_covariance": len(pairs) - len(stated("nees_rotation")),
            "nees_rotation": measure.median(stated("nees_rotation")),
            "nees_direction": measure.median(stated("nees_direction")),
            "rotation": sum(stated("rotation")), "direction": sum(stated("direction")),
            "gross": gross, "gross_percent": 100 * gross / len(pairs),
            "rotation_deg": measure.median(stated("rotation_deg")),
            "gross_pairs": [pair["pair"] for pair in moved if pair["gross"]]}


def main():
    parser = measure.make_parser(__doc__, pairs=100)
    parser.add_argument("--scenes", default=",".join(SCENES), help="comma separated (all)")
    parser.add_argument("--cameras", default="1,2", help="rigs of so many cameras (1,2)")
    arguments = parser.parse_args()
    scenes = arguments.scenes.split(",")
    rigs = [int(number) for number in measure.numbers(arguments.cameras)]
    if any(scene not in SCENES for scene in scenes):
        parser.error("--scenes: expected %s" % ", ".join(SCENES))
    if any(number not in CAMERAS for number in rigs):
        parser.error("--cameras: expected 1 or 2")
    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    figures = [measure_scene(programs, scene, number, arguments)
               for scene in scenes for number in rigs]
    members = ["scene", "cameras", "pairs", "no_covariance", "nees_rotation", "nees_direction",
               "rotation", "direction", "gross", "gross_percent", "rotation_deg"]
    measure.print_table(["scene", "cameras", "pairs", "no cov", "n rot", "n dir", "rot", "dir",
                         "gross", "percent", "err"], [[f[m] for m in members] for f in figures])
    measure.finish(programs, arguments, scenes=figures)


if __name__ == "__main__":
    measure.run_main(main)
