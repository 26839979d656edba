"""What the commands that measure have in common: match files, the programs, geometry, the bound.

Used by the commands of CONTRIBUTING.md, "Measure". Names of flags and of members of JSON that a
program may not have yet are here and nowhere else. Python's standard library only.

Matrices are lists of rows. A motion is (R, t), X_2 = R X_1 + t in the body frame. Its covariance is
that of (d, e) in R <- Exp(d) R, t <- t + e.
"""
import argparse
import glob
import gzip
import hashlib
import json
import math
import os
import subprocess
import sys
import tempfile

import camera_models

# Medians of chi2 with that many degrees of freedom.
CHI2_MEDIAN = {2: 1.3863, 3: 2.3660, 5: 4.3515, 6: 5.3481}
DEFAULT_COLUMNS = "i u v j u2 v2 score".split()
PRIOR_KEYWORDS = ("gravity1", "gravity2", "gravity_sigma_deg", "axis", "axis_sigma_deg", "normal",
                  "normal_sigma_deg")


class Failure(Exception):
    """A program failed, or a file is not what it should be. The text is the message."""


# --- Command line -------------------------------------------------------------------------------

def make_parser(documentation, pairs=None):
    """A parser with the flags that all commands have; the documentation is their --help."""
    parser = argparse.ArgumentParser(description=documentation,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    build = os.environ.get("RIGEL_BUILD_DIR", "build/release")
    parser.add_argument("--bin", metavar="DIR", default=os.path.join(build, "bin"),
                        help="directory of the programs; by default $RIGEL_BUILD_DIR/bin or "
                        "build/release/bin")
    parser.add_argument("--seed", type=int, default=1, help="seed of all random numbers (1)")
    parser.add_argument("--threads", type=int, default=1, help="threads of the programs (1)")
    parser.add_argument("--json", metavar="FILE", help="write the figures to this file, too")
    if pairs:
        parser.add_argument("--pairs", type=int, default=pairs,
                            help="frame pairs of each setting (%d)" % pairs)
    return parser


def run_main(main):
    """Runs main() and turns a Failure into one line on stderr and exit code 1."""
    try:
        main()
    except Failure as failure:
        print("%s: %s" % (os.path.basename(sys.argv[0]), failure), file=sys.stderr)
        sys.exit(1)


def numbers(text):
    """The numbers of a comma separated flag."""
    return [float(word) for word in text.split(",")]


def finish(programs, arguments, **members):
    """Checks that the programs are still those of the start, and writes the options, what the
    programs were and the figures to --json, if it is there."""
    if programs.fingerprints() != programs.at_start:
        raise Failure("the programs were replaced during the run: the figures are of no one build")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump({"options": vars(arguments), "sha256": programs.at_start, **members}, file,
                      indent=1)
            file.write("\n")


def print_table(head, rows):
    """Prints rows of texts and numbers below a head; None is "-". Numbers have three digits."""
    def text(value):
        if value is None:
            return "-"
        return "%.3g" % value if isinstance(value, float) else str(value)
    cells = [list(head)] + [[text(value) for value in row] for row in rows]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    for number, row in enumerate(cells):
        print("  ".join(cell.ljust(width) if k == 0 else cell.rjust(width)
                        for k, (cell, width) in enumerate(zip(row, widths))).rstrip())
        if number == 0:
            print("-" * (sum(widths) + 2 * len(widths) - 2))
    sys.stdout.flush()


# --- Programs -----------------------------------------------------------------------------------

class Programs:
    """The programs of one directory."""

    def __init__(self, directory, seed=1, threads=1):
        self.directory, self.seed, self.threads = directory, seed, threads
        self.helps = {}
        self.at_start = self.fingerprints()

    def fingerprints(self):
        """{program: SHA-256}: a build in the same directory may go on during a long run."""
        found = {}
        for name in ("rigel_compare", "rigel_estimate", "rigel_simulate"):
            path = os.path.join(self.directory, name)
            try:
                with open(path, "rb") as file:
                    found[name] = hashlib.sha256(file.read()).hexdigest()
            except OSError as error:
                raise Failure("cannot read %s: %s" % (path, error.strerror)) from error
        return found

    def has_flag(self, name, flag):
        """Whether --help of a program lists the flag."""
        if name not in self.helps:
            self.helps[name] = self.run(name, ["--help"])
        return "\n  --%s" % flag in self.helps[name]

    def run(self, name, flags, may_miss=False):
        """Runs a program and returns its stdout. With `may_miss` exit code 1 is allowed: some file
        could not be read, or no pair has a motion."""
        command = [os.path.join(self.directory, name)] + flags
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        except OSError as error:
            raise Failure("cannot run %s: %s" % (command[0], error.strerror)) from error
        if done.returncode not in ((0, 1) if may_miss else (0,)):
            raise Failure("%s ended with code %d: %s" % (" ".join(command), done.returncode,
                                                         done.stderr.strip()[-500:]))
        return done.stdout

    def run_json(self, name, flags):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "out.json")
            self.run(name, flags + ["--json=" + path, "--seed=%d" % self.seed,
                                    "--threads=%d" % self.threads], may_miss=True)
            if not os.path.exists(path):
                raise Failure("%s wrote no JSON; flags: %s" % (name, " ".join(flags)))
            with open(path, encoding="utf-8") as file:
                return json.load(file)

    def calibration_error(self, name, sigma_deg, sigma_m):
        """Flags that state the error of the calibration; none if the program does not take them."""
        if not self.has_flag(name, "calibration_sigma_deg"):
            return []
        return ["--calibration_sigma_deg=%g" % sigma_deg, "--calibration_sigma_m=%g" % sigma_m]

    def unknown_noise(self, name):
        """Flags with which a stated noise is not used. Newer programs estimate it unless told."""
        return ["--estimate_noise"] if self.has_flag(name, "estimate_noise") else []

    def estimate(self, matches, flags=()):
        """{name of the file: result} of rigel_estimate with unknown noise, and the whole report."""
        report = self.run_json("rigel_estimate", ["--matches=" + matches, "--no_times", *flags] +
                               self.unknown_noise("rigel_estimate"))
        return {os.path.basename(pair["pair"]): pair for pair in report["pairs"]}, report

    def compare(self, matches, flags=(), times=False):
        """The report of rigel_compare, auto and unknown noise, with the results of each pair."""
        return self.run_json("rigel_compare", ["--matches=" + matches, "--solvers=auto",
                                               "--per_pair", *([] if times else ["--no_times"]),
                                               *flags] +
                             self.unknown_noise("rigel_compare"))

    def simulate(self, output, rig, pairs, **settings):
        """Match files of rigel_simulate. The rig is `scene`, `sceneN` (N cameras), `ringN`, or a
        file of a rig, which drives through the street. Settings are flags of rigel_simulate."""
        flags = {"output": output, "seed": self.seed, "threads": self.threads, "pairs": pairs}
        if rig.startswith("ring"):
            flags.update(ring="true", num_cameras=rig[4:] or 6)
        elif os.path.exists(rig):
            if not self.has_flag("rigel_simulate", "scene"):
                raise Failure("this rigel_simulate has no street; see --rigs")
            flags.update(scene="street", rig=rig, motion="car")
        elif rig.startswith("scene"):
            flags.update(num_cameras=rig[5:] or 2)
        else:
            raise Failure("%s: expected scene, sceneN, ringN or the file of a rig" % rig)
        flags.update(settings)
        if "poses" in flags:
            for name in ("pairs", "motion", "rotation_deg"):
                flags.pop(name, None)
        self.run("rigel_simulate", ["--%s=%s" % item for item in flags.items()])


