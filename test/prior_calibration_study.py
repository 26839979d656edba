#!/usr/bin/env python3
"""Whether rigel_calibrate_prior finds what was put in, and what the planar solver gains by it.

    test/prior_calibration_study.py

Simulated clips whose normal and gravity lines are turned by 2 degrees: error of the calibration
against its stated standard deviation. With RIGEL_REAL_DATA set, also: the same on the recorded
motion of KITTI 00 (simulated points), and raw errors of 3pt on the real clips before (--prior=body)
and after. Prints what it measures; exit code 1 if on more than one simulated clip in ten an error
is beyond three standard deviations. The build is $RIGEL_BUILD_DIR, by default build/release. Python's standard library only.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

TURN_DEG = (1.2, 0.0, 1.6)  # rotation vector, 2 degrees
SEEDS = 20
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BIN = os.path.join(os.environ.get("RIGEL_BUILD_DIR") or os.path.join(ROOT, "build", "release"), "bin")


def run(tool, *args):
    done = subprocess.run([os.path.join(BIN, "rigel_" + tool), *args], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"rigel_{tool} {' '.join(args)}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def turned(v, sign):
    """v turned by the rotation vector TURN_DEG (Rodrigues)."""
    w = [sign * math.radians(d) for d in TURN_DEG]
    angle = math.sqrt(sum(c * c for c in w))
    k = [c / angle for c in w]
    cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]]
    dot = sum(a * b for a, b in zip(k, v))
    return [v[i] * math.cos(angle) + cross[i] * math.sin(angle) + k[i] * dot * (1 - math.cos(angle))
            for i in range(3)]


def misalign(directory):
    for name in os.listdir(directory):
        path = os.path.join(directory, name)
        lines = open(path, encoding="utf-8").read().split("\n")
        for k, line in enumerate(lines):
            words = line.split()
            if not words or words[0] == "matches":
                break
            if words[0] in ("gravity1", "gravity2", "normal"):
                v = turned([float(w) for w in words[1:]], -1 if words[0] == "normal" else 1)
                lines[k] = words[0] + " " + " ".join(repr(c) for c in v)
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines))


def angle_deg(a, b):
    cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    return math.degrees(math.atan2(math.hypot(*cross), sum(x * y for x, y in zip(a, b))))


def rotated(q, v):
    w, u = q[0], q[1:]
    cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    dot = sum(a * b for a, b in zip(u, v))
    return [(w * w - sum(c * c for c in u)) * v[i] + 2 * dot * u[i] + 2 * w * cross[i] for i in range(3)]


def tilt_error(gravity):
    """Angle between the vertical and where the calibration turns it, of a level vehicle."""
    return angle_deg(rotated(gravity["q_wxyz"], turned([0, 1, 0], 1)), [0, 1, 0])


def calibrate(directory, lines, *args):
    return json.loads(run("calibrate_prior", f"--matches={directory}", f"--lines={lines}", "--threads=2",
                          "--json=-", *args))


def simulated(work):
    worst = {"normal": [], "vertical": []}
    beyond = 0
    for seed in range(1, SEEDS + 1):
        directory = os.path.join(work, f"s{seed}")
        run("simulate", f"--output={directory}", "--pairs=60", "--motion=planar", "--rotation_deg=2",
            "--inter_share=0.5", f"--seed={seed}")
        misalign(directory)
        report = calibrate(directory, "normal,gravity")
        plane, gravity = report["plane"], report["gravity"]
        errors = {"normal": (angle_deg(plane["normal"], [0, 1, 0]),
                             math.hypot(plane["tilt_sd_deg"], plane["roll_sd_deg"])),
                  "vertical": (tilt_error(gravity), math.sqrt(2) * gravity["tilt_sd_deg"])}
        for name, (error, sd) in errors.items():
            worst[name].append((error, sd))
        beyond += any(error > 3 * sd for error, sd in errors.values())
    for name, errors in worst.items():
        rms = math.sqrt(sum(e * e for e, _ in errors) / SEEDS)
        sd = math.sqrt(sum(s * s for _, s in errors) / SEEDS)
        print(f"simulated, {name:8} turned by 2 deg: RMS error {rms:.4f} deg, stated {sd:.4f} deg, {SEEDS} clips")
    return beyond <= SEEDS // 10


def real(work, data):
    poses = os.path.join(work, "poses")
    os.mkdir(poses)
    with open(os.path.join(data, "kitti_odometry", "poses", "00.txt"), encoding="utf-8") as file:
        with open(os.path.join(poses, "00.txt"), "w", encoding="utf-8") as head:
            head.writelines(file.readlines()[:301])
    driven = os.path.join(work, "driven")
    run("simulate", f"--output={driven}", f"--poses={poses}", "--inter_share=0.5")
    misalign(driven)
    report = calibrate(driven, "normal,gravity")
    print(f"KITTI 00, frames 0-300, simulated points: {json.dumps(report['gravity'])}")
    if report["gravity"]["level"] != "none":
        print(f"  vertical off by {tilt_error(report['gravity']):.4f} deg")
    print(f"  plane {json.dumps(report['plane'])}")
    for clip in ("kitti_stereo_06", "kitti_tracks_00"):
        before = os.path.join(data, clip)
        after = os.path.join(work, clip)
        plane = calibrate(before, "normal,axis", f"--output={after}")["plane"]
        print(f"{clip}: normal moved by {plane['change_deg']:.3f} deg, sd {plane['tilt_sd_deg']:.3f}, {plane['level']}")
        for directory, prior in ((before, "body"), (after, "file")):
            results = json.loads(run("compare", f"--matches={directory}", f"--prior={prior}",
                                     "--solvers=3pt-approx,3pt", "--threads=2", "--json=-"))["results"]
            for entry in results:
                raw = entry["raw"]
                print(f"  --prior={prior} {entry['solver']:10} raw medians: rotation "
                      f"{raw['rotation_deg']['median']:.4f} deg, direction "
                      f"{raw['translation_dir_deg']['median']:.3f} deg")


def main():
    if len(sys.argv) > 1:
        print(__doc__)
        sys.exit(0 if sys.argv[1] in ("-h", "--help") else 2)
    with tempfile.TemporaryDirectory() as work:
        good = simulated(work)
        data = os.environ.get("RIGEL_REAL_DATA")
        if data:
            real(work, data)
        else:
            print("RIGEL_REAL_DATA is not set: no real match files")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
