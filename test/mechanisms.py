#!/usr/bin/env python3
"""What each mechanism of the refinement is worth: figures with it off, beside those with all.

  test/mechanisms.py [--only=NAME,..] [--pairs=100] [--data=DIR] [--json=FILE]
  test/mechanisms.py --check

A mechanism is switched off by a change of the source. For each, a copy of the tree in --work gets
the change, the programs are built from it, and these are measured:

  scene     rigel_simulate's scene, intra-camera matches, 20 percent outliers
  mixed     the same, half of the matches between cameras
  noisy     the scene with 2 px of noise
  street    the nuScenes rig in the street, turns of 1 degree, 20 percent outliers (with --data)
            rot: RMS error of the rotation over RMS bound; rig (street): of the rig's direction;
            NEES: the mean over degrees of freedom. 1 is perfect for all
  KITTI     kitti_stereo_06 (with --data): median error of the rotation, degrees; split: the median
            NEES of the difference of two halves, over that of chi2

--check only looks whether each change still fits the source. Names are those of the first column.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import types

import measure
import splits

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LEFT_OUT = shutil.ignore_patterns("build", ".git", "__pycache__")

# (name, file, text, its replacement)
MECHANISMS = (
    ("noise a camera pair", "refine/search/noise_model.cc",
     "for (size_t g = 0; g < num_groups && num_groups > 1; ++g) {",
     "for (size_t g = num_groups; g < num_groups; ++g) {"),
    ("gate follows the noise", "refine/refine.cc",
     "options.threshold_px == kAutoThresholdPx;", "false;"),
    ("least gate", "refine/search/noise_model.cc",
     "constexpr double kKept = 0.9;", "constexpr double kKept = 0.0;"),
    ("outliers taken out of the noise", "refine/search/noise_model.cc",
     "model_.outliers_per_px[g] = in_band / (end - begin);", "model_.outliers_per_px[g] = 0.0;"),
    ("mean square of the core", "refine/search/noise_model.cc",
     "if (!(limit < gate) || !(limit > 0)) return sigma;", "return sigma;"),
    ("leverage", "refine/fit.cc",
     "bool judge = exclude_implausible && !previous.empty();", "bool judge = false;"),
    ("competition", "refine/search/shared_pixels.cc",
     "if (!one_image ||", "if (one_image || !one_image ||"),
    ("epipole weights", "refine/refine.h",
     "bool epipole_weights = true;", "bool epipole_weights = false;"),
    ("loss", "refine/fit.cc",
     "engine_options.loss = options_.loss;", "engine_options.loss = LossKind::kNone;"),
    ("lengths by vote", "refine/refine.cc",
     "if (voted != fit_.pose.t.norm()) try_length(voted);", ""),
    ("typical length", "refine/refine.cc",
     "if (!GoesOn() || !LengthIsOpen()) return true;", "return true;"),
    ("other motions of the search", "refine/refine.cc",
     "for (const Pose& body : others_) {", "for (const Pose& body : std::vector<Pose>()) {"),
    ("second motion of a plane", "refine/refine.cc",
     "if (twin.has_value()) TryStart(*twin);", ""),
    ("measured curvature", "refine/fit_information.cc",
     "fit.is_minimum && !fit.noise_is_given\n", "false\n"),
    ("measured scatter", "refine/fit_information.cc",
     "constexpr double kModelWeight = 300.0;", "constexpr double kModelWeight = 1e9;"),
    ("shared pixels in the scatter", "refine/fit_information.cc",
     "information.scatter += rows.SharedScatter(fit.shared, v_of);", ""),
)


def changed(source, mechanism):
    """The text of the mechanism's file with the change."""
    name, file, old, new = mechanism
    with open(os.path.join(source, file), encoding="utf-8") as stream:
        text = stream.read()
    if text.count(old) != 1:
        raise measure.Failure("%s: %s has %d times, expected once: %s" %
                              (name, file, text.count(old), old))
    return text.replace(old, new)


