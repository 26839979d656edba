// What Rigel adds to the paper: the refinement, against the raw motions and the bound.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "rigel/minimal/catalogue.h"
#include "rigel/problems/claim_cases.h"
#include "rigel/problems/csv.h"

namespace rigel::claims {
namespace {

const Names kMotions = {"forward", "random", "sideways"};

// Of medians, and of RMS errors over RMS bounds: what counts as no difference.
constexpr double kFlat = 1.1;

struct Extremes {
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  void Add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  std::string Text() const { return Range(low, high); }
};

const Names& SolversOf(const char* experiment) { return FindExperiment(experiment)->solvers; }

bool UsesPrior(const std::string& solver) { return FindSolver(solver)->prior != PriorKind::kNone; }

Claim FlatUnderPriorNoise(const ExperimentResults& results, const char* experiment,
                          const char* loop, const std::string& kind) {
  const Rows rows(results, experiment);
  Cases cases("Rigel", experiment,
              "refined errors stay the same (within a tenth) to 1 deg of " + kind +
                  " error, all solvers, loop " + loop);
  std::vector<std::pair<std::string, Quantity>> cells;
  for (const std::string& solver : SolversOf(experiment)) {
    if (!UsesPrior(solver)) continue;
    for (const Quantity q : kBoth) cells.emplace_back(solver, q);
  }
  Extremes ratios, raw_ratios;
  for (const std::string& motion : kMotions) {
    const ExperimentPoint exact{motion, "", 0.0};
    for (const ExperimentPoint& off : rows.Points()) {
      if (off.motion != motion || !(*off.x > 0)) continue;
      for (const auto& [solver, q] : cells) {
        const Value a = rows.Median(exact, solver, q, Stage::kRefined, loop);
        const Value b = rows.Median(off, solver, q, Stage::kRefined, loop);
        const Value raw_a = rows.Median(exact, solver, q, Stage::kRaw, loop);
        const Value raw_b = rows.Median(off, solver, q, Stage::kRaw, loop);
        if (!a || !b || !raw_a || !raw_b || !(*a > 0) || !(*raw_a > 0)) continue;
        ratios.Add(*b / *a);
        raw_ratios.Add(*raw_b / *raw_a);
        cases.Add(*b < kFlat * *a, PointName(off) + ", " + solver + ", " + Name(q) + ": " +
                                       Number(a) + " becomes " + Number(b));
      }
    }
  }
  cases.Figure("error at up to 1 deg over that at 0: refined " + ratios.Text() + ", raw " +
               raw_ratios.Text());
  cases.Reason(
      "A raw motion that follows a wrong prior leaves other matches as inliers, and the refinement "
      "begins with those; " +
      Scatter(rows));
  return cases.Finish();
}

// What the RMS error over RMS bound of an efficient estimate stays below: the RMS of n errors in d
// dimensions, of about the same size, scatters by 1 / sqrt(2 n d). The errors are of 2 (direction)
// or 3 (rotation) dimensions of unlike size: 1.5 are taken. From 300 pairs on it is 1.1.
double EfficiencyLimit(int pairs) {
  return std::max(kFlat, 1.0 + 3.0 / std::sqrt(3.0 * std::max(1, pairs)));
}

// Above this limit the verdict would say little.
constexpr double kUselessLimit = 1.3;

// With fewer pairs three standard errors of a ratio of medians, each 1 / sqrt(n), exceed a half.
constexpr int kFewestForHalf = 36;

Claim OnTheBound(const ExperimentResults& results, const char* loop) {
  const char* experiment = "image-noise";
  const Rows rows(results, experiment);
  Cases cases("Rigel", experiment,
              std::string("the refined motion is on the Cramer-Rao bound under image noise (RMS "
                          "error over bound at most 1.1 or, with few pairs, 1 + 3 standard errors "
                          "of it: 1 / sqrt(3 n) for n pairs), loop ") +
                  loop);
  Extremes efficiency, limits;
  const std::vector<ExperimentPoint> points = rows.Points();
  for (const std::string& solver : SolversOf(experiment)) {
    for (const Quantity q : kBoth) {
      // Over the motions of a noise level together: fewer chance differences.
      struct Sums {
        double errors = 0.0, bounds = 0.0;
        int pairs = 0;
      };
      std::map<double, Sums> levels;
      for (const ExperimentPoint& point : points) {
        const SolverSummary* s = rows.Find(point, solver, loop);
        if (s == nullptr) continue;
        const auto& error = StatisticsOf(*s, Stage::kRefined, q);
        const auto& bound =
            q == Quantity::kRotation ? s->bound_rotation_deg : s->bound_direction_deg;
        if (!error || !bound) continue;
        Sums& level = levels[*point.x];
        level.errors += error->rms * error->rms;
        level.bounds += bound->rms * bound->rms;
        level.pairs += s->pairs - s->failures;
      }
      for (const auto& [x, level] : levels) {
        if (!(level.bounds > 0)) continue;
        const double ratio = std::sqrt(level.errors / level.bounds);
        const double limit = EfficiencyLimit(level.pairs);
        efficiency.Add(ratio);
        limits.Add(limit);
        cases.Add(ratio < limit,
                  CsvNumber(x) + " px, " + solver + ", " + Name(q) + ": " + Number(ratio));
      }
    }
  }
  cases.Figure("RMS error over RMS bound " + efficiency.Text() + ", limit " + limits.Text());
  if (limits.high > kUselessLimit) {
    cases.TooFew("the limit would be " + limits.Text() + "; it has to be below " +
                 Number(kUselessLimit));
  }
  cases.Reason(
      "The refinement takes the inliers of the raw motion; the threshold is at least 0.5 px, and "
      "where the raw motion is off by more, right matches are left out");
  return cases.Finish();
}

Claim HalfOfRaw(const ExperimentResults& results, const char* loop) {
  const char* experiment = "image-noise";
  const Rows rows(results, experiment);
  Cases cases("Rigel", experiment,
              std::string("at 0.5 px the refined direction error is at most half of the raw one "
                          "(medians of 36 pairs or more), loop ") +
                  loop);
  Extremes ratios;
  for (const std::string& motion : kMotions) {
    for (const std::string& solver : SolversOf(experiment)) {
      const ExperimentPoint at{motion, "", 0.5};
      const Value raw = rows.Median(at, solver, Quantity::kDirection, Stage::kRaw, loop);
      const Value refined = rows.Median(at, solver, Quantity::kDirection, Stage::kRefined, loop);
      if (!raw || !refined || !(*raw > 0)) continue;
      ratios.Add(*refined / *raw);
      cases.Add(*refined <= 0.5 * *raw,
                motion + ", " + solver + ": " + Number(refined) + " of " + Number(raw));
    }
  }
  cases.Figure("refined over raw " + ratios.Text());
  const int pairs = rows.FewestPairs();
  if (pairs < kFewestForHalf) {
    cases.TooFew(std::to_string(pairs) + " pairs a point; it takes " +
                 std::to_string(kFewestForHalf));
  }
  cases.Reason(
      "The raw motion is the best of 100 samples or more and, in loop rigel, optimized on its "
      "inliers: some come near the refined one");
  return cases.Finish();
}

Claim FirstOrder(const ExperimentResults& results) {
  const char* experiment = "rotation-angle";
  const Rows rows(results, experiment);
  const Quantity q = Quantity::kRotation;
  Cases cases("Rigel", experiment,
              "polishing keeps the first-order 4pt-approx as accurate as the exact 4pt to 20 deg "
              "(rotation, within a quarter); refined, all three are the same (within a tenth)");
  for (const ExperimentPoint& point : rows.Points()) {
    const Value exact = rows.Median(point, "4pt", q);
    const Value polished = rows.Median(point, "4pt-approx-polished", q);
    const Value plain = rows.Median(point, "4pt-approx", q);
    if (!exact || !polished || !plain) continue;
    cases.Add(*polished < 1.25 * *exact,
              PointName(point) + ": polished " + Number(polished) + ", exact " + Number(exact));
    const Value best = rows.Median(point, "4pt", q, Stage::kRefined);
    for (const char* solver : {"4pt-approx", "4pt-approx-polished"}) {
      const Value refined = rows.Median(point, solver, q, Stage::kRefined);
      if (!refined || !best) continue;
      cases.Add(*refined < kFlat * *best, PointName(point) + ": " + solver + " refined " +
                                              Number(refined) + ", 4pt " + Number(best));
    }
    if (*point.x < 5) continue;
    cases.Figure(CsvNumber(*point.x) + " deg: raw 4pt-approx " + Number(plain) + ", polished " +
                 Number(polished) + ", exact " + Number(exact) + ", refined " + Number(best));
  }
  cases.Reason(
      "Polishing begins at the first-order solution, whose error grows with the angle's square: "
      "from there not every sample comes to the exact one; " +
      Scatter(rows));
  return cases.Finish();
}

Claim Scale(const ExperimentResults& results) {
  const char* experiment = "inter-share";
  const Rows rows(results, experiment);
  Cases cases(
      "Rigel", experiment,
      "a quarter of inter-camera matches or more gives the scale within 1 percent, refined");
  for (const ExperimentPoint& point : rows.Points()) {
    Extremes refined;
    bool any = false;
    for (const std::string& solver : SolversOf(experiment)) {
      const SolverSummary* s = rows.Find(point, solver, kRigelLoop);
      if (s == nullptr) continue;
      const Value percent =
          s->refined_scale ? Value(100.0 * s->refined_scale->median) : std::nullopt;
      if (percent) refined.Add(*percent);
      any = any || percent.has_value();
      if (*point.x < 25) continue;
      cases.Add(percent && *percent < 1.0,
                PointName(point) + ", " + solver + ": " + Number(percent) + " %");
    }
    cases.Figure(CsvNumber(*point.x) + " % of the matches: " +
                 (any ? refined.Text() + " %" : std::string("not observable")));
  }
  cases.Reason("The scale comes from the matches between the cameras alone; " + Scatter(rows));
  return cases.Finish();
}

}  // namespace

std::vector<Claim> RefinementClaims(const ExperimentResults& results) {
  return {FlatUnderPriorNoise(results, "pitch-noise", kRigelLoop, "pitch"),
          FlatUnderPriorNoise(results, "roll-noise", kRigelLoop, "roll"),
          FlatUnderPriorNoise(results, "pitch-noise", kPaperLoop, "pitch"),
          FlatUnderPriorNoise(results, "roll-noise", kPaperLoop, "roll"),
          OnTheBound(results, kRigelLoop),
          OnTheBound(results, kPaperLoop),
          HalfOfRaw(results, kRigelLoop),
          HalfOfRaw(results, kPaperLoop),
          FirstOrder(results),
          Scale(results)};
}

}  // namespace rigel::claims
