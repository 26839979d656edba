#!/usr/bin/env python3
"""Accuracy and stated covariances with other noise than 0.5 pixels of Gaussian noise.

  test/noise_models.py --bin=build/release/bin [--pairs=100] [--rig=scene] [--models=gauss,t3]

Takes files without noise of rigel_simulate, adds noise of each model and has rigel_compare estimate
the motions with auto and unknown noise:

  gauss-S    Gaussian, S pixels: 0.1, 0.3, 0.5, 1, 2
  cameras    Gaussian, 0.2, 0.5, 0.5, 1 pixels on the cameras in turn; `scene` is `scene4` then
  mixture    each coordinate 0.6 sigma with 80 percent, else 3 sigma; sigma is 0.5 pixels
  laplace    Laplace of standard deviation 0.5 pixels
  t3         Student's t with three degrees of freedom, of standard deviation 0.5 pixels

Columns: RMS errors in degrees; `eff` is RMS error over the RMS of rigel_compare's bound, for the
rotation and the direction of t; `own` is that over the bound of measure.py, computed from the exact
pixels with the noise of each camera. It frees |t| (known to a factor of e), which older programs
hold. NEES over degrees of freedom: mean and median; with right covariances 1 and 0.89. The bounds
are of Gaussian noise and are left out for other models.
"""
import math
import random
import tempfile

import measure

SIGMA_PX = 0.5
CAMERA_SIGMAS_PX = (0.2, 0.5, 0.5, 1.0)


def draw_mixture(generator):
    return generator.gauss(0, SIGMA_PX * (0.6 if generator.random() < 0.8 else 3))


def draw_laplace(generator):
    return measure.random_sign(generator) * generator.expovariate(math.sqrt(2) / SIGMA_PX)


def draw_t3(generator):
    chi2 = sum(generator.gauss(0, 1) ** 2 for _ in range(3))
    return SIGMA_PX / math.sqrt(3) * generator.gauss(0, 1) / math.sqrt(chi2 / 3)


def gaussian(sigmas):
    """A model: draws the noise of a camera, and the standard deviations of the cameras."""
    return lambda generator, camera: generator.gauss(0, sigmas[camera % len(sigmas)]), sigmas


MODELS = {"gauss-%g" % sigma: gaussian([sigma]) for sigma in (0.1, 0.3, 0.5, 1, 2)}
MODELS["cameras"] = gaussian(CAMERA_SIGMAS_PX)
for model_name, draw in (("mixture", draw_mixture), ("laplace", draw_laplace), ("t3", draw_t3)):
    MODELS[model_name] = (lambda generator, camera, draw=draw: draw(generator)), None


def add_noise(file, draw_noise, generator):
    """Adds noise to all pixels of a file."""
    for camera, pixel in (("i", ("u", "v")), ("j", ("u2", "v2"))):
        which = file.column(camera)
        for name in pixel:
            k = file.column(name)
            for row in file.rows:
                row[k] = repr(float(row[k]) + draw_noise(generator, int(row[which])))


def bound_of(file, sigmas):
    """Bounds of rotation and direction in degrees, of a file without noise."""
    cameras, truth = file.cameras(), file.truth()
    covariance = measure.bound(file.inliers(), cameras, truth,
                               [sigmas[k % len(sigmas)] for k in range(len(cameras))])
    if covariance is None:
        return None
    return (math.degrees(math.sqrt(sum(covariance[k][k] for k in range(3)))),
            math.degrees(measure.direction_sd(truth[1], measure.block(covariance, 3))))


def measure_model(programs, name, arguments):
    draw_noise, sigmas = MODELS[name]
    rig = "scene4" if name == "cameras" and arguments.rig == "scene" else arguments.rig
    bounds = []
    with tempfile.TemporaryDirectory() as folder:
        programs.simulate(folder, rig, arguments.pairs, noise_px=0, num_matches=arguments.matches,
                          outlier_share=arguments.outliers, inter_share=arguments.inter_share,
                          rotation_deg=arguments.yaw)
        for number, path in enumerate(measure.match_files(folder)):
            file = measure.MatchFile(path)
            if sigmas:
                bounds.append(bound_of(file, sigmas))
            add_noise(file, draw_noise, random.Random("%s %d %d" % (name, arguments.seed, number)))
            # One number for all cameras, so there is a bound of rigel_compare only then.
            file.set_line("noise_px", "%g" % sigmas[0] if sigmas and len(sigmas) == 1 else None)
            file.write(folder)
        flags = measure.apply_prior(folder, arguments.prior)
        figures = measure.compare_figures(programs.compare(folder, flags))
    for k, quantity in enumerate(("rotation", "direction")):
        limit = measure.rms([bound[k] for bound in bounds if bound])
        error = figures[quantity + "_rms_deg"]
        figures[quantity + "_own"] = error / limit if error is not None and limit else None
    return {"model": name, **figures}


def main():
    parser = measure.make_parser(__doc__, pairs=50)
    parser.add_argument("--rig", default="scene",
                        help="scene, sceneN, ringN or the file of a rig, which drives through the "
                        "street (scene)")
    parser.add_argument("--models", default="all",
                        help="beginnings of names, comma separated (all)")
    parser.add_argument("--matches", type=int, default=200, help="matches of a pair (200)")
    parser.add_argument("--outliers", type=float, default=0.2, help="share of outliers (0.2)")
    parser.add_argument("--inter_share", type=float, default=0,
                        help="share of matches between different cameras (0)")
    parser.add_argument("--yaw", type=float, default=1, help="turn, degrees (1)")
    measure.add_prior_flag(parser)
    arguments = parser.parse_args()
    wanted = tuple(arguments.models.split(",")) if arguments.models != "all" else ("",)
    names = [name for name in MODELS if name.startswith(wanted)]
    if not names:
        parser.error("--models: expected beginnings of %s" % ", ".join(MODELS))

    programs = measure.Programs(arguments.bin, arguments.seed, arguments.threads)
    models = [measure_model(programs, name, arguments) for name in names]
    head = ["model", "rot deg", "eff", "own", "dir deg", "eff", "own", "NEES", "median", "no t",
            "fail"]
    rows = [[m["model"], m["rotation_rms_deg"], m["rotation"], m["rotation_own"],
             m["direction_rms_deg"], m["direction"], m["direction_own"], m["nees_mean"],
             m["nees_median"], m["unobservable"], m["failures"]] for m in models]
    measure.print_table(head, rows)
    measure.finish(programs, arguments, models=models)


if __name__ == "__main__":
    measure.run_main(main)
