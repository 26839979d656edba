"""The results of rigel_experiment, as rigel_claims.py reads them."""
import collections
import math

# Where a report has them, and the factor to their units.
PLACES = {(stage, quantity): ((stage, key), factor)
          for stage in ("raw", "refined", "bound")
          for quantity, key, factor in (("rotation", "rotation_deg", 1.0),
                                        ("direction", "translation_dir_deg", 1.0),
                                        ("scale", "scale", 100.0))}
PLACES["raw", "iterations"] = (("iterations",), 1.0)
PLACES["raw", "time"] = (("time_ms", "ransac"), 1.0)

Point = collections.namedtuple("Point", "motion sequence x")
Row = collections.namedtuple("Row", "solver solved values")  # values[stage, quantity]: statistics


def number(value):
    if type(value) not in (int, float) or not math.isfinite(value):
        raise ValueError(f"{value!r:.60} is no finite number")
    return float(value)


def natural(value, least):
    if type(value) is not int or not least <= value < 2**64:
        raise ValueError(f"{value!r:.60} is no integer from {least} on")
    return value


def word(value):
    if type(value) is not str:
        raise ValueError(f"{value!r:.60} is no text")
    return value


def ordinal(n):
    last = 0 if n % 100 // 10 == 1 else n % 10
    return f"{n}" + {1: "st", 2: "nd", 3: "rd"}.get(last, "th")


class Results:
    """The rows of one experiment, as rigel_experiment wrote them (docs/formats.md)."""

    def __init__(self, report, name, has_x):
        if report.get("format") != "rigel-experiment 1":
            raise ValueError("its format is not rigel-experiment 1")
        if report["experiment"] != name:
            raise ValueError("it is of another experiment")
        self.size = self.size_of(report["options"])
        self.rows = {}
        for entry in report["results"]:
            if ("x" in entry) != has_x:
                raise ValueError("a result has x where it should not, or none where it should")
            point = Point(word(entry["motion"]), "" if has_x else word(entry["sequence"]),
                          number(entry["x"]) if has_x else None)
            key = (point, word(entry["solver"]), word(entry["loop"]))
            self.rows.setdefault(key, self.row_of(entry))
        self.points = list(dict.fromkeys(point for point, _, _ in self.rows))
        self.solvers = list(dict.fromkeys(solver for _, solver, _ in self.rows))

    @staticmethod
    def size_of(options):
        if "every" in options:
            every = natural(options["every"], 1)
            text = "every motion" if every == 1 else f"every {ordinal(every)} motion"
        else:
            grid = "the coarse grid of --quick" if options["quick"] else "the full grid"
            text = f"{natural(options['pairs'], 1)} pairs a point, {grid}"
        return f"{text}, seed {natural(options['seed'], 0)}"

    @staticmethod
    def row_of(entry):
        values = {}
        for what, (keys, factor) in PLACES.items():
            place = entry
            for key in keys:
                place = place.get(key, {})
            if place:
                values[what] = {kind: factor * number(place[kind])
                                for kind in ("median", "mean", "rms")}
        return Row(entry["solver"], natural(entry["pairs"], 0) - natural(entry["failures"], 0),
                   values)

    def fewest_pairs(self):
        return min((row.solved for row in self.rows.values()), default=0)

    def statistic(self, point, solver, loop, stage, quantity):
        row = self.rows.get((point, solver, loop))
        return row.values.get((stage, quantity)) if row else None

    def median(self, point, solver, loop, stage, quantity):
        found = self.statistic(point, solver, loop, stage, quantity)
        return found["median"] if found else None

    def mean_time(self, solver, loop):
        """Of RANSAC over all solved pairs of all points, milliseconds."""
        rows = [row for (_, name, of_loop), row in self.rows.items()
                if (name, of_loop) == (solver, loop) and ("raw", "time") in row.values]
        pairs = sum(row.solved for row in rows)
        return sum(row.solved * row.values["raw", "time"]["mean"] for row in rows) / pairs \
            if pairs > 0 else None
