"""Figures of rigel_experiment's results: error curves, one group a drive, times."""
from rigel_plot_style import (BLACK, BOUND_LABEL, METRICS, SCALE, Line2D, bars, bound_as_median,
                              finish_axis, legends, median, new_figure, solver_handles, styles_of,
                              unique)

LOG_Y = {"rotation-angle", "outliers", "match-count", "inter-share"}
LOG_X = {"match-count"}
LOOPS = {"paper": "largest inlier count, as the paper", "rigel": "Rigel's RANSAC"}


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
