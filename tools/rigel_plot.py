#!/usr/bin/env python3
"""Figures (PNG and SVG) and a self-contained HTML page from the results of Rigel's programs.

  rigel_plot.py DIR                        the results of rigel_experiment in DIR
  rigel_plot.py report.json                rigel_compare --json: cumulative error curves (with
                                           --per_pair) or bars of the medians
  rigel_plot.py benchmark.json             rigel_benchmark --json: bars of the solvers' times
  rigel_plot.py --estimate=E --truth=T     two trajectories in KITTI's format (12 numbers a line)
                                           or TUM's (time x y z qx qy qz qw), from above: along
                                           --down, with --forward up the page

Exit code: 0 done, 1 failed, 2 wrong flag, 4 matplotlib is missing.
"""
import argparse
import atexit
import base64
import html
import io
import math
import os
import re
import shutil
import sys
import tempfile
import zlib

sys.dont_write_bytecode = True  # the folder of the programs stays as it was installed
from rigel_files import Bad, printable, read_json, write_whole

NO_MATPLOTLIB = 4
GUARD = "RIGEL_PLOT_SECOND_PYTHON"


def give_matplotlib_a_folder():
    """matplotlib keeps a cache of fonts, and complains where the user has no home for it."""
    if "MPLCONFIGDIR" in os.environ:
        return None
    home = os.environ.get("XDG_CONFIG_HOME") or os.path.expanduser("~")
    if os.path.isdir(home) and os.access(home, os.W_OK | os.X_OK):
        return None
    folder = tempfile.mkdtemp(prefix="rigel_plot_")
    os.environ["MPLCONFIGDIR"] = folder
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


cache = give_matplotlib_a_folder()
try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.lines import Line2D
    from PIL import Image
except ImportError:
    # Debian's matplotlib is with Debian's python, which need not come first in PATH.
    debian = "/usr/bin/python3"
    if os.path.exists(debian) and os.path.realpath(sys.executable) != os.path.realpath(debian) \
            and GUARD not in os.environ:
        os.environ[GUARD] = "1"
        if cache:
            shutil.rmtree(cache, ignore_errors=True)
            del os.environ["MPLCONFIGDIR"]
        os.execv(debian, [debian] + sys.argv)
    if not {"-h", "--help"} & set(sys.argv):
        print("rigel_plot.py: matplotlib is missing (Debian: apt install python3-matplotlib)",
              file=sys.stderr)
        sys.exit(NO_MATPLOTLIB)

# Okabe and Ito's colours and some of Tol's, told apart by colour-blind readers; markers tell them
# apart in print. A solver looks the same in all figures: no two share colour and marker, and in no
# experiment do two share a colour.
BLACK, GREY = "#000000", "#7f7f7f"
ORANGE, SKY, GREEN = "#E69F00", "#56B4E9", "#009E73"
BLUE, RED, PINK = "#0072B2", "#D55E00", "#CC79A7"
WINE, INDIGO, OLIVE = "#882255", "#332288", "#999933"
STYLES = {
    "17pt-li": (GREY, "s"), "6pt-stewenius": (PINK, "D"), "6pt-ventura": (ORANGE, "^"),
    "5pt+1": (OLIVE, "P"), "2pt-choi": (GREEN, "x"), "2pt-ackermann": (SKY, "+"),
    "4pt-lee": (SKY, "v"), "4pt-liu": (GREEN, "<"), "4pt-sweeney": (PINK, ">"),
    "4pt-approx": (BLUE, "o"), "4pt-axis-approx": (RED, "*"), "3pt-approx": (BLACK, "o"),
    "4pt-approx-polished": (GREY, "d"), "4pt-axis-approx-polished": (WINE, "p"),
    "3pt-approx-polished": (OLIVE, "h"), "4pt": (INDIGO, "+"), "4pt-axis": (PINK, "X"),
    "3pt": (GREEN, "1"),
}
SPARE = [WINE, INDIGO, OLIVE, BLUE, GREEN, SKY, ORANGE, PINK, RED, GREY]

METRICS = [("rotation_deg", r"rotation error [deg]", 1.0),
           ("translation_dir_deg", r"translation direction error [deg]", 1.0)]
