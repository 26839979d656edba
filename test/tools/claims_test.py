#!/usr/bin/env python3
"""The verdicts of rigel_claims.py, on results made up so that each claim holds or does not, and its
exit codes.

    test/tools/claims_test.py FOLDER

FOLDER is the programs', build/release/bin. Python's standard library only.
"""
import contextlib
import io
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import unittest

FOLDER = os.path.abspath(sys.argv.pop(1))
SCRIPT = os.path.join(FOLDER, "rigel_claims.py")
sys.dont_write_bytecode = True
sys.path.insert(0, FOLDER)
import rigel_claims  # noqa: E402

CLAIMS, GROUPS, UNITS = rigel_claims.read_list(rigel_claims.LIST)
TENTHS = [k / 10 for k in range(11)]
GRIDS = {"planar-vibration": [2 * x for x in TENTHS], "rotation-angle": [0, 5, 10, 20],
         "inter-share": [0, 10, 25, 100]}
SOLVERS = {"planar-image-noise": ["17pt-li", "6pt-stewenius", "2pt-choi", "3pt-approx"],
           "planar-vibration": ["17pt-li", "6pt-stewenius", "2pt-choi", "3pt-approx"],
           "rotation-angle": ["4pt-approx", "4pt-approx-polished", "4pt"],
           "kitti-motions": GROUPS["6-DoF"] + GROUPS["4-point"] + ["3pt-approx"]}


PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/claims.md")


def general(solver):
    return solver.startswith(("17pt", "6pt"))


def statistic(value):
    return {"median": value, "mean": value, "rms": value, "p90": value}


def made_up(name, raw, refined=0.3, pairs=100, bound=1.0, scale=0.005):
    """A report: raw(motion, x, solver) is the error in rotation and direction, and the time;
    `refined` is over that, `bound` over the refined one."""
    if UNITS[name] is None:
        points = [("driven", {"sequence": drive}, None) for drive in ("00", "01")]
    else:
        motions = ["random"] if name in ("rotation-angle", "inter-share") \
            else ["forward", "random", "sideways"]
        points = [(motion, {"x": x, "sequence": "all"}, x)
                  for motion in motions for x in GRIDS.get(name, TENTHS)]
    rows = []
    for motion, place, x in points:
        for solver in SOLVERS.get(name, GROUPS["6-DoF"] + GROUPS["4-point"]):
            error = raw(motion, x, solver)
            stages = {}
            for stage, factor in (("raw", 1), ("refined", refined), ("bound", refined * bound)):
                stages[stage] = {key: statistic(factor * error)
                                 for key in ("rotation_deg", "translation_dir_deg")}
            if x != 0:
                stages["refined"]["scale"] = statistic(scale)
            for loop in ("paper", "rigel"):
                rows.append({"motion": motion, **place, "loop": loop, "solver": solver,
                             "pairs": pairs, "failures": 0, **stages, "iterations": statistic(1000),
                             "time_ms": {"ransac": statistic(error)}})
    size = {"every": 2} if UNITS[name] is None else {"pairs": pairs}
    return {"format": "rigel-experiment 1", "experiment": name,
            "options": {"quick": True, "seed": 1, **size}, "results": rows}


def judged(*reports):
    results = {report["experiment"]: rigel_claims.Results(
        report, report["experiment"], UNITS[report["experiment"]] is not None)
        for report in reports}
    return rigel_claims.judge(CLAIMS, GROUPS, UNITS, results)


def find(part, *reports):
    """The first claim whose text has that part."""
    return next(claim for claim in judged(*reports) if part in claim["claim"])


