"""What the figures of rigel_plot.py share: matplotlib, colours, axes, legends and bars."""
import atexit
import math
import os
import shutil
import sys
import tempfile
import zlib

NO_MATPLOTLIB = 4  # exit code, as in python_script.cc
# Environment variable: a second python was tried, there is no third.
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
    matplotlib = plt = Line2D = Image = None
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


# Decades of an axis that still has room for ticks at 1, 2 and 5 of each.
FEW_DECADES = 2.5


def plain_ticks(axis):
    """Of a logarithmic axis: 0.02, 0.05, 0.1 instead of powers of ten."""
    low, high = axis.get_view_interval()
    few = math.log10(high / low) < FEW_DECADES if low > 0 else False
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