SCALE = ("scale", "scale error [%]", 100.0)
LOG_Y = {"rotation-angle", "outliers", "match-count", "inter-share"}
LOG_X = {"match-count"}
LOOPS = {"paper": "largest inlier count, as the paper", "rigel": "Rigel's RANSAC"}


# The bound is an RMS, the curves are medians, and the median of a Gaussian error's norm lies below
# its RMS. Drawn as it is the bound would seem to be beaten by what merely reaches it. It is drawn
# times median over RMS of the norm of an isotropic Gaussian: of three dimensions, sqrt(2.366 / 3),
# for the rotation, of two, sqrt(ln 2), for the direction. An anisotropic error's factor is lower.
MEDIAN_OVER_RMS = {"rotation_deg": 0.8881, "translation_dir_deg": 0.8326}
BOUND_LABEL = "Cramér-Rao bound (as a median)"


def style_of(solver):
    """Colour and marker: an unknown solver's follow from its name, not from the figure."""
    return STYLES.get(solver, (SPARE[zlib.crc32(solver.encode()) % len(SPARE)], "8"))


def styles_of(solvers):
    return {solver: style_of(solver) for solver in solvers}


def unique(items):
    return list(dict.fromkeys(items))


def median(row, stage, metric, factor):
    value = row.get(stage, {}).get(metric, {}).get("median")
    return None if value is None else factor * value


def bound_as_median(row, metric, factor):
    value = median(row, "bound", metric, factor)
    return None if value is None else MEDIAN_OVER_RMS[metric] * value


def new_figure(rows, columns, width, height):
    figure, axes = plt.subplots(rows, columns, figsize=(width, height), squeeze=False)
    return figure, axes


def solver_handles(solvers, line="-"):
    return [Line2D([], [], color=color, marker=marker, markersize=5, lw=1.2, ls=line, label=solver)
            for solver, (color, marker) in styles_of(solvers).items()]


def stage_handles(bound):
    handles = [Line2D([], [], color=BLACK, lw=1.1, ls="--", label="raw"),
               Line2D([], [], color=BLACK, lw=1.6, ls="-", label="refined")]
    if bound:
        handles.append(Line2D([], [], color=BLACK, lw=1.6, ls=":", label=BOUND_LABEL))
    return handles


def legends(figure, solvers, bound, top):
    """Solvers in the upper lines, line styles below them; returns where the axes may begin."""
    room = int(figure.get_figwidth() / (0.5 + 0.062 * max(map(len, solvers))))
    columns = math.ceil(len(solvers) / math.ceil(len(solvers) / max(1, room)))
    lines = math.ceil(len(solvers) / columns)
    step = 0.23 / figure.get_figheight()
    figure.legend(handles=solver_handles(solvers), loc="upper center", ncol=columns,
                  bbox_to_anchor=(0.5, top), frameon=False, fontsize=8.5, columnspacing=1.4)
    below = top - step * lines
    figure.legend(handles=stage_handles(bound), loc="upper center", ncol=3,
                  bbox_to_anchor=(0.5, below), frameon=False, fontsize=8.5)
    return below - step - 0.1 / figure.get_figheight()


def draw_curves(axis, rows, solvers, metric, factor):
    """Raw dashed, refined solid, bound dotted. True if there is a bound."""
    bound = {}
    for solver, (color, marker) in styles_of(solvers).items():
        mine = [r for r in rows if r["solver"] == solver]
        for stage, line, width, size in (("raw", "--", 1.1, 4.5), ("refined", "-", 1.4, 3)):
            points = [(r["x"], median(r, stage, metric, factor)) for r in mine]
            points = [p for p in points if p[1] is not None]
            if points:
                axis.plot(*zip(*points), color=color, marker=marker, ls=line, lw=width,
                          markersize=size, markerfacecolor="none" if stage == "raw" else color)
        for r in mine:
            value = bound_as_median(r, metric, factor)
            if value is not None:
                bound.setdefault(r["x"], []).append(value)
    if bound:
        points = sorted((x, sorted(v)[len(v) // 2]) for x, v in bound.items())
        axis.plot(*zip(*points), color=BLACK, ls=":", lw=2.0, zorder=5)
    return bool(bound)


def plain_ticks(axis):
    """Of a logarithmic axis: 0.02, 0.05, 0.1 instead of powers of ten."""
    low, high = axis.get_view_interval()
    few = math.log10(high / low) < 2.5 if low > 0 else False
    axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5) if few else (1,),
                                                        numticks=20))
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def finish_axis(axis, log_x, log_y):
    axis.grid(True, color="#dddddd", lw=0.6)
    axis.set_axisbelow(True)
    axis.tick_params(labelsize=8)
    if log_x:
        axis.set_xscale("log")
        plain_ticks(axis.xaxis)
    if log_y:
        axis.set_yscale("log")
        plain_ticks(axis.yaxis)
        axis.grid(True, which="minor", color="#eeeeee", lw=0.4)
    else:
        axis.set_ylim(bottom=0)


