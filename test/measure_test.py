#!/usr/bin/env python3
"""measure.py, and each command that uses it with a tiny setting.

    test/measure_test.py FOLDER

FOLDER is the programs', build/release/bin. Python's standard library only.
"""
import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import unittest

FOLDER = os.path.abspath(sys.argv.pop(1))
HERE = os.path.dirname(os.path.abspath(__file__))
sys.dont_write_bytecode = True
sys.path.insert(0, HERE)
import measure  # noqa: E402
import one_camera  # noqa: E402
import splits  # noqa: E402

TEXT = """# a comment
format rigmatch 1
camera 0 pinhole 400 410 320 240 640 480 0.5 0.5 -0.5 0.5 0.1 0.2 0.3
camera 1 pinhole 500 490 300 250 640 480 1 0 0 0 0.7 0 0
axis 0 1 0
columns landmark i u v j u2 v2 score

matches 6
-1 0 1.0 2 0 3 4 0
-2 0 5 6 1 7 8 0
-3 0 1 2.0 1 9 9 0
-4 1 1 2 1 7 8 0
-5 0 3 4 0 1 2 0
-5 1 11 12 1 13 14 0
"""


def rotation_of(d):
    """Exp(d)."""
    half = measure.norm(d) / 2
    return measure.matrix_of([math.cos(half)] + measure.scaled(d, math.sin(half) / (2 * half)))


class Helpers(unittest.TestCase):
    def file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "0.matches")
            with open(path, "w", encoding="ascii") as file:
                file.write(TEXT)
            file = measure.MatchFile(path)
            file.remove_priors()
            file.write(folder)
            return measure.MatchFile(path)

    def test_file_reads_back(self):
        file = self.file()
        self.assertEqual(len(file.rows), 6)
        self.assertEqual(file.matches()[1], (0, 5, 6, 1, 7, 8))
        self.assertIsNone(file.line("axis"))
        self.assertEqual(len(file.cameras()), 2)

    def test_groups(self):
        # Rows 0 and 2 share a pixel at time 1, 1 and 3 at time 2, 4 and 5 a landmark.
        self.assertEqual(splits.groups_of(self.file()), [[0, 2], [1, 3], [4, 5]])
        halves = splits.halves_of(self.file(), None)
        self.assertEqual([len(half) for half in halves], [4, 2])

    def test_rotation_vector(self):
        for d in ([0.3, -0.2, 1.5], [1e-9, 0, 2e-9], [0, 3.1, 0]):
            for a, b in zip(measure.rotation_vector(rotation_of(d)), d):
                self.assertAlmostEqual(a, b, 12)

    def test_nees(self):
        covariance = [[4.0, 2.0], [2.0, 5.0]]
        self.assertAlmostEqual(measure.nees([2.0, 3.0], covariance),
                               (5 * 4 - 2 * 2 * 6 + 4 * 9) / 16)
        self.assertIsNone(measure.nees([1.0, 1.0], [[1.0, 2.0], [2.0, 1.0]]))

    def test_derivatives_of_the_constraint(self):
        cameras = self.file().cameras()
        motion = rotation_of([0.1, 0.2, -0.1]), [0.5, -0.2, 1.0]
        match, step = (0, 100.0, 200.0, 1, 300.0, 250.0), 1e-6
        value, derivative, sd = measure.constraint(match, cameras, motion, [0.3, 0.7])
        for k in range(6):
            change = [step * (k == m) for m in range(6)]
            moved = (measure.times(rotation_of(change[:3]), motion[0]) if k < 3 else motion[0],
                     measure.add(motion[1], change[3:]))
            other, _, _ = measure.constraint(match, cameras, moved, [1, 1])
            self.assertAlmostEqual((other - value) / step, derivative[k], 4)
        variance = 0
        for k, sigma in ((1, 0.3), (2, 0.3), (4, 0.7), (5, 0.7)):
            moved = [x + step if k == m else x for m, x in enumerate(match)]
            other, _, _ = measure.constraint(moved, cameras, motion, [1, 1])
            variance += (sigma * (other - value) / step) ** 2
        self.assertAlmostEqual(math.sqrt(variance) / sd, 1, 5)

    def test_bound_of_a_turn(self):
        # One camera at the origin that does not turn: a pixel (u, v) moves by the rotation as the
        # derivatives below say, and its noise is in both views.
        camera = measure.Camera("camera 0 pinhole 400 410 320 240 640 480 1 0 0 0 0 0 0".split())
        matches, information = [], [[0.0] * 3 for _ in range(3)]
        for u, v in ((100.0, 50.0), (300.0, 400.0), (600.0, 200.0)):
            matches.append((0, u, v, 0, u, v))
            x, y = (u - 320) / 400, (v - 240) / 410
            for row in ([-400 * x * y, 400 * (1 + x * x), -400 * y],
                        [-410 * (1 + y * y), 410 * x * y, 410 * x]):
                information = [[information[k][m] + row[k] * row[m] / (2 * 0.3 ** 2)
                                for m in range(3)] for k in range(3)]
        identity = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]
        bound = measure.rotation_bound(matches, [camera], identity, 0.3)
        for row, expected in zip(bound, measure.inverse(information)):
            for a, b in zip(row, expected):
                self.assertAlmostEqual(a / 1e-6, b / 1e-6, 4)

    def test_turns_of_one_camera(self):
        # Noise-free matches of the scene agree with its motion, which its file states.
        with tempfile.TemporaryDirectory() as folder:
            noise, one_camera.NOISE_PX = one_camera.NOISE_PX, 0
            one_camera.Scene(random.Random(1), 10, 2, outliers=0).write(
                os.path.join(folder, "0.matches"))
            one_camera.NOISE_PX = noise
            file = measure.MatchFile(os.path.join(folder, "0.matches"))
        truth = file.truth()
        self.assertAlmostEqual(measure.norm(truth[1]), 2)
        self.assertEqual(len(file.inliers()), 300)
        file.set_line("truth", "1 0 0 0 -1 0.3 0.2")
        self.assertEqual(len(file.inliers()), 0)