def build(source, directory):
    """Builds the programs that measure; returns their directory."""
    commands = ["cmake -S %s -B %s -G Ninja -DCMAKE_BUILD_TYPE=Release -DRIGEL_BUILD_TOOLS=ON "
                "-DRIGEL_BUILD_TESTS=OFF" % (source, directory),
                "cmake --build %s --target rigel_simulate rigel_compare rigel_estimate" % directory]
    for command in commands:
        done = subprocess.run(command.split(), capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise measure.Failure("%s: %s" % (command, (done.stdout + done.stderr)[-2000:]))
    return os.path.join(directory, "bin")


def figures_of(directory, arguments):
    """The figures of one row of the table."""
    programs = measure.Programs(directory, arguments.seed, arguments.threads)
    rows = {"scene": ("scene", {}), "mixed": ("scene", {"inter_share": 0.5}),
            "noisy": ("scene", {"noise_px": 2})}
    if arguments.data:
        rows["street"] = (os.path.join(arguments.data, "rigs", "nuscenes.json"),
                          {"rotation_deg": 1, "num_matches": 300})
    figures = {}
    for name, (rig, settings) in rows.items():
        with tempfile.TemporaryDirectory() as folder:
            programs.simulate(folder, rig, arguments.pairs, outlier_share=0.2, **settings)
            report = measure.compare_figures(
                programs.compare(folder, measure.apply_prior(folder, "none")))
        figures[name + "_rotation"], figures[name + "_nees"] = report["rotation"], report[
            "nees_mean"]
        if name == "street":
            figures["street_rig"] = report["rig_direction"]
    if arguments.data:
        kitti = os.path.join(arguments.data, "kitti_stereo_06")
        report = programs.compare(kitti, ["--prior=body"])
        figures["kitti"] = report["results"][0]["refined"]["rotation_deg"]["median"]
        halves = types.SimpleNamespace(even_odd=False, halvings=2, seed=arguments.seed,
                                       flags=["--prior=body"])
        figures["split"] = splits.measure_directory(programs, kitti, halves)["median"]
    return figures


def main():
    parser = measure.make_parser(__doc__, pairs=100)
    parser.add_argument("--check", action="store_true", help="only check the changes")
    parser.add_argument("--only", help="names of mechanisms, comma separated")
    parser.add_argument("--work", default="build/mechanisms", help="directory of the copy")
    parser.add_argument("--data", default=os.environ.get("RIGEL_REAL_DATA"),
                        help="directory with rigs and kitti_stereo_06 ($RIGEL_REAL_DATA)")
    arguments = parser.parse_args()
    for mechanism in MECHANISMS:
        changed(ROOT, mechanism)
    if arguments.check:
        return
    names = [mechanism[0] for mechanism in MECHANISMS]
    wanted = arguments.only.split(",") if arguments.only else names
    for name in wanted:
        if name not in names:
            raise measure.Failure("--only: %s is none of: %s" % (name, ", ".join(names)))

    source, directory = (os.path.join(os.path.abspath(arguments.work), name)
                         for name in ("source", "build"))
    shutil.rmtree(source, ignore_errors=True)
    shutil.copytree(ROOT, source, ignore=LEFT_OUT, symlinks=True)
    results = {"all on": figures_of(build(source, directory), arguments)}
    for mechanism in MECHANISMS:
        name, file = mechanism[:2]
        if name not in wanted:
            continue
        path = os.path.join(source, file)
        with open(path, encoding="utf-8") as stream:
            before = stream.read()
        text = changed(source, mechanism)
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text)
        print("without: %s" % name, file=sys.stderr)
        results[name] = figures_of(build(source, directory), arguments)
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(before)
    columns = (("scene", "scene_rotation"), ("NEES", "scene_nees"), ("mixed", "mixed_rotation"),
               ("NEES", "mixed_nees"), ("noisy", "noisy_rotation"), ("NEES", "noisy_nees"),
               ("street", "street_rotation"), ("rig", "street_rig"), ("NEES", "street_nees"),
               ("KITTI", "kitti"), ("split", "split"))
    measure.print_table(["without"] + [head for head, _ in columns],
                        [[name] + [figures.get(member) for _, member in columns]
                         for name, figures in results.items()])
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as stream:
            json.dump({"options": vars(arguments), "results": results}, stream, indent=1)


if __name__ == "__main__":
    measure.run_main(main)