def rig_files(names, directory):
    """The rigs of a comma separated list: those that are files of the directory by their path."""
    rigs = []
    for name in names.split(","):
        path = os.path.join(directory or "", name if name.endswith(".json") else name + ".json")
        rigs.append(path if os.path.exists(path) else name)
    return rigs


def add_rig_dir_flag(parser):
    data = os.environ.get("RIGEL_REAL_DATA")
    parser.add_argument("--rig_dir", default=os.path.join(data, "rigs") if data else "",
                        help="directory of rigs; by default $RIGEL_REAL_DATA/rigs")


def count_poses(path):
    """The number of pairs of consecutive poses of a KITTI pose file, or of those of a directory."""
    paths = glob.glob(os.path.join(glob.escape(path), "*.txt")) if os.path.isdir(path) else [path]
    count = 0
    for name in paths:
        with open(name, encoding="ascii") as file:
            count += max(0, sum(1 for line in file if line.strip()) - 1)
    return count


def write_stereo_rig(directory):
    """The file of a stereo rig as KITTI's: 1241 x 376 pixels, focal length 718, 0.54 m apart,
    1.65 m above the ground. The body is the left camera."""
    camera = {"model": "pinhole", "parameters": [718, 718, 620, 188], "width": 1241, "height": 376,
              "q": [1, 0, 0, 0]}
    path = os.path.join(directory, "stereo.json")
    with open(path, "w", encoding="ascii") as file:
        json.dump({"format": "rigel-rig 1", "name": "stereo", "ground_m": 1.65, "down": [0, 1, 0],
                   "forward": [0, 0, 1], "cameras": [{**camera, "s": [0, 0, 0]},
                                                     {**camera, "s": [0.54, 0, 0]}]}, file)
    return path