class Commands(unittest.TestCase):
    def run_command(self, name, *flags):
        """The JSON of a command."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "out.json")
            command = [sys.executable, "-B", os.path.join(HERE, name), "--bin=" + FOLDER,
                       "--json=" + path, *flags]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertLessEqual(max(map(len, done.stdout.splitlines())), 100)
            with open(path, encoding="utf-8") as file:
                return json.load(file)

    def test_programs_that_change(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("rigel_compare", "rigel_estimate", "rigel_simulate"):
                with open(os.path.join(folder, name), "w", encoding="ascii") as file:
                    file.write(name)
            programs = measure.Programs(folder)
            arguments = argparse.Namespace(json=os.path.join(folder, "out.json"))
            measure.finish(programs, arguments, figure=1)
            with open(arguments.json, encoding="utf-8") as file:
                self.assertEqual(json.load(file)["figure"], 1)
            os.remove(arguments.json)
            with open(os.path.join(folder, "rigel_estimate"), "a", encoding="ascii") as file:
                file.write("rebuilt")
            with self.assertRaises(measure.Failure):
                measure.finish(programs, arguments, figure=1)
            self.assertFalse(os.path.exists(arguments.json))

    def test_splits(self):
        result = self.run_command("splits.py", "--halvings=2")["results"][0]
        self.assertEqual((result["pairs"], result["left_out"]), (20, 0))
        self.assertTrue(0.4 < result["median"] < 2.5, result)

    def test_real_rigs(self):
        figures = self.run_command("real_rigs.py", "--rigs=scene,ring6", "--pairs=3",
                                   "--matches=100", "--yaw=1", "--outliers=0.2", "--marginals")
        self.assertEqual([s["rig"] for s in figures["settings"]], ["scene", "ring6"])
        self.assertEqual(figures["mean"]["failures"], 0)
        self.assertGreater(figures["mean"]["nees_rotation"], 0)

    def test_fisheye(self):
        rigs = self.run_command("fisheye.py", "--pairs=2")["rigs"]
        self.assertEqual([rig["failures"] for rig in rigs], [0, 0, 0, 0])
        self.assertEqual([rig["beyond_90_percent"] > 0 for rig in rigs],
                         [False, False, True, True])
        for rig in rigs:
            # The bound of the program and that of measure.py, with lenses of its own.
            self.assertAlmostEqual(rig["bound_over_own"], 1, delta=0.01)
            self.assertLess(rig["rotation"], 3)

    def test_one_camera(self):
        figures = self.run_command("one_camera.py", "--turns=5", "--pairs=2")
        self.assertEqual([turn["pairs"] for turn in figures["turns"]], [2])
        self.assertLess(figures["drives"][0]["end_percent"], 2)

    def test_motion_error(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([os.path.join(FOLDER, "rigel_simulate"), "--pairs=2",
                            "--output=" + folder], capture_output=True, check=True)
            pairs = self.run_command("motion_error.py", "--matches=" + folder, "--seeds=2",
                                     "--truth=" + ",".join(measure.match_files(folder)))["pairs"]
        self.assertEqual(len(pairs), 2)
        for pair in pairs:
            self.assertTrue(0 < pair["rotation_deg"] <= pair["rotation_max_deg"] < 0.3, pair)

    def test_false_confidence(self):
        with tempfile.TemporaryDirectory() as folder:
            poses = os.path.join(folder, "00.txt")
            with open(poses, "w", encoding="ascii") as file:
                for k in range(4):
                    file.write("1 0 0 0 0 1 0 0 0 0 1 %g\n" % (0.8 * k))
            figures = self.run_command("false_confidence.py", "--poses=" + poses, "--rigs=stereo",
                                       "--pairs=3", "--solvers=auto,3pt")
        self.assertEqual([s["pairs"] for s in figures["settings"]], [3, 3])
        self.assertEqual([s["quiet"] for s in figures["settings"]], [0, 0])

    def test_observable_length(self):
        with tempfile.TemporaryDirectory() as folder:
            output = os.path.join(folder, "surround_sim", "ring")
            measure.Programs(FOLDER).simulate(output, "ring6", 2, inter_share=0.3)
            sim = self.run_command("observable_length.py", "--data=" + folder, "--sets=sim",
                                   "--seeds=2")["sets"]
        self.assertEqual([s["runs"] for s in sim], [4])
        self.assertEqual([s["claimed_if_good"] for s in sim], [100])
        self.assertEqual([s["in_5"] for s in sim], [100])

    def test_second_minima(self):
        scenes = self.run_command("second_minima.py", "--pairs=2", "--scenes=far,cell",
                                  "--cameras=2")["scenes"]
        self.assertEqual([s["pairs"] for s in scenes], [2, 2])
        self.assertLess(scenes[0]["rotation_deg"], 0.3)

    def test_moving_cars(self):
        settings = self.run_command("moving_cars.py", "--rigs=stereo", "--shares=0,0.1",
                                    "--pairs=3")["settings"]
        self.assertEqual([s["failures"] for s in settings], [0, 0])
        self.assertLess(settings[0]["rotation"], 3)

    def test_still(self):
        with tempfile.TemporaryDirectory() as folder:
            measure.Programs(FOLDER).simulate(folder, "scene", 2, motion="still")
            figures = self.run_command("still.py", "--rigs=box", "--pairs=3",
                                       "--recorded=" + folder)["figures"]
        self.assertEqual([f["pairs"] for f in figures], [3, 3, 2])
        self.assertEqual([f["direction"] for f in figures], [0, 0, 0])
        for figure in figures:
            self.assertLess(figure["error_deg"], 0.2)

    def test_recorded_pairs(self):
        with tempfile.TemporaryDirectory() as folder:
            measure.Programs(FOLDER).simulate(folder, "scene", 3, num_matches=600, inter_share=0.4)
            results = self.run_command("recorded_pairs.py", "--matches=" + folder)["results"]
        self.assertEqual([r["left_out"] for r in results], [0, 0, 0])
        for result in results:
            self.assertLess(result["median"], 10)

    def test_noise_models(self):
        # Where matches between cameras say |t|, both bounds are of the same quantities.
        for model in self.run_command("noise_models.py", "--rig=ring6", "--inter_share=0.3",
                                      "--models=gauss-0.5", "--pairs=3")["models"]:
            for name in ("rotation", "direction"):
                self.assertAlmostEqual(model[name] / model[name + "_own"], 1, delta=0.05)


if __name__ == "__main__":
    unittest.main()
