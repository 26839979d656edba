#!/usr/bin/env python3
"""Draws the results of Rigel's programs: figures (PNG and SVG) and one HTML page.

  rigel_plot.py DIR                        results of rigel_experiment in DIR
  rigel_plot.py report.json                rigel_compare --json: cumulative error curves (with
                                           --per_pair) or bars of the medians
  rigel_plot.py benchmark.json             rigel_benchmark --json: bars of the solvers' times
  rigel_plot.py rig.json                   a rig file: the rig from above and from the side
  rigel_plot.py --estimate=E --truth=T     two trajectories from above, in KITTI format (12 numbers
                                           per line) or TUM format (time x y z qx qy qz qw)

Exit code: 0 done, 1 failed, 2 wrong flag, 4 matplotlib is missing.
"""
import argparse
import os
import re
import sys

sys.dont_write_bytecode = True  # the folder of the programs stays as it was installed
from rigel_files import Bad, printable, read_json
from rigel_plot_style import plt
from rigel_plot_experiment import plot_experiment
from rigel_plot_page import Page
from rigel_plot_report import plot_benchmark, plot_report
from rigel_plot_rig import plot_rig
from rigel_plot_trajectory import direction, plot_trajectory

EXPERIMENT, REPORT, BENCHMARK, CLAIMS, RIG = FORMATS = (
    "rigel-experiment 1", "rigel-report 1", "rigel-benchmark 1", "rigel-claims 1", "rigel-rig 1")


def kind_of(report):
    """Its format. Older rig files have none."""
    return report.get("format", RIG if "cameras" in report else None)


def need_results(report, key, path):
    if not report[key]:
        raise Bad(f"{path}: there are no results in it")


def plot_file(path, report):
    """(name, figure) of each figure of a report."""
    stem = os.path.splitext(os.path.basename(path))[0]
    kind = kind_of(report)
    if kind == RIG:
        return plot_rig(report, stem, path)
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


def check_output(path, inputs):
    """An output that is an input would destroy it."""
    for name in inputs:
        try:
            same = os.path.samefile(path, name)
        except OSError:  # one of them is not there
            continue
        if same:
            raise Bad(f"--html={path}: would overwrite the input {name}")


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
                if kind_of(report) not in FORMATS:
                    raise Bad(f"{file}: its format is {report.get('format')!r}")
            except Bad as error:
                print(printable(f"rigel_plot.py: left out: {error}"), file=sys.stderr)
                continue
            reports.append((file, report))
        if len(reports) == before:
            raise Bad(f"{path}: no results (*.json) in this directory")
    return reports


def add_report(page, path, report):
    """A report's figures, with the table beside it, or its claims."""
    kind = kind_of(report)
    try:
        if kind == CLAIMS:
            page.add_claims(report)
            return
        figures = plot_file(path, report)
        title = report.get("experiment", os.path.basename(path))
        if "about" in report:
            title += ": " + report["about"]
        page.add(figures, title, os.path.splitext(path)[0] + ".txt")
    except Bad:
        raise
    except Exception as error:  # what is wrong with a report can show itself anywhere
        what = " ".join(repr(error).split())[:200]
        raise Bad(f"{path}: not of its format {kind!r}: {what}") from error


def run(arguments):
    directory = arguments.output
    try:
        os.makedirs(directory, exist_ok=True)
    except OSError as error:
        raise Bad(f"{directory}: cannot be made: {error}") from error
    if arguments.html:
        check_output(arguments.html, [f for f in (arguments.estimate, arguments.truth) if f])
    reports = inputs_of(arguments.inputs)
    if arguments.html:
        check_output(arguments.html, [path for path, _ in reports])
    page = Page(directory, arguments.dpi)
    for path, report in reports:
        add_report(page, path, report)
    if arguments.estimate or arguments.truth:
        page.add(plot_trajectory(arguments.estimate, arguments.truth, arguments.down,
                                 arguments.forward), "Trajectory")
    if arguments.html:
        page.write(arguments.html)
        print(printable(f"wrote {arguments.html}"), file=sys.stderr)
    figures = "1 figure" if page.written == 1 else f"{page.written} figures"
    print(printable(f"wrote {figures} (PNG and SVG) to {directory}"), file=sys.stderr)


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("inputs", nargs="*", metavar="INPUT", help="reports or directories")
    parser.add_argument("--output", default="figures", metavar="DIR",
                        help="directory for the figures, created if missing (default: figures)")
    parser.add_argument("--html", metavar="FILE",
                        help="also write all tables and figures to this one file")
    parser.add_argument("--dpi", type=int, default=130,
                        help="resolution of the PNG files, dots per inch (default: 130)")
    parser.add_argument("--estimate", metavar="FILE", help="estimated trajectory")
    parser.add_argument("--truth", metavar="FILE", help="true trajectory")
    parser.add_argument("--down", metavar="AXIS",
                        help="down direction in the frame of the trajectories, that of the first "
                        "pose: +x, -x, +y, -y, +z, -z or three numbers x,y,z. Default: as a TUM "
                        "file of rigel_estimate states; else +y if the body drives along z, as a "
                        "camera does, or -z")
    parser.add_argument("--forward", metavar="AXIS",
                        help="forward direction, drawn upwards; written as --down")
    parser.add_argument("--vertical", choices="xyz",
                        help="older option: y is --down=+y --forward=+z, z is --down=-z "
                        "--forward=+y, x is --down=-x --forward=+z")
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
    return arguments


def main():
    arguments = parse_arguments()
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