def rig_name(rig):
    return os.path.splitext(os.path.basename(rig))[0]


# --- Match files --------------------------------------------------------------------------------

class MatchFile:
    """A match file: header lines without the number of matches, and rows of words."""

    def __init__(self, path):
        opener = gzip.open if path.endswith(".gz") else open
        self.name = os.path.basename(path).removesuffix(".gz")
        self.header, self.rows = [], []
        in_rows = False
        with opener(path, "rt", encoding="utf-8-sig") as file:
            for line in file:
                words = line.split()
                if not words or words[0].startswith("#"):
                    continue
                if in_rows:
                    self.rows.append(words)
                elif words[0] == "matches":
                    in_rows = True
                else:
                    self.header.append(words)
        if not in_rows:
            raise Failure("%s: no line 'matches'" % path)
        self.columns = self.line("columns") or DEFAULT_COLUMNS

    def line(self, keyword):
        """The words after a keyword of the header, or None."""
        return next((words[1:] for words in self.header if words[0] == keyword), None)

    def set_line(self, keyword, text):
        """Replaces a line of the header, or removes it if the text is None."""
        self.header = [words for words in self.header if words[0] != keyword]
        if text is not None:
            self.header.append([keyword] + text.split())

    def remove_priors(self):
        self.header = [words for words in self.header if words[0] not in PRIOR_KEYWORDS]

    def column(self, name):
        """The index of a column, or None."""
        return self.columns.index(name) if name in self.columns else None

    def cameras(self):
        return [Camera(words) for words in self.header if words[0] == "camera"]

    def truth(self):
        """The true motion (R, t), or None."""
        words = self.line("truth")
        if words is None:
            return None
        values = [float(word) for word in words]
        return motion_of(values[:4], values[4:])

    def matches(self):
        """Rows as (i, u, v, j, u2, v2)."""
        i, u, v, j, u2, v2 = (self.column(name) for name in ("i", "u", "v", "j", "u2", "v2"))
        return [(int(row[i]), float(row[u]), float(row[v]),
                 int(row[j]), float(row[u2]), float(row[v2])) for row in self.rows]

    def inliers(self):
        """The matches that are right, of a file without noise: as the file says, else those that
        agree with its motion."""
        column, cameras, truth = self.column("inlier"), self.cameras(), self.truth()
        return [match for row, match in zip(self.rows, self.matches())
                if (agrees(match, cameras, truth) if column is None else int(row[column]))]

    def write(self, directory, rows=None):
        """Writes the file below its name; `rows` replace its own."""
        rows = self.rows if rows is None else rows
        os.makedirs(directory, exist_ok=True)
        with open(os.path.join(directory, self.name), "w", encoding="utf-8") as file:
            for words in self.header:
                file.write(" ".join(words) + "\n")
            file.write("matches %d\n" % len(rows))
            for row in rows:
                file.write(" ".join(row) + "\n")


