#!/usr/bin/env python3
"""Drift of rigel_estimate's trajectory against that of the stereo odometry in the same files.

    test/trajectory_study.py [DIRECTORY]

The directory is a clip's, by default $RIGEL_REAL_DATA/kitti_stereo_06 (exit code 77 without it).
The build is $RIGEL_BUILD_DIR, by default build/release. Chains the `stereo_odometry` comments and
the `truth` lines of its match files by its own code, has rigel_estimate write the refined
trajectory (KITTI and TUM), reads both as evo does, and compares the errors of the motion over the
whole clip, X_last = R X_first + t: of t over the length of the path, and of R. Exit code 0 if the
refined one's are at most 1.2 times those of the stereo odometry; 1 if not, or if something is wrong. Printed, not judged: the same of the inverse motion, the last
pose in the first frame, where the truth's error at the first frame counts by the whole length.
Python's standard library only.
"""
import math
import os
import subprocess
import sys
import tempfile

MAX_RATIO = 1.2


def fail(message):
    print(f"trajectory_study: {message}", file=sys.stderr)
    sys.exit(1)


def rotation(w, x, y, z):
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transposed(a):
    return [[a[j][i] for j in range(3)] for i in range(3)]


def apply(a, v):
    return [sum(a[i][k] * v[k] for k in range(3)) for i in range(3)]


def angle_deg(a):
    vee = [a[2][1] - a[1][2], a[0][2] - a[2][0], a[1][0] - a[0][1]]
    return math.degrees(math.atan2(math.sqrt(sum(v * v for v in vee)), sum(a[i][i] for i in range(3)) - 1))


def chain(motions):
    """Poses world_from_body of motions (R, t), X_2 = R X_1 + t."""
    poses = [([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]], [0.0, 0.0, 0.0])]
    for r, t in motions:
        world_r, world_t = poses[-1]
        inverse_r = transposed(r)
        inverse_t = [-v for v in apply(inverse_r, t)]
        step = apply(world_r, inverse_t)
        poses.append((times(world_r, inverse_r), [world_t[k] + step[k] for k in range(3)]))
    return poses


def read_motions(path):
    """The motions of the truth line and of the stereo_odometry comment of a match file."""
    motions = {}
    with open(path, encoding="utf-8-sig") as file:
        for line in file:
            words = line.replace("#", " ").split()
            if not words or words[0] == "matches":
                break
            if words[0] in ("truth", "stereo_odometry") and len(words) == 8:
                numbers = [float(w) for w in words[1:]]
                motions[words[0]] = (rotation(*numbers[:4]), numbers[4:])
    for name in ("truth", "stereo_odometry"):
        if name not in motions:
            fail(f"{path}: no line '{name} QW QX QY QZ TX TY TZ' in its header")
    return motions


def rows(path, columns):
    """As evo: blanks part the columns, # starts a comment, each row has as many."""
    result = []
    with open(path, encoding="utf-8-sig") as file:
        for number, line in enumerate(file, 1):
            if line.startswith("#"):
                continue
            words = line.rstrip("\n").split(" ")
            if len(words) != columns:
                fail(f"{path}:{number}: {len(words)} columns, expected {columns}")
            result.append([float(w) for w in words])
    return result


def read_kitti(path):
    poses = []
    for number, m in enumerate(rows(path, 12), 1):
        r = [m[0:3], m[4:7], m[8:11]]
        product = times(transposed(r), r)
        if max(abs(product[i][j] - (i == j)) for i in range(3) for j in range(3)) > 1e-12:
            fail(f"{path}: pose {number} is no rotation")
        poses.append((r, [m[3], m[7], m[11]]))
    return poses


def read_tum(path):
    table = rows(path, 8)
    if any(b[0] <= a[0] for a, b in zip(table, table[1:])):
        fail(f"{path}: time stamps do not ascend")
    return [(rotation(m[7], m[4], m[5], m[6]), m[1:4]) for m in table]


def end_error(truth, poses):
    """Of X_last = R X_first + t: percent of the path, degrees; of its inverse: percent; path."""
    path = sum(math.dist(a[1], b[1]) for a, b in zip(truth, truth[1:]))
    backward = [apply(transposed(p[-1][0]), p[-1][1]) for p in (truth, poses)]
    return (100 * math.dist(*backward) / path,
            angle_deg(times(transposed(truth[-1][0]), poses[-1][0])),
            100 * math.dist(truth[-1][1], poses[-1][1]) / path, path)


def main():
    if sys.argv[1:] in (["-h"], ["--help"]):
        print(__doc__)
        sys.exit(0)
    if len(sys.argv) > 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    if len(sys.argv) == 1 and not os.environ.get("RIGEL_REAL_DATA"):
        print("trajectory_study: RIGEL_REAL_DATA is not set: no real match files", file=sys.stderr)
        sys.exit(77)
    directory = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.environ["RIGEL_REAL_DATA"],
                                                                   "kitti_stereo_06")
    build = os.environ.get("RIGEL_BUILD_DIR") or os.path.join(
        os.path.dirname(os.path.abspath(__file__)), "..", "build", "release")
    files = sorted(os.path.join(directory, f) for f in os.listdir(directory) if f.endswith(".matches"))
    motions = [read_motions(f) for f in files]
    truth = chain([m["truth"] for m in motions])
    stereo = chain([m["stereo_odometry"] for m in motions])
    with tempfile.TemporaryDirectory() as work:
        kitti, tum = os.path.join(work, "kitti.txt"), os.path.join(work, "tum.txt")
        subprocess.run([os.path.join(build, "bin", "rigel_estimate"), f"--matches={directory}",
                        "--prior=body", "--solver=4pt-axis", "--threads=2", f"--kitti_trajectory={kitti}",
                        f"--tum_trajectory={tum}", "--truth_trajectory"], check=True, stdout=subprocess.DEVNULL)
        refined = read_kitti(kitti)
        if len(refined) != len(truth):
            fail(f"{len(refined)} poses, expected {len(truth)}")
        for a, b in zip(refined + truth, read_tum(tum) + read_kitti(os.path.join(work, "kitti_truth.txt"))):
            if math.dist(a[1], b[1]) > 1e-9 or angle_deg(times(transposed(a[0]), b[0])) > 1e-6:
                fail("the files do not agree with each other")
    errors = {"stereo odometry": end_error(truth, stereo), "refined": end_error(truth, refined)}
    print(f"end point after {len(files)} pairs, {errors['refined'][3]:.1f} m")
    for name, (percent, degrees, inverse, _) in errors.items():
        print(f"  {name:16} {percent:.3f} %  {degrees:.3f} deg   last pose in the first frame {inverse:.3f} %")
    ratios = [errors["refined"][k] / errors["stereo odometry"][k] for k in range(3)]
    print(f"  {'ratio':16} {ratios[0]:.3f}    {ratios[1]:.3f}       (at most {MAX_RATIO})   {ratios[2]:.3f}")
    sys.exit(0 if max(ratios[:2]) <= MAX_RATIO else 1)


if __name__ == "__main__":
    main()
