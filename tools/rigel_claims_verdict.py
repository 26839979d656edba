"""The verdict on a claim (rigel_claims.json, docs/formats.md) from the results of an experiment."""
import collections
import math
import operator
import statistics

COMPARE = {"below": operator.lt, "at_most": operator.le, "equal": operator.eq,
           "at_least": operator.ge, "above": operator.gt}
UNITS = {"rotation": "deg", "direction": "deg", "scale": "%"}

# The RMS of n errors in d dimensions, of about the same size, scatters by 1 / sqrt(2 n d). The
# errors are of 2 (direction) or 3 (rotation) dimensions of unlike size: d = 1.5.
DIMENSIONS = 1.5
# RMS error over RMS bound: at most this, or 1 + 3 standard errors where that is more.
ON_THE_BOUND = 1.1
# Above this limit (fewer than 12 pairs a point of three motions) the verdict would say little.
USELESS_LIMIT = 1.3

Term = collections.namedtuple("Term", "name value")  # value(point, quantity)


def shown(value):
    """Three digits after the point, two from 1 and none from 100 on; - for nothing."""
    if value is None or not math.isfinite(value):
        return "-"
    return f"{value:.{3 if value < 1 else 2 if value < 100 else 0}f}"


def span(values):
    """Of numbers that are all there: 1.20 to 3.40."""
    values = list(values)
    if not values or None in values:
        return "-"
    low, high = shown(min(values)), shown(max(values))
    return low if low == high else f"{low} to {high}"


def name_of(point):
    return point.sequence if point.x is None else f"{point.motion} at {point.x:g}"


def takes(conditions, value):
    return all(COMPARE[name](value, limit) for name, limit in conditions.items())