def match_files(directory):
    """Paths of the match files of a directory, in the order of their names."""
    paths = sorted(glob.glob(os.path.join(glob.escape(directory), "*.matches")) +
                   glob.glob(os.path.join(glob.escape(directory), "*.matches.gz")))
    if not paths:
        raise Failure("%s: no match files" % directory)
    return paths


def apply_prior(directory, prior):
    """The flag --prior for the programs. `none` takes the lines of priors out of the files."""
    if prior != "none":
        return ["--prior=" + prior]
    for path in match_files(directory):
        file = MatchFile(path)
        file.remove_priors()
        file.write(directory)
    return []


def add_prior_flag(parser):
    parser.add_argument("--prior", choices=("none", "body", "file"), default="none",
                        help="prior of the solvers: none (lines of priors are taken out of the "
                        "files), body, or file, which is exact in simulated files (none)")


# --- Geometry -----------------------------------------------------------------------------------

def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def norm(a):
    return math.sqrt(dot(a, a))


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def scaled(a, factor):
    return [factor * x for x in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def apply(matrix, v):
    return [dot(row, v) for row in matrix]


def transposed(a):
    return [list(column) for column in zip(*a)]


def times(a, b):
    columns = transposed(b)
    return [[dot(row, column) for column in columns] for row in a]


def matrix_of(q):
    """The rotation of a quaternion w x y z."""
    w, x, y, z = scaled(q, 1 / norm(q))
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def motion_of(q, t):
    return matrix_of(q), list(t)


def rotation_vector(r):
    """Log of a rotation of less than 180 degrees."""
    vee = [(r[2][1] - r[1][2]) / 2, (r[0][2] - r[2][0]) / 2, (r[1][0] - r[0][1]) / 2]
    sine = norm(vee)
    angle = math.atan2(sine, (r[0][0] + r[1][1] + r[2][2] - 1) / 2)
    return scaled(vee, angle / sine) if sine > 1e-12 else vee


def angle_deg(a, b):
    return math.degrees(math.atan2(norm(cross(a, b)), dot(a, b)))


def block(matrix, first, size=3):
    return [row[first:first + size] for row in matrix[first:first + size]]


def solve(matrix, right):
    """x of matrix x = right for a symmetric positive matrix, by Cholesky; None if it is not one."""
    n = len(right)
    lower = [[0.0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            value = matrix[i][j] - dot(lower[i][:j], lower[j][:j])
            if i == j:
                if not value > 0:
                    return None
                lower[i][i] = math.sqrt(value)
            else:
                lower[i][j] = value / lower[j][j]
    x = list(right)
    for i in range(n):
        x[i] = (x[i] - dot(lower[i][:i], x[:i])) / lower[i][i]
    for i in reversed(range(n)):
        x[i] = (x[i] - sum(lower[k][i] * x[k] for k in range(i + 1, n))) / lower[i][i]
    return x


def inverse(matrix):
    """Inverse of a symmetric positive matrix; None if it is not one."""
    n = len(matrix)
    columns = [solve(matrix, [float(k == j) for k in range(n)]) for j in range(n)]
    return None if columns[0] is None else transposed(columns)


def nees(error, covariance):
    """error' covariance^-1 error, or None if the covariance is not positive."""
    x = solve(covariance, error)
    return None if x is None else dot(error, x)


def direction_sd(t, covariance):
    """Standard deviation of the direction of t in radians: that of its part perpendicular to t."""
    unit = scaled(t, 1 / norm(t))
    trace = sum(covariance[k][k] for k in range(3)) - dot(unit, apply(covariance, unit))
    return math.sqrt(max(trace, 0)) / norm(t)


# --- Statistics ---------------------------------------------------------------------------------

def random_sign(generator):
    return 1 if generator.random() < 0.5 else -1


def median(values):
    values = sorted(values)
    n = len(values)
    return None if n == 0 else (values[(n - 1) // 2] + values[n // 2]) / 2


def mean(values):
    values = [value for value in values if value is not None]
    return sum(values) / len(values) if values else None


def rms(values):
    square = mean([value * value for value in values])
    return None if square is None else math.sqrt(square)


# --- Results of the programs --------------------------------------------------------------------

def refined_motion(pair):
    """The refined (R, t) of a result of rigel_estimate, or None."""
    motion = pair.get("refined")
    return motion_of(motion["q_wxyz"], motion["t"]) if motion else None


def rotation_difference(motion, other):
    """d of R = Exp(d) R_other."""
    return rotation_vector(times(motion[0], transposed(other[0])))


def rotation_error_deg(motion, truth):
    return math.degrees(norm(rotation_difference(motion, truth)))


def difference_covariance(one, other, calibration=None):
    """The covariance of the difference of the rotations of two results of rigel_estimate whose
    noise is independent, 3 x 3, or None. `calibration`: the error of the rig's calibration, degrees
    and metres per axis. It is the same in both, so it moves the difference by the difference of
    what it does to each: Ca + Cb + (Sa - Sb) E (Sa - Sb)', S the calibration_gain, and Ca and Cb
    without the calibration_covariance."""
    covariances = [rotation_covariance(pair) for pair in (one, other)]
    if None in covariances:
        return None
    total = [add(a, b) for a, b in zip(*covariances)]
    gains = [pair.get("calibration_gain") for pair in (one, other)]
    if calibration is None or None in gains:
        return total
    for pair in (one, other):
        part = block(pair["calibration_covariance"], 0)
        total = [[x - y for x, y in zip(row, of_part)] for row, of_part in zip(total, part)]
    sigmas = 3 * [math.radians(calibration[0])] + 3 * [calibration[1]]
    for of_a, of_b in zip(*gains):
        for k, sigma in enumerate(sigmas):
            moved = [sigma * (of_a[i][k] - of_b[i][k]) for i in range(3)]
            total = [[x + moved[i] * moved[j] for j, x in enumerate(row)]
                     for i, row in enumerate(total)]
    return total


def difference_nees(one, other, calibration=None):
    """NEES of that difference, or None. Divide by CHI2_MEDIAN[3]: its median is then 1."""
    covariance = difference_covariance(one, other, calibration)
    motions = [refined_motion(pair) for pair in (one, other)]
    if covariance is None or None in motions:
        return None
    return nees(rotation_difference(*motions), covariance)


def rotation_covariance(pair):
    """3 x 3, or None where the rotation or its covariance is not stated as known."""
    if not pair.get("rotation_observable") or not pair.get("covariance_valid", True):
        return None
    return block(pair["covariance"], 0) if "covariance" in pair else None


def translation_direction_sd_deg(pair):
    """The stated standard deviation of the direction of t, from the covariance where it is not
    stated as known; None without a covariance."""
    if "translation_dir_sd_deg" in pair:
        return pair["translation_dir_sd_deg"]
    if "covariance" not in pair or norm(pair["refined"]["t"]) == 0:
        return None
    return math.degrees(direction_sd(pair["refined"]["t"], block(pair["covariance"], 3)))


def rig_direction(pair):
    """The direction of the rig's own motion and its standard deviation in degrees, or None."""
    direction, sd = pair.get("rig_direction"), pair.get("rig_direction_sd_deg")
    return None if direction is None or sd is None else (direction, sd)


def rig_centre(cameras):
    return scaled([sum(x) for x in zip(*(camera.position for camera in cameras))], 1 / len(cameras))


def rig_motion(motion, cameras):
    """The motion of the rig's centre, R c + t - c."""
    centre = rig_centre(cameras)
    return add(minus(apply(motion[0], centre), centre), motion[1])


def compare_figures(report):
    """Of rigel_compare's report: errors over bounds, the NEES and what else a table shows."""
    result = report["results"][0]
    pairs, failures = result["pairs"], result["failures"]
    figures = {"pairs": pairs, "failures": failures,
               "unobservable": pairs - failures - result.get("direction_pairs", 0)}
    refined, bound = result.get("refined", {}), result.get("bound", {})
    for name, member in (("rotation", "rotation_deg"), ("direction", "translation_dir_deg"),
                         ("rig_direction", "rig_direction_deg")):
        error, limit = (s.get(member, {}).get("rms") for s in (refined, bound))
        figures[name + "_rms_deg"], figures[name + "_bound_deg"] = error, limit
        figures[name] = error / limit if error is not None and limit else None
    figures["bound_scale"] = bound.get("scale", {}).get("rms")
    figures["nees_mean"] = result.get("nees", {}).get("ratio")
    stated = [pair["solvers"]["auto"].get("nees") for pair in report.get("pair_results", [])]
    figures["nees_median"] = median([n["value"] / n["degrees_of_freedom"] for n in stated if n])
    return figures


# --- Cameras and the bound ----------------------------------------------------------------------

class Camera:
    """Any camera, from the words of its line: its rays and how they change with the pixel."""

    def __init__(self, words):
        if words[2] not in camera_models.PROJECT:
            raise Failure("camera %s is a %s, which is not known here" % (words[1], words[2]))
        self.model = words[2]
        values = [float(word) for word in words[3:]]
        self.parameters, rest = values[:-9], values[-9:]
        self.width, self.height = rest[:2]
        self.rotation = matrix_of(rest[2:6])
        self.position = rest[6:9]

    def pixel_of(self, x):
        """The pixel of a point of the camera frame."""
        return camera_models.PROJECT[self.model](x, *self.parameters)

    def steps_by_pixel(self, x):
        """Two unit vectors across the ray x, and the derivatives, 2 x 2, of steps along them by the
        pixel."""
        step = 1e-6
        least = min(range(3), key=lambda k: abs(x[k]))
        first = cross(x, [float(k == least) for k in range(3)])
        first = scaled(first, 1 / norm(first))
        across = [first, cross(x, first)]
        (a, c), (b, d) = [scaled(minus(self.pixel_of(add(x, scaled(e, step))),
                                       self.pixel_of(minus(x, scaled(e, step)))), 1 / (2 * step))
                          for e in across]
        determinant = a * d - b * c
        return across, [[d / determinant, -b / determinant], [-c / determinant, a / determinant]]

    def own_ray(self, u, v):
        """The ray in the camera frame, by Newton's method from that of a lens without distortion."""
        if self.model == "pinhole":
            fx, fy, cx, cy = self.parameters
            return [(u - cx) / fx, (v - cy) / fy, 1.0]
        corner = self.pixel_of([0.0, 0.0, 1.0])
        off = [u - corner[0], v - corner[1]]
        per_radian = abs(self.pixel_of([1e-3, 0.0, 1.0])[0] - corner[0]) / 1e-3
        angle, length = norm(off) / per_radian, max(norm(off), 1e-12)
        if "fisheye" not in self.model and self.model not in ("omni", "double_sphere", "eucm"):
            angle = math.atan(angle)
        x = [math.sin(angle) * off[0] / length, math.sin(angle) * off[1] / length, math.cos(angle)]
        for _ in range(20):
            miss = minus([u, v], self.pixel_of(x))
            across, by_pixel = self.steps_by_pixel(x)
            steps = apply(by_pixel, miss)
            x = add(x, add(scaled(across[0], steps[0]), scaled(across[1], steps[1])))
            x = scaled(x, 1 / norm(x))
            if norm(miss) < 1e-7:
                break
        return x

    def ray(self, u, v):
        return apply(self.rotation, self.own_ray(u, v))

    def ray_by_pixel(self, u, v):
        """Derivatives of ray() by u and v."""
        if self.model == "pinhole":
            columns = transposed(self.rotation)
            return scaled(columns[0], 1 / self.parameters[0]), scaled(columns[1],
                                                                      1 / self.parameters[1])
        across, by_pixel = self.steps_by_pixel(self.own_ray(u, v))
        return [apply(self.rotation, add(scaled(across[0], by_pixel[0][k]),
                                         scaled(across[1], by_pixel[1][k]))) for k in range(2)]

    def project(self, point):
        """The pixel of a point of the body frame, or None behind a lens that sees less than 90
        degrees."""
        x = apply(transposed(self.rotation), minus(point, self.position))
        wide = "fisheye" in self.model or self.model in ("fov", "omni", "double_sphere", "eucm")
        return self.pixel_of(x) if wide or x[2] > 0.1 else None

    def sees(self, pixel):
        return pixel is not None and 0 <= pixel[0] < self.width and 0 <= pixel[1] < self.height


def constraint(match, cameras, motion, sigmas):
    """The epipolar constraint of a match, its derivative by (d, e), and its standard deviation.
    `sigmas` are the noise of the cameras in pixels."""
    i, u, v, j, u2, v2 = match
    first, second = cameras[i], cameras[j]
    rotation, t = motion
    ray = apply(rotation, first.ray(u, v))
    other = second.ray(u2, v2)
    arm = apply(rotation, first.position)
    baseline = minus(add(arm, t), second.position)
    normal = cross(ray, other)  # C = baseline . (ray x other)
    value = dot(baseline, normal)
    # Of C by the two rays; a turn d moves both the ray and the arm.
    by_ray, by_other = cross(other, baseline), cross(baseline, ray)
    derivative = add(cross(ray, by_ray), cross(arm, normal)) + normal
    variance = 0.0
    for direction in first.ray_by_pixel(u, v):
        variance += (sigmas[i] * dot(by_ray, apply(rotation, direction))) ** 2
    for direction in second.ray_by_pixel(u2, v2):
        variance += (sigmas[j] * dot(by_other, direction)) ** 2
    return value, derivative, math.sqrt(variance)


def bound(matches, cameras, motion, sigmas, length_sd=1.0):
    """The Cramer-Rao covariance, 6 x 6, of the motion from matches at their exact pixels. What the
    matches do not say of the length of the rig's motion is known to exp(+-length_sd)."""
    information = [[0.0] * 6 for _ in range(6)]

    def add_row(row):
        for k in range(6):
            for m in range(6):
                information[k][m] += row[k] * row[m]

    for match in matches:
        _, derivative, sd = constraint(match, cameras, motion, sigmas)
        if sd > 0:
            add_row(scaled(derivative, 1 / sd))
    along = rig_motion(motion, cameras)
    if norm(along) > 0:
        by_length = scaled(along, 1 / dot(along, along))
        arm = apply(motion[0], rig_centre(cameras))
        add_row(scaled(cross(arm, by_length) + by_length, 1 / length_sd))
    return inverse(information)


def rotation_bound(matches, cameras, rotation, sigma_px):
    """The Cramer-Rao covariance, 3 x 3, of the rotation of a rig that turns and does not move, from
    intra-camera matches at their exact pixels: both components of each pixel of view 2 say it."""
    information = [[0.0] * 3 for _ in range(3)]
    for i, u, v, _, _, _ in matches:
        camera = cameras[i]

        def pixel_of(ray, camera=camera):
            return camera.project(add(camera.position, ray))

        def derivatives(rays, ray, pixel_of=pixel_of):
            """Central differences of the pixel by steps along rays that are perpendicular to it."""
            step = 1e-6
            columns = [minus(pixel_of(add(ray, scaled(along, step))),
                             pixel_of(minus(ray, scaled(along, step)))) for along in rays]
            return transposed([scaled(column, 1 / (2 * step)) for column in columns])

        ray = apply(rotation, camera.ray(u, v))
        if pixel_of(ray) is None:
            continue
        by_first = derivatives([apply(rotation, d) for d in camera.ray_by_pixel(u, v)], ray)
        by_turn = derivatives([cross(axis, ray) for axis in ([1, 0, 0], [0, 1, 0], [0, 0, 1])], ray)
        variance = times(by_first, transposed(by_first))
        for k in range(2):
            variance[k][k] += 1.0
        weight = inverse(variance)
        term = times(transposed(by_turn), times(weight, by_turn))
        information = [add(a, scaled(b, 1 / sigma_px ** 2)) for a, b in zip(information, term)]
    return inverse(information)


def agrees(match, cameras, motion):
    """Whether a match without noise agrees with the motion: to 1e-5 pixels, since files round."""
    value, _, sd = constraint(match, cameras, motion, [1.0] * len(cameras))
    return abs(value) <= 1e-5 * sd
