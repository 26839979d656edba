"""Trajectories in the formats of KITTI and TUM, drawn from above."""
import math
import re
import sys

from rigel_files import Bad
from rigel_plot_style import BLACK, BLUE, RED, new_figure


# Forward has to be this far from the line of down, or it says too little of up on the page:
# 30 degrees.
COS_OF_LEAST_ANGLE, SIN_OF_LEAST_ANGLE = 0.866, 0.5
# Cosine: an axis that is at least 60 degrees from down is across it. Of three axes one always is.
ACROSS = 0.5
# From 1, the length of an axis: a direction that is printed as +x was not turned by more.
ROUNDING = 1e-9


def cross(a, b):
    return tuple(a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def direction(text):
    """A unit vector: +x, -z, y or three numbers. None if it is neither."""
    axis = re.fullmatch(r"([+-]?)([xyzXYZ])", text)
    if axis:
        sign = -1.0 if axis[1] == "-" else 1.0
        return tuple(sign if k == "xyz".index(axis[2].lower()) else 0.0 for k in range(3))
    try:
        v = [float(w) for w in text.split(",")]
    except ValueError:
        return None
    size = math.hypot(*v)
    return tuple(x / size for x in v) if len(v) == 3 and 0 < size < math.inf else None


def direction_text(v):
    """How an axis of the figure is labelled: -y, or numbers."""
    for k in range(3):
        if abs(v[k]) > 1 - ROUNDING:
            return ("-" if v[k] < 0 else "+") + "xyz"[k]
    return "(" + ", ".join(f"{x:.3g}" for x in v) + ")"


def read_trajectory(path):
    """Positions and directions of the body's axes (rows) of a file in KITTI's or TUM's format, and
    the (down, forward) of rigel_estimate's comment in it or None."""
    axes = None
    try:
        # Not splitlines(), which breaks at more than line ends.
        with open(path, encoding="utf-8-sig") as file:
            lines = file.read().rstrip().split("\n")
    except (OSError, UnicodeDecodeError) as error:
        raise Bad(f"{path}: cannot be read: {error}") from error
    points, turns = [], []
    skipped = 0  # the first line that is blank or a comment
    kitti = 0  # the first line that says no time: line k is that of frame k
    for number, line in enumerate(lines, 1):
        said = re.match(r"# body: down (\S+), forward (\S+)$", line)
        if said and direction(said[1]) and direction(said[2]):
            axes = direction(said[1]), direction(said[2])
            continue
        words = line.split()
        if not words or line.startswith("#"):
            skipped = skipped or number
            continue
        if len(words) == 12:
            kitti = kitti or number
        if len(words) not in (8, 12):
            raise Bad(f"{path}:{number}: {len(words)} numbers, expected 12 (KITTI) or 8 (TUM)")
        try:
            values = [float(w) for w in words]
        except ValueError as error:
            raise Bad(f"{path}:{number}: {error}") from error
        if not all(map(math.isfinite, values)):
            raise Bad(f"{path}:{number}: a number is not finite")
        if len(words) == 12:
            points.append((values[3], values[7], values[11]))
            turns.append([values[k:12:4] for k in range(3)])
        else:
            points.append(tuple(values[1:4]))
            turns.append(axes_of_quaternion(*values[4:8]))
    if not points:
        raise Bad(f"{path}: there is no pose in it")
    if kitti and skipped:
        raise Bad(f"{path}:{skipped}: a blank line or a comment, expected that of frame "
                  f"{skipped - 1}: every line is that of a frame")
    return points, turns, axes


def axes_of_quaternion(x, y, z, w):
    """The columns of its rotation matrix."""
    n = x * x + y * y + z * z + w * w
    s = 2 / n if n > 0 else 0
    return [(1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
            (s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)),
            (s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y))]


def driven_axes(points, turns):
    """(down, forward) of the body by where it drives: along z, a camera, with y down; else z up."""
    driven = [0.0] * 3
    for before, after, turn in zip(points, points[1:], turns):
        step = [b - a for a, b in zip(before, after)]
        for k in range(3):
            driven[k] += dot(step, turn[k])
    main = max(range(3), key=lambda k: abs(driven[k]))
    if not any(driven) or main == 2:
        return (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    return (0.0, 0.0, -1.0), tuple(1.0 if k == main else 0.0 for k in range(3))


def in_world(axes, turn):
    """Down and forward of the body at a pose, as the nearest axes of the trajectories' frame."""
    result = []
    for axis in axes:
        v = [sum(a * t[k] for a, t in zip(axis, turn)) for k in range(3)]
        for done in result:
            v = [0.0 if d else x for x, d in zip(v, done)]
        main = max(range(3), key=lambda k: abs(v[k]))
        result.append(tuple(math.copysign(1.0, v[k]) if k == main else 0.0 for k in range(3)))
    return result


def view_of(tracks, down, forward):
    """Right and up of the page, in the frame of the trajectories."""
    said = [axes for _, (_, _, axes), _, _, _ in tracks if axes]
    points, turns, _ = tracks[0][1]
    default = said[0] if said else in_world(driven_axes(points, turns), turns[0])
    if down is None and forward is None and not said:
        print(f"rigel_plot.py: --down={direction_text(default[0])} "
              f"--forward={direction_text(default[1])}: by where the body drives; state them if "
              "they are others", file=sys.stderr)
    if down is None:
        down = default[0]
        if forward and abs(dot(down, forward)) > COS_OF_LEAST_ANGLE:
            raise Bad("--forward: is along down; state --down, too")
    if forward is None:
        # Any axis across a down that was stated alone, that of the default if it is.
        axes = [default[1]] + [tuple(float(k == n) for n in range(3)) for k in (2, 0, 1)]
        forward = next(a for a in axes if abs(dot(a, down)) < ACROSS)
    along = dot(down, forward)
    forward = tuple(f - along * d for f, d in zip(forward, down))
    size = math.hypot(*forward)
    if size < SIN_OF_LEAST_ANGLE:
        raise Bad("--forward: is within 30 degrees of the line of --down")
    forward = tuple(f / size for f in forward)
    return cross(down, forward), forward


def plot_trajectory(estimate_path, truth_path, down, forward):
    tracks = [("truth", truth_path, BLACK, ":", 2.0), ("estimate", estimate_path, RED, "-", 1.3)]
    tracks = [(n, read_trajectory(p), c, l, w) for n, p, c, l, w in tracks if p]
    right, up = view_of(tracks, down, forward)
    figure, axes = new_figure(1, 1, 6.5, 6.5)
    axis = axes[0][0]
    for name, (points, _, _), color, line, width in tracks:
        axis.plot([dot(p, right) for p in points], [dot(p, up) for p in points], color=color,
                  ls=line, lw=width, label=name)
        axis.plot(dot(points[-1], right), dot(points[-1], up), marker="s", color=color,
                  markersize=5)
    start = tracks[0][1][0][0]
    axis.plot(dot(start, right), dot(start, up), marker="o", color=BLUE, ls="", markersize=6,
              label="start")
    axis.set_aspect("equal", adjustable="datalim")
    axis.grid(True, color="#dddddd", lw=0.6)
    axis.set_xlabel("to the right, " + direction_text(right) + " [m]", fontsize=9)
    axis.set_ylabel("forward, " + direction_text(up) + " [m]", fontsize=9)
    axis.set_title("trajectory from above (squares: ends)", fontsize=10)
    axis.legend(frameon=False, fontsize=9)
    figure.tight_layout()
    return [("trajectory", figure)]