class Claim:
    """One entry of the list on results that are there."""

    def __init__(self, entry, groups, unit, results):
        self.entry, self.groups, self.unit, self.results = entry, groups, unit, results
        self.loop = entry.get("loop", "paper")
        self.held, self.count, self.failed, self.too_few = 0, 0, [], None

    def solvers(self, of):
        if isinstance(of, list):
            return of
        return self.results.solvers if of == "all" else self.groups.get(of, [of])

    def median(self, solver, spec, point, quantity, stage=None):
        """What a solver has at a point, less what it has at spec's `since`."""
        if quantity == "time":
            return self.results.mean_time(solver, self.loop)
        stage = "raw" if quantity == "iterations" else stage or spec.get("stage", "raw")
        here = self.results.median(point, solver, self.loop, stage, quantity)
        if "since" not in spec or here is None:
            return here
        before = self.results.median(point._replace(x=spec["since"]), solver, self.loop, stage,
                                     quantity)
        return None if before is None else here - before

    def terms(self, term, spec, same_as=None):
        """What "a" or "b" of a case stands for: solvers one by one, or the worst or best."""
        if not isinstance(term, dict):
            term = {"each": term}
        stage = term.get("stage")
        (take, of), = ((key, value) for key, value in term.items() if key != "stage")
        if take == "same_at":
            return [Term(f"at {of:g}", lambda point, quantity: self.median(
                same_as, spec, point._replace(x=of), quantity, stage))]
        if take in ("worst", "best"):
            solvers, choose = self.solvers(of), max if take == "worst" else min

            def chosen(point, quantity):
                values = [self.median(solver, spec, point, quantity, stage) for solver in solvers]
                return None if None in values else choose(values)
            return [Term(f"{take} {of}", chosen)]
        return [Term(solver, lambda point, quantity, solver=solver: self.median(
                    solver, spec, point, quantity, stage))
                for solver in self.solvers(of) if take == "each" or solver != same_as]

    def points(self, spec):
        return [point for point in self.results.points
                if point.motion != spec.get("but") and takes(spec.get("x", {}), point.x)]

    def comparisons(self, spec):
        """(where, a, b) of each case: names and values; b is 1 where the limits are absolute."""
        one = [Term("", lambda *_: 1.0)]
        for point in [None] if spec["quantities"] == ["time"] else self.points(spec):
            for quantity in spec["quantities"]:
                where = f"{name_of(point)}, {quantity}" if point else "mean ms"
                for a in self.terms(spec["a"], spec):
                    for b in self.terms(spec["b"], spec, a.name) if "b" in spec else one:
                        values = a.value(point, quantity), b.value(point, quantity)
                        # A solver that was run and has no value, where that fails.
                        if values[0] is None and spec.get("missing") == "fails" \
                                and (point, a.name, self.loop) in self.results.rows:
                            values = math.inf, values[1]
                        if None not in values:
                            yield where, a.name, values[0], b.name, values[1]

    def add(self, holds, what):
        self.count += 1
        self.held += holds
        if not holds:
            self.failed.append(what)

    def compare(self, spec):
        for where, a_name, a, b_name, b in self.comparisons(spec):
            holds = all(COMPARE[name](a, factor * b) for name, factor in spec["is"].items())
            other = f", {b_name} {shown(b)}" if b_name else ""
            self.add(holds, f"{where}: {a_name} {shown(a)}{other}")

    def crossing(self, motion, solver, spec):
        """x where a solver's rotation becomes worse than the other term's, interpolated; infinite
        if it does not; nothing if a value is missing."""
        other, = self.terms(spec["b"], spec)
        last = None
        for point in self.points({}):
            if point.motion != motion:
                continue
            a = self.median(solver, spec, point, "rotation")
            b = other.value(point, "rotation")
            if a is None or b is None:
                return None
            if a >= b:
                if last is None:
                    return point.x
                return last[0] + (point.x - last[0]) * -last[1] / (a - b - last[1])
            last = point.x, a - b
        return math.inf

    def crossings(self, spec):
        for motion in dict.fromkeys(point.motion for point in self.results.points):
            found = [(solver, self.crossing(motion, solver, spec))
                     for solver in self.solvers(spec["a"])]
            yield motion, [(solver, x, f"{solver} " + (f"{x:.2f}" if x < math.inf else "none to 1"))
                           for solver, x in found if x is not None]

    def compare_crossings(self, spec):
        for motion, found in self.crossings(spec):
            for _, x, text in found:
                self.add(takes(spec["is"], x), f"{motion}, {text}")

    def wins(self, spec):
        """In how many drives each solver of b is the best of them, and the number of drives."""
        best, = self.terms({"best": spec["b"]}, spec)
        quantity, = spec["quantities"]
        wins, drives = dict.fromkeys(self.solvers(spec["b"]), 0), 0
        for point in self.results.points:
            least = best.value(point, quantity)
            if least is None:
                continue
            drives += 1
            for solver in wins:
                wins[solver] += self.median(solver, spec, point, quantity) <= least
        return wins, drives

    def compare_wins(self, spec):
        wins, drives = self.wins(spec)
        won, of = spec["share"]
        if drives > 0:
            self.add(of * wins[spec["a"]] >= won * drives,
                     f"best in {wins[spec['a']]} of {drives}")

    def bounds(self, spec):
        """(where, RMS error over RMS bound, its limit) over the motions of an x together, so that
        chance tells less."""
        for solver in self.solvers(spec["a"]):
            for quantity in spec["quantities"]:
                levels = {}
                for point in self.results.points:
                    error, bound = (self.results.statistic(point, solver, self.loop, stage,
                                                           quantity)
                                    for stage in ("refined", "bound"))
                    if error is None or bound is None:
                        continue
                    level = levels.setdefault(point.x, [0.0, 0.0, 0])
                    level[0] += error["rms"] * error["rms"]
                    level[1] += bound["rms"] * bound["rms"]
                    level[2] += self.results.rows[point, solver, self.loop].solved
                for x, (errors, bounds, pairs) in sorted(levels.items()):
                    if bounds > 0:
                        limit = 1 + 3 / math.sqrt(2 * DIMENSIONS * max(1, pairs))
                        yield (f"at {x:g}, {solver}, {quantity}", math.sqrt(errors / bounds),
                               max(ON_THE_BOUND, limit))

    def compare_bounds(self, spec):
        limits = []
        for where, ratio, limit in self.bounds(spec):
            limits.append(limit)
            self.add(ratio < limit, f"{where}: {shown(ratio)}")
        if limits and max(limits) > USELESS_LIMIT:
            self.too_few = f"the limit would be {span(limits)}; it has to be below " \
                           f"{shown(USELESS_LIMIT)}"

    def show_values(self, spec):
        since = f"from {spec['since']:g} to " if "since" in spec else ""
        for point in self.points(spec):
            parts = []
            for of in spec["show"]:
                spans = [span(self.median(solver, spec, point, quantity)
                              for solver in self.solvers(of)) for quantity in spec["quantities"]]
                names = [spec["stage"]] if "stage" in spec else []
                names += [of] if of != "all" else []
                parts.append(" ".join(names + [" and ".join(spans)]))
            yield f"{point.motion}, {since}{point.x:g} {self.unit}: {', '.join(parts)} " \
                  f"{UNITS[spec['quantities'][0]]}"

    def show_ratios(self, spec):
        first = {**self.entry["cases"][0], **spec}
        ratios = [a / b for _, _, a, _, b in self.comparisons(first) if b > 0]
        if ratios:
            yield f"{spec['text']} {span(ratios)}"

    def show_ranking(self, spec):
        order = []
        for solver in self.solvers("all"):
            values = [self.median(solver, spec, point, spec["quantity"])
                      for point in self.results.points]
            values = [value for value in values if value is not None]
            if values:
                order.append((statistics.median(values), solver))
        if order:
            yield f"{spec['text']}: " + ", ".join(f"{solver} {shown(value)}"
                                                  for value, solver in sorted(order))

    def show_crossings(self, spec):
        for motion, found in self.crossings(spec):
            yield f"{motion}: " + ", ".join(text for _, _, text in found)

    def show_wins(self, spec):
        wins, _ = self.wins(spec)
        yield f"{spec['text']}: " + ", ".join(f"{solver} {count}" for solver, count in wins.items())

    def show_bounds(self, spec):
        found = list(self.bounds(spec))
        yield f"RMS error over RMS bound {span(ratio for _, ratio, _ in found)}, " \
              f"limit {span(limit for _, _, limit in found)}"

    def show_pairs(self, _):
        pairs = self.results.fewest_pairs()
        if pairs > 0:
            yield f"medians of {pairs} pairs, 1 / sqrt(n) is {100 / math.sqrt(pairs):.0f} percent"

    def figures(self, key):
        show = {"values": self.show_values, "ratios": self.show_ratios,
                "ranking": self.show_ranking, "crossing": self.show_crossings,
                "wins": self.show_wins, "bound": self.show_bounds, "pairs": self.show_pairs}
        return [text for spec in self.entry.get(key, []) for text in show[spec["kind"]](spec)]

    def judge(self):
        """(verdict, figures, where it does not hold)."""
        compare = {"compare": self.compare, "crossing": self.compare_crossings,
                   "wins": self.compare_wins, "bound": self.compare_bounds}
        for spec in self.entry["cases"]:
            compare[spec.get("kind", "compare")](spec)
        if self.count == 0:
            return "not measured", "", ""
        figures = self.figures("figures")
        pairs, wanted = self.results.fewest_pairs(), self.entry.get("pairs", 0)
        if pairs < wanted:
            self.too_few = f"{pairs} pairs a point; it takes {wanted}"
        if self.too_few:
            return "too few pairs", "; ".join(figures), self.too_few
        most = f"holds in {self.held} of {self.count} cases"
        if self.held == self.count:
            return "confirmed", "; ".join(figures), ""
        if self.entry.get("majority") and 2 * self.held > self.count:
            return "confirmed", "; ".join(figures + [most]), ""
        partly = 4 * self.held >= 3 * self.count and not self.entry.get("majority")
        where = "; ".join(self.failed[:2])
        if self.count > 1:
            where = f"{most}; not in {where}"
        beside = "; ".join(self.figures("where_not"))
        return "partly" if partly else "not confirmed", "; ".join(figures), \
            f"{where}. {beside}" if beside else where