def plot_curves(report, loop):
    name = report["experiment"]
    rows = [r for r in report["results"] if r["loop"] == loop]
    motions = unique(r["motion"] for r in rows)
    solvers = unique(r["solver"] for r in rows)
    metrics = METRICS + ([SCALE] if name == "inter-share" else [])
    # The paper's grid; a single motion has its quantities side by side.
    by_motion = len(motions) > 1
    shape = (len(metrics), len(motions)) if by_motion else (1, len(metrics))
    figure, axes = new_figure(*shape, 10.5 if shape[1] > 2 else 8, 6.6 if by_motion else 4.1)
    any_bound = False
    for i, (metric, label, factor) in enumerate(metrics):
        for j, motion in enumerate(motions):
            axis = axes[i][j] if by_motion else axes[0][i]
            mine = [r for r in rows if r["motion"] == motion]
            any_bound |= draw_curves(axis, mine, solvers, metric, factor)
            finish_axis(axis, name in LOG_X, name in LOG_Y)
            if by_motion and i == 0:
                axis.set_title(motion + " motion", fontsize=10)
            if not by_motion or j == 0:
                axis.set_ylabel(label, fontsize=9)
            if not by_motion or i + 1 == len(metrics):
                axis.set_xlabel(report["x"]["label"], fontsize=9)
    figure.suptitle(f"{name}: medians, {LOOPS.get(loop, loop)}", fontsize=11, y=0.99)
    top = legends(figure, solvers, any_bound, 0.99 - 0.25 / figure.get_figheight())
    figure.subplots_adjust(left=0.7 / figure.get_figwidth(), right=0.985,
                           bottom=0.5 / figure.get_figheight(), wspace=0.22, hspace=0.14,
                           top=top - (0.2 if by_motion else 0.05) / figure.get_figheight())
    return figure