class Verdicts(unittest.TestCase):
    def expect(self, verdict, part, *reports):
        self.assertEqual(find(part, *reports)["verdict"], verdict, part)

    def test_four_point_against_six_dof(self):
        part = "4-point solvers beat"
        claim = find(part, made_up("image-noise", lambda m, x, s: 0.2 if general(s) else 0.1))
        self.assertEqual(claim["verdict"], "confirmed")
        self.assertIn("forward, 0.5 px: 4-point 0.100, 6-DoF 0.200 deg", claim["figures"])
        self.assertEqual(claim["where_not"], "")
        # One of the four is worse, sideways only: in 10 of 30 cases.
        claim = find(part, made_up("image-noise", lambda m, x, s: 0.2 if general(s) else
                                   0.3 if (s, m) == ("4pt-liu", "sideways") else 0.1))
        self.assertEqual(claim["verdict"], "not confirmed")
        for text in ("holds in 20 of 30 cases; not in sideways at 0.1",
                     "worst 4-point 0.300, best 6-DoF 0.200", "sideways at 0.2", ". ",
                     "sideways, 0 px: 4-point 0.100 to 0.300, 6-DoF 0.200 deg",
                     "medians of 100 pairs, 1 / sqrt(n) is 10 percent"):
            self.assertIn(text, claim["where_not"])
        self.assertNotIn("sideways at 0.3", claim["where_not"])
        # At one noise level of one motion: in most cases.
        self.expect("partly", part, made_up("image-noise", lambda m, x, s: 0.2 if general(s) else
                                            0.3 if (m, x) == ("random", 1) else 0.1))

    def test_axis_is_best_but_sideways(self):
        for motion, verdict in (("sideways", "confirmed"), ("forward", "not confirmed")):
            self.expect(verdict, "4pt-axis-approx is the best", made_up(
                "image-noise", lambda m, x, s: 0.1 if s != "4pt-axis-approx" else
                0.2 if m == motion else 0.05))

    def test_about_equal_is_within_a_quarter(self):
        for ratio, verdict in ((1.2, "confirmed"), (1.3, "not confirmed"), (0.7, "not confirmed")):
            self.expect(verdict, "4pt-approx resists pitch", made_up(
                "pitch-noise", lambda m, x, s: 0.1 * ratio if s == "4pt-approx" else 0.1))

    def test_crossings_are_interpolated(self):
        def crossing(place):
            return find("become worse", made_up(
                "roll-noise", lambda m, x, s: 0.1 + (place if general(s) else x)))
        self.assertEqual(crossing(0.33)["verdict"], "confirmed")
        self.assertIn("sideways: 4pt-lee 0.33, 4pt-liu 0.33", crossing(0.33)["figures"])
        self.assertEqual(crossing(0.05)["verdict"], "not confirmed")
        self.assertEqual(crossing(2)["verdict"], "not confirmed")
        self.assertIn("none to 1", crossing(2)["figures"])

    def test_refined_curves_are_flat_between_the_ends_too(self):
        part = "refined errors stay the same"
        for slope, verdict in ((0.05, "confirmed"), (0.2, "not confirmed")):
            self.expect(verdict, part, made_up(
                "pitch-noise", lambda m, x, s: 0.1 + 0.1 * slope * x))
        self.expect("not confirmed", part, made_up(
            "pitch-noise", lambda m, x, s: 0.2 if 0.3 < x < 0.9 else 0.1))

    def test_half_of_raw(self):
        for refined, pairs, verdict in ((0.4, 100, "confirmed"), (0.6, 100, "not confirmed"),
                                        (0.4, 35, "too few pairs"), (0.4, 36, "confirmed")):
            self.expect(verdict, "at most half", made_up(
                "image-noise", lambda m, x, s: 0.1, refined, pairs))

    def test_the_limit_on_the_bound_knows_the_number_of_pairs(self):
        # Three motions of 100 pairs and more: 1.1. Of 60: 1.13. Of 30: 1.183.
        for ratio, pairs, verdict in (
                (1.09, 500, "confirmed"), (1.11, 500, "not confirmed"), (1.12, 60, "confirmed"),
                (1.15, 60, "not confirmed"), (1.15, 30, "confirmed"), (1.2, 30, "not confirmed"),
                (1.0, 5, "too few pairs"), (2.0, 5, "too few pairs")):
            claim = find("Cramer-Rao", made_up("image-noise", lambda m, x, s: 0.1, pairs=pairs,
                                               bound=1 / ratio))
            self.assertEqual(claim["verdict"], verdict, (ratio, pairs))
        self.assertIn("the limit would be 1.45; it has to be below 1.30", claim["where_not"])

    def test_most_cases_are_more_than_half(self):
        for last, verdict in ((1.01, "confirmed"), (0.81, "not confirmed")):  # 6 and 5 of 11
            claim = find("than 2pt-choi in most cases", made_up(
                "planar-vibration", lambda m, x, s: 0.2 if s != "3pt-approx" else
                0.1 if x <= last else 0.3))
            self.assertEqual(claim["verdict"], verdict)
            self.assertIn("holds in " + ("36" if last > 1 else "30") + " of 66 cases",
                          claim["figures"] + claim["where_not"])

    def test_times_of_the_paper(self):
        def times(factor):
            of = {"4pt-liu": 1, "4pt-axis-approx": 1.5, "4pt-approx": 1.7 * factor, "4pt-lee": 2.9,
                  "3pt-approx": 2}
            return [made_up(name, lambda m, x, s: of.get(s, 6 / factor))
                    for name in ("image-noise", "kitti-motions")]
        for part in ("far faster", "the fastest 4-point solver", "about 1.7 times",
                     "slightly slower"):
            self.expect("confirmed", part, *times(1))
            self.expect("not confirmed", part, *times(2.5))
        without = made_up("image-noise", lambda m, x, s: 0.1)
        for row in without["results"]:
            del row["time_ms"]
        self.expect("not measured", "far faster", without)

    def test_unaffected_and_growing(self):
        def report(name, six):
            return made_up(name, lambda m, x, s: 0.1 * (1 + (six if general(s) else 1) * x))
        for name in ("pitch-noise", "roll-noise", "planar-vibration"):
            self.expect("confirmed", "unaffected", report(name, 0))
            self.expect("not confirmed", "unaffected", report(name, 1))
        self.expect("confirmed", "solvers grow", report("pitch-noise", 0))
        for slope, verdict in ((0.5, "confirmed"), (2, "not confirmed")):
            self.expect(verdict, "more slowly", made_up(
                "planar-image-noise",
                lambda m, x, s: 0.1 * (1 + x * (slope if s == "3pt-approx" else 1))))

    def test_planar(self):
        for at, part in ((0.2, "like 2pt-choi"), (0.8, "better than 2pt-choi"),
                         (0.4, "3pt-approx beats 17pt-li")):
            for worse, verdict in ((9, "confirmed"), (at, "not confirmed")):
                self.expect(verdict, part, made_up(
                    "planar-image-noise", lambda m, x, s: 0.1 if s != "3pt-approx" else
                    0.3 if abs(x - worse) < 0.15 else 0.09))
        self.expect("not confirmed", "is ahead", made_up(
            "planar-vibration", lambda m, x, s: 0.3 if s == "3pt-approx" and x < 0.5 else 0.2))

    def test_kitti_rankings(self):
        report = made_up("kitti-motions", lambda m, x, s: 0.1 if s == "4pt-axis-approx" else
                         0.5 if general(s) else 0.2)
        for part, verdict in (("beat the 6-DoF ones", "confirmed"),
                              ("4pt-lee is slightly best", "not confirmed"),
                              ("marginally best in direction", "confirmed"),
                              ("fastest", "confirmed"),
                              ("17pt-li, with one solution", "not confirmed"),
                              ("limit of iterations", "confirmed")):
            self.expect(verdict, part, report)
        claim = find("beat the 6-DoF ones", report)
        self.assertIn("deg: 4pt-axis-approx 0.100, 3pt-approx 0.200", claim["figures"])
        report["results"][0]["iterations"]["median"] = 999
        self.expect("partly", "limit of iterations", report)

    def test_polishing(self):
        for polished, verdict in ((0.12, "confirmed"), (0.13, "not confirmed")):
            report = made_up("rotation-angle", lambda m, x, s: 0.1 if s == "4pt" else polished)
            self.expect("not confirmed", "polishing", report)
            for row in report["results"]:
                row["refined"]["rotation_deg"] = statistic(0.03)
            self.expect(verdict, "polishing", report)

    def test_scale(self):
        for scale, verdict in ((0.0099, "confirmed"), (0.0101, "not confirmed")):
            self.expect(verdict, "gives the scale", made_up(
                "inter-share", lambda m, x, s: 0.1, scale=scale))
        report = made_up("inter-share", lambda m, x, s: 0.1)
        for row in report["results"]:
            if row["x"] >= 25 and row["solver"] == "17pt-li":
                row["refined"].pop("scale", None)  # it is that of both loops
        claim = find("gives the scale", report)
        self.assertEqual(claim["verdict"], "partly", "no value is no scale within 1 percent")
        self.assertIn("17pt-li -", claim["where_not"])

    def test_without_rows_nothing_is_measured(self):
        reports = [made_up(name, lambda m, x, s: 0.1) for name in UNITS]
        self.assertGreater(len(judged(*reports)), 40)
        for report in reports:
            report["results"] = []
        for claim in judged(*reports):
            self.assertEqual((claim["verdict"], claim["figures"], claim["where_not"]),
                             ("not measured", "", ""))

    def test_a_reason_is_a_figure_of_the_run(self):
        # The same errors times three: what is said beside the cases has other numbers, or none.
        def beside(factor):
            source = random.Random(1)
            reports = [made_up(name, lambda m, x, s: factor * math.exp(source.gauss(0, 1)), 0.9,
                               400 if factor == 1 else 100) for name in UNITS]
            return {claim["claim"]: claim["where_not"].partition(". ")[2]
                    for claim in judged(*reports) if claim["verdict"] != "confirmed"}
        one, three = beside(1), beside(3)
        self.assertGreater(sum(map(bool, one.values())), 10)
        for claim, text in one.items():
            if text and not text.startswith("iterations"):
                self.assertNotEqual(text, three[claim])


