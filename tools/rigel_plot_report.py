"""Figures of the reports of rigel_compare and rigel_benchmark."""
from rigel_plot_style import (BOUND_LABEL, METRICS, bars, bound_as_median, legends, median,
                              new_figure, plain_ticks, styles_of, unique)


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