def plot_sequences(report, loop):
    """One group of markers a drive: raw hollow, refined filled, bound a black line."""
    rows = [r for r in report["results"] if r["loop"] == loop]
    sequences = unique(r["sequence"] for r in rows)
    solvers = unique(r["solver"] for r in rows)
    figure, axes = new_figure(2, 1, 10.5, 6.6)
    any_bound = False
    for i, (metric, label, factor) in enumerate(METRICS):
        axis = axes[i][0]
        for k, sequence in enumerate(sequences):
            if k % 2:
                axis.axvspan(k - 0.5, k + 0.5, color="#f2f2f2", lw=0)
            bounds = []
            for number, (solver, (color, marker)) in enumerate(styles_of(solvers).items()):
                x = k + 0.8 * ((number + 0.5) / len(solvers) - 0.5)
                for row in rows:
                    if row["sequence"] != sequence or row["solver"] != solver:
                        continue
                    raw = median(row, "raw", metric, factor)
                    refined = median(row, "refined", metric, factor)
                    bound = bound_as_median(row, metric, factor)
                    if raw is not None:
                        axis.plot(x, raw, marker=marker, color=color, markersize=5.5,
                                  markerfacecolor="none")
                    if refined is not None:
                        axis.plot(x, refined, marker=marker, color=color, markersize=3.5)
                    if bound is not None:
                        bounds.append(bound)
            if bounds:
                any_bound = True
                axis.plot([k - 0.45, k + 0.45], [sorted(bounds)[len(bounds) // 2]] * 2,
                          color=BLACK, ls=":", lw=1.8)
        finish_axis(axis, False, True)
        axis.grid(False, axis="x")
        axis.set_xlim(-0.5, len(sequences) - 0.5)
        axis.set_xticks(range(len(sequences)), sequences)
        axis.set_ylabel(label, fontsize=9)
    axes[1][0].set_xlabel("drive", fontsize=9)
    figure.suptitle(f"{report['experiment']}: medians, {LOOPS.get(loop, loop)}", fontsize=11,
                    y=0.99)
    figure.legend(handles=solver_handles(solvers, ""), loc="upper center", ncol=len(solvers),
                  bbox_to_anchor=(0.5, 0.962), frameon=False, fontsize=8.5, columnspacing=1.2)
    handles = [
        Line2D([], [], color=BLACK, marker="o", ls="", markerfacecolor="none", label="raw"),
        Line2D([], [], color=BLACK, marker="o", ls="", markersize=3.5, label="refined")]
    if any_bound:
        handles.append(Line2D([], [], color=BLACK, ls=":", lw=1.8, label=BOUND_LABEL))
    figure.legend(handles=handles, loc="upper center", ncol=3, bbox_to_anchor=(0.5, 0.93),
                  frameon=False, fontsize=8.5)
    figure.subplots_adjust(left=0.065, right=0.985, bottom=0.075, top=0.875, hspace=0.12)
    return figure


def faded(color, share):
    return tuple(share * c + 1 - share for c in matplotlib.colors.to_rgb(color))


def bars(solvers, series, label, title, colors=None):
    """Horizontal bars on a logarithmic axis; `series` is a list of (name, values)."""
    height = 0.8 / len(series)
    figure, axes = new_figure(1, 1, 7.5, 1.2 + 0.36 * len(solvers) * max(1, 0.6 * len(series)))
    axis = axes[0][0]
    fades = [1.0, 0.45, 0.15, 0.0]  # of the colour, the rest is white
    for n, (name, values) in enumerate(series):
        for k, (solver, value) in enumerate(zip(solvers, values)):
            if value is None or not value > 0:
                continue
            y = k + height * (n - (len(series) - 1) / 2)
            color = style_of(solver)[0]
            axis.barh(y, value, height=0.92 * height, color=faded(color, fades[n % len(fades)]),
                      edgecolor=color, lw=0.8)
            axis.text(value * 1.04, y, f"{value:.3g}", va="center", fontsize=7.5)
    axis.set_yticks(range(len(solvers)), solvers, fontsize=8.5)
    axis.invert_yaxis()
    axis.set_xscale("log")
    plain_ticks(axis.xaxis)
    axis.margins(x=0.12)
    axis.grid(True, axis="x", color="#dddddd", lw=0.6)
    axis.set_axisbelow(True)
    axis.set_xlabel(label, fontsize=9)
    axis.set_title(title, fontsize=10, pad=22 if len(series) > 1 else 6)
    if len(series) > 1:
        axis.legend(handles=[matplotlib.patches.Patch(
            facecolor=faded(GREY, fades[n % len(fades)]), edgecolor=GREY, label=name)
            for n, (name, _) in enumerate(series)], loc="lower center", frameon=False,
            fontsize=8, ncol=len(series), bbox_to_anchor=(0.5, 1.0), borderpad=0.1)
    figure.tight_layout()
    return figure


def plot_runtime(report):
    rows = report["results"]
    solvers = unique(r["solver"] for r in rows)
    series = []
    for loop in unique(r["loop"] for r in rows):
        for part in ("ransac", "refine"):
            if part == "refine" and loop != "rigel":
                continue
            values = []
            for solver in solvers:
                mine = [(r["pairs"] - r["failures"], r["time_ms"][part]["mean"]) for r in rows
                        if r["solver"] == solver and r["loop"] == loop and "time_ms" in r]
                count = sum(n for n, _ in mine)
                values.append(sum(n * t for n, t in mine) / count if count else None)
            series.append((f"RANSAC, loop {loop}" if part == "ransac" else "refinement", values))
    if not any(v for _, values in series for v in values):
        return None
    return bars(solvers, series, "mean time a pair [ms]", f"{report['experiment']}: time")


def plot_experiment(report):
    name = report["experiment"]
    figures = []
    for loop in unique(r["loop"] for r in report["results"]):
        make = plot_curves if "x" in report else plot_sequences
        figures.append((name if loop == "paper" else f"{name}-{loop}", make(report, loop)))
    if "x" not in report or name == "image-noise":
        runtime = plot_runtime(report)
        if runtime is not None:
            figures.append((name + "-runtime", runtime))
    return figures


def plot_report(report, stem):
    pairs = report.get("pair_results")
    solvers = unique(r["solver"] for r in report["results"])
    if not pairs:
        rows = {r["solver"]: r for r in report["results"] if r["sequence"] == "all"}
        figures = []
        for metric, label, factor in METRICS:
            series = [(stage, [median(rows[s], stage, metric, factor) for s in solvers])
                      for stage in ("raw", "refined")]
            bounds = [bound_as_median(rows[s], metric, factor) for s in solvers]
            if any(bounds):
                series.append((BOUND_LABEL, bounds))
            if any(v for _, values in series for v in values):
                figures.append((f"{stem}-{metric}", bars(solvers, series, label, "medians")))
        return figures
    figure, axes = new_figure(1, 2, 9, 4.6)
    for axis, (metric, label, factor) in zip(axes[0], METRICS):
        for solver, (color, marker) in styles_of(solvers).items():
            for stage, line in (("raw", "--"), ("refined", "-")):
                values = [p["solvers"].get(solver, {}).get(stage, {}).get(metric) for p in pairs]
                values = sorted(factor * v for v in values if v is not None and v > 0)
                # A pair without an estimate is never within any error.
                shares = [100.0 * (k + 1) / len(pairs) for k in range(len(values))]
                if values:
                    axis.step(values, shares, where="post", color=color, ls=line, lw=1.3,
                              marker=marker, markersize=4.5, markevery=max(1, len(values) // 6),
                              markerfacecolor="none" if stage == "raw" else color)
        axis.set_xscale("log")
        plain_ticks(axis.xaxis)
        axis.set_ylim(0, 101)
        axis.grid(True, color="#dddddd", lw=0.6)
        axis.tick_params(labelsize=8)
        axis.set_xlabel(label, fontsize=9)
    axes[0][0].set_ylabel("pairs within the error [%]", fontsize=9)
    top = legends(figure, solvers, False, 0.99)
    figure.subplots_adjust(left=0.07, right=0.985, bottom=0.11, top=top - 0.01, wspace=0.14)
    return [(stem + "-cumulative", figure)]


def plot_benchmark(report, stem):
    rows = report["solvers"]
    solvers = unique(r["solver"] for r in rows)
    series = []
    for kind in ("intra", "inter"):
        times = {r["solver"]: r["median_us"] for r in rows if r["matches"] == kind}
        if times:
            series.append((f"{kind}-camera samples", [times.get(s) for s in solvers]))
    return [(stem + "-runtime",
             bars(solvers, series, "median time of a call [µs]", "minimal solvers"))]


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
        if abs(v[k]) > 1 - 1e-9:
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
        if forward and abs(dot(down, forward)) > 0.866:
            raise Bad("--forward: is along down; state --down, too")
    if forward is None:
        # Any axis across a down that was stated alone, that of the default if it is.
        axes = [default[1]] + [tuple(float(k == n) for n in range(3)) for k in (2, 0, 1)]
        forward = next(a for a in axes if abs(dot(a, down)) < 0.5)
    along = dot(down, forward)
    forward = tuple(f - along * d for f, d in zip(forward, down))
    size = math.hypot(*forward)
    if size < 0.5:
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


def save(figure, directory, name, dpi):
    """Writes both files; returns their paths, the SVG's last."""
    paths = [os.path.join(directory, f"{name}.{kind}") for kind in ("png", "svg")]
    png, small, svg = io.BytesIO(), io.BytesIO(), io.StringIO()
    figure.savefig(png, format="png", dpi=dpi, metadata={"Software": None})
    figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": "rigel_plot.py"})
    plt.close(figure)
    # 128 colours are enough for lines and letters; a third of the size.
    with Image.open(png) as image:
        image.convert("RGB").quantize(128).save(small, format="png", optimize=True)
    text = svg.getvalue()
    # A hundredth of a point is fine enough; half the size.
    text = re.sub(r"(\d\.\d\d)\d+", r"\1", text)
    text = re.sub(r"(<use [^>]*); stroke-linejoin: miter", r"\1", text)
    text = re.sub(r"\n +", "\n", text)
    write_whole(paths[0], small.getvalue())
    write_whole(paths[1], text.encode("utf-8"))
    return paths


EXPERIMENT, REPORT, BENCHMARK, CLAIMS = FORMATS = (
    "rigel-experiment 1", "rigel-report 1", "rigel-benchmark 1", "rigel-claims 1")


def need_results(report, key, path):
    if not report[key]:
        raise Bad(f"{path}: there are no results in it")


def plot_file(path, report):
    """(name, figure) of each figure of a report."""
    stem = os.path.splitext(os.path.basename(path))[0]
    kind = report.get("format")
    if kind == EXPERIMENT:
        # It names files.
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", report["experiment"]):
            raise Bad(f"{path}: no name of an experiment: {report['experiment']!r}")
        need_results(report, "results", path)
        return plot_experiment(report)
    if kind == REPORT:
        need_results(report, "results", path)
        return plot_report(report, stem)
    if kind == BENCHMARK:
        need_results(report, "solvers", path)
        return plot_benchmark(report, stem)
    raise Bad(f"{path}: its format is {kind!r}, which has no figure")


PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Rigel: experiments</title>
<style>
body {{ font: 15px/1.45 sans-serif; max-width: 1150px; margin: 2em auto; padding: 0 1em; }}
img {{ max-width: 100%; }}
table {{ border-collapse: collapse; }}
td, th {{ border: 1px solid #bbb; padding: .3em .5em; text-align: left; vertical-align: top; }}
pre {{ font-size: 12px; line-height: 1.25; overflow-x: auto; background: #f6f6f6; padding: .7em; }}
.confirmed {{ background: #d9efe6; }} .partly {{ background: #fdf1cf; }}
.not-confirmed {{ background: #f8dccb; }} .too-few-pairs {{ background: #eeeeee; }}
</style></head><body>
<h1>Rigel: experiments</h1>
{body}
</body></html>
"""


def claims_html(report):
    lines = ["<h2>Claims</h2><table><tr><th>of</th><th>experiment</th><th>claim</th>"
             "<th>verdict</th><th>figures</th><th>where not</th></tr>"]
    for claim in report["claims"]:
        cells = [claim[k] for k in ("of", "experiment", "claim", "verdict", "figures", "where_not")]
        kind = claim["verdict"].replace(" ", "-")
        lines.append(f'<tr class="{html.escape(kind)}">' +
                     "".join(f"<td>{html.escape(c)}</td>" for c in cells) + "</tr>")
    return "\n".join(lines + ["</table>"])


def check_output(path, inputs):
    """An output that is an input would destroy it."""
    for name in inputs:
        try:
            same = os.path.samefile(path, name)
        except OSError:  # one of them is not there
            continue
        if same:
            raise Bad(f"--html={path}: is the input {name}, which it would destroy")


def write_html(path, sections):
    text = PAGE.format(body="\n".join(sections))
    try:
        write_whole(path, text.encode("utf-8"))
    except OSError as error:
        raise Bad(f"{path}: cannot be written: {error}") from error


def image_html(svg_path, name):
    # As an image, so that names within one figure do not meet those of another.
    with open(svg_path, "rb") as file:
        data = base64.b64encode(file.read()).decode("ascii")
    return f'<img alt="{html.escape(name)}" src="data:image/svg+xml;base64,{data}">'


def inputs_of(paths):
    """(path, report) of each file; in a directory only of those whose format is known."""
    reports = []
    for path in paths:
        if not os.path.isdir(path):
            reports.append((path, read_json(path)))
            continue
        before = len(reports)
        for name in sorted(f for f in os.listdir(path) if f.endswith(".json")):
            file = os.path.join(path, name)
            try:
                report = read_json(file)
                if report.get("format") not in FORMATS:
                    raise Bad(f"{file}: its format is {report.get('format')!r}")
            except Bad as error:
                print(printable(f"rigel_plot.py: left out: {error}"), file=sys.stderr)
                continue
            reports.append((file, report))
        if len(reports) == before:
            raise Bad(f"{path}: no results (*.json) in this directory")
    return reports


def run(arguments):
    directory = arguments.output
    try:
        os.makedirs(directory, exist_ok=True)
    except OSError as error:
        raise Bad(f"{directory}: cannot be made: {error}") from error
    sections = {"claims": [], "other": []}
    written = 0

    def add(figures, title, table_path=None):
        nonlocal written
        part = [f"<h2>{html.escape(title)}</h2>"]
        for name, figure in figures:
            try:
                paths = save(figure, directory, name, arguments.dpi)
            except OSError as error:
                raise Bad(f"{directory}: cannot be written: {error}") from error
            written += 1
            part.append(image_html(paths[1], name))
        if table_path and os.path.exists(table_path):
            with open(table_path, encoding="utf-8") as file:
                part.append("<pre>" + html.escape(file.read()) + "</pre>")
        sections["other"].append("\n".join(part))

    if arguments.html:
        check_output(arguments.html, [f for f in (arguments.estimate, arguments.truth) if f])
    reports = inputs_of(arguments.inputs)
    if arguments.html:
        check_output(arguments.html, [path for path, _ in reports])
    for path, report in reports:
        kind = report.get("format")
        try:
            if kind == CLAIMS:
                sections["claims"].append(claims_html(report))
                continue
            figures = plot_file(path, report)
            title = report.get("experiment", os.path.basename(path))
            if "about" in report:
                title += ": " + report["about"]
            add(figures, title, os.path.splitext(path)[0] + ".txt")
        except Bad:
            raise
        except Exception as error:  # what is wrong with a report can show itself anywhere
            what = " ".join(repr(error).split())[:200]
            raise Bad(f"{path}: not of its format {kind!r}: {what}") from error
    if arguments.estimate or arguments.truth:
        add(plot_trajectory(arguments.estimate, arguments.truth, arguments.down,
                            arguments.forward), "Trajectory")
    if arguments.html:
        write_html(arguments.html, sections["claims"] + sections["other"])
        print(printable(f"wrote {arguments.html}"), file=sys.stderr)
    print(printable(f"wrote {written} figure{'' if written == 1 else 's'} (PNG and SVG) to {directory}"), file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("inputs", nargs="*", metavar="INPUT", help="reports or directories")
    parser.add_argument("--output", default="figures", help="directory of the figures; made")
    parser.add_argument("--html", help="join tables and figures in this one file")
    parser.add_argument("--dpi", type=int, default=130, help="resolution of the PNG files")
    parser.add_argument("--estimate", help="trajectory to draw")
    parser.add_argument("--truth", help="true trajectory to draw")
    parser.add_argument("--down", help="which way is down in the frame of the trajectories, of "
                        "rigel_estimate's the body's at the start: +y, -z, ... or three numbers "
                        "x,y,z; default: as a TUM file of rigel_estimate says, else by where the "
                        "body drives: along its z, as a camera does, +y of it, else -z")
    parser.add_argument("--forward", help="the same of forward, which is up the page")
    parser.add_argument("--vertical", choices="xyz", help="older name: y is --down=+y "
                        "--forward=+z, z is --down=-z --forward=+y, x is --down=-x --forward=+z")
    arguments = parser.parse_args()
    if arguments.vertical and (arguments.down or arguments.forward):
        parser.error("--vertical: is another name of --down and --forward")
    if arguments.vertical:
        arguments.down, arguments.forward = {
            "x": ("-x", "+z"), "y": ("+y", "+z"), "z": ("-z", "+y")}[arguments.vertical]
    for name in ("down", "forward"):
        text = getattr(arguments, name)
        if text is None:
            continue
        setattr(arguments, name, direction(text))
        if getattr(arguments, name) is None:
            parser.error(f"--{name}={text}: expected +x, -x, +y, -y, +z, -z or three numbers x,y,z")
    if not 10 <= arguments.dpi <= 1200:
        parser.error("--dpi: expected 10 to 1200")
    if not arguments.inputs and not arguments.estimate and not arguments.truth:
        parser.error("nothing to draw: name a report, a directory or --estimate")
    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "rigel", "font.size": 9,
                         "axes.linewidth": 0.7, "figure.max_open_warning": 0})
    try:
        run(arguments)
    except Bad as error:
        print(printable(f"rigel_plot.py: {error}"), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