class Program(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, value):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(value if isinstance(value, str) else json.dumps(value))

    def read(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def run_script(self, *arguments, **options):
        return subprocess.run([sys.executable, SCRIPT, *arguments], text=True, check=False,
                              stderr=subprocess.PIPE, **{"stdout": subprocess.PIPE, **options})

    def test_writes_verdicts(self):
        self.write("kitti-motions.json", made_up("kitti-motions", lambda m, x, s: 0.1))
        self.write("outliers.json", made_up("outliers", lambda m, x, s: 0.1, pairs=7))
        self.write("other.json", "{")
        run = self.run_script(self.folder)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        report = json.loads(self.read("claims.json"))
        self.assertEqual(report["format"], "rigel-claims 1")
        self.assertRegex(report["rigel_version"], r"^\d+\.\d+\.\d+$")
        lines = self.read("claims.md").splitlines()
        head = lines.index(rigel_claims.TABLE_HEAD[0])
        self.assertEqual(len(lines), head + 2 + len(report["claims"]), "a line a claim")
        self.assertIn("- `kitti-motions`: every 2nd motion, seed 1", lines[:head])
        self.assertIn("- `outliers`: 7 pairs a point, the coarse grid of --quick, seed 1", lines[:head])
        said = [line for line in run.stdout.splitlines() if not line.startswith(" ")]
        self.assertEqual([line[:15].strip() for line in said],
                         [claim["verdict"] for claim in report["claims"]])
        self.assertLessEqual(max(map(len, run.stdout.splitlines())), 100)

    def test_exit_codes(self):
        self.assertEqual(self.run_script("--help").returncode, 0)
        for wrong in ([], ["a", "b"], ["--nonsense", "a"]):
            self.assertEqual(self.run_script(*wrong).returncode, 2)
        run = self.run_script(self.folder)
        self.assertEqual(run.returncode, 1)
        self.assertEqual(len(run.stderr.splitlines()), 1)
        self.assertIn("no results", run.stderr)
        self.assertEqual(os.listdir(self.folder), [])
        self.write("outliers.json", made_up("outliers", lambda m, x, s: 0.1))
        self.write("image-noise.json", made_up("image-noise", lambda m, x, s: 0.1))
        with open("/dev/full", "w", encoding="utf-8") as full:
            run = self.run_script(self.folder, stdout=full)
        self.assertEqual((run.returncode, run.stderr),
                         (1, "rigel_claims.py: stdout: cannot be written\n"))
        os.unlink(self.path("claims.md"))
        os.mkdir(self.path("claims.md"))
        run = self.run_script(self.folder)
        self.assertEqual(run.returncode, 1)
        self.assertIn("claims.md: cannot be written", run.stderr)

    def test_what_is_no_result_is_told_in_one_line(self):
        whole = made_up("image-noise", lambda m, x, s: 0.1)
        wrong = ["", "[]", "[" * 100000, "{}", {**whole, "format": "rigel-report 1"},
                 {**whole, "experiment": "outliers"}, {**whole, "results": 3},
                 {**whole, "results": [[]]}, {**whole, "options": {"quick": True, "seed": -1}}]
        row = whole["results"][0]
        for change in ({"x": "1"}, {"x": math.inf}, {"x": 10 ** 400}, {"motion": 1},
                       {"pairs": 1.5}, {"failures": -1}, {"raw": {"rotation_deg": {"median": "a"}}},
                       {"raw": 3}, {"iterations": {"median": 1}}, {"loop": None},
                       {"solver": ["\u001b[31m"]}):
            wrong.append({**whole, "results": [{**row, **change}]})
        wrong.append({**whole, "results": [{key: row[key] for key in row if key != "x"}]})
        self.write("outliers.json", made_up("outliers", lambda m, x, s: 0.1))
        for text in wrong:
            self.write("image-noise.json", text)
            run = self.run_script(self.folder)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
            self.assertIn("image-noise.json: not among the claims: ", run.stderr)
            self.assertNotIn("\u001b", run.stderr)
            self.assertEqual(json.loads(self.read("claims.json"))["claims"], [])

    def test_damaged_results_are_refused_or_judged(self):
        source = random.Random(3)
        row = made_up("image-noise", lambda m, x, s: 0.1)["results"][0]
        small = made_up("image-noise", lambda m, x, s: 0.1)
        small["results"] = [{**row, "x": x, "solver": solver, "loop": loop} for x in (0, 0.5)
                            for solver in SOLVERS["kitti-motions"] for loop in ("paper", "rigel")]
        text = json.dumps(small)
        parts = ["0", "1e308", "-1e308", "1e-320", "-1", "null", "{}", "[]", '"', ",", "9" * 30,
                 "x"]
        refused = 0
        for _ in range(300):
            damaged = text
            for _ in range(source.randint(1, 3)):
                places = [k for k, c in enumerate(damaged) if c in '0123456789."']
                at = source.choice(places)
                damaged = damaged[:at] + source.choice(parts) + damaged[at + source.randint(0, 3):]
            self.write("image-noise.json", damaged)
            with contextlib.redirect_stderr(io.StringIO()) as talk:
                results = rigel_claims.read_results(self.folder, UNITS)
            self.assertEqual(len(talk.getvalue().splitlines()), 0 if results else 1)
            rigel_claims.judge(CLAIMS, GROUPS, UNITS, results)
            refused += not results
        self.assertTrue(0 < refused < 300, refused)

    def test_the_page_is_of_this_script(self):
        with open(PAGE, encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertEqual(lines[0], rigel_claims.FIRST_LINE)
        head = lines.index(rigel_claims.TABLE_HEAD[0])
        self.assertEqual(lines[head + 1], rigel_claims.TABLE_HEAD[1])
        self.assertEqual(lines[head - 5:head - 1], rigel_claims.about({})[-4:])

    def test_missing_values_of_any_kind_are_no_cases(self):
        source = random.Random(2)
        for name in UNITS:
            report = made_up(name, lambda m, x, s: 0.1)
            for row in report["results"]:
                for key in ("raw", "refined", "bound", "iterations", "time_ms"):
                    if source.random() < 0.3:
                        del row[key]
            self.write(name + ".json", report)
        run = self.run_script(self.folder)
        self.assertEqual((run.returncode, run.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
