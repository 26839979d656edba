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
  Extremes ratios, raw_ratios;
  for (const std::string& motion : kMotions) {
    const ExperimentPoint exact{motion, "", 0.0}, off{motion, "", 1.0};
    for (const std::string& solver : SolversOf(experiment)) {
      if (!UsesPrior(solver)) continue;
      for (const Quantity q : kBoth) {
        const Value a = rows.Median(exact, solver, q, Stage::kRefined, loop);
        const Value b = rows.Median(off, solver, q, Stage::kRefined, loop);
        const Value raw_a = rows.Median(exact, solver, q, Stage::kRaw, loop);
        const Value raw_b = rows.Median(off, solver, q, Stage::kRaw, loop);
        if (!a || !b || !raw_a || !raw_b || !(*a > 0) || !(*raw_a > 0)) continue;
        ratios.Add(*b / *a);
        raw_ratios.Add(*raw_b / *raw_a);
        cases.Add(*b < kFlat * *a, motion + ", " + solver + ", " + Name(q) + ": " + Number(a) +
                                       " becomes " + Number(b));
      }
    }
  }
  cases.Figure("error at 1 deg over that at 0: refined " + ratios.Text() + ", raw " +
               raw_ratios.Text());
  return cases.Finish();
}

Claim OnTheBound(const ExperimentResults& results, const char* loop) {
  const char* experiment = "image-noise";
  const Rows rows(results, experiment);
  Cases cases("Rigel", experiment,
              std::string("the refined motion is on the Cramer-Rao bound under image noise (RMS "
                          "error at most 1.1 times it), loop ") +
                  loop);
  Extremes efficiency;
  const std::vector<ExperimentPoint> points = rows.Points();
  for (const std::string& solver : SolversOf(experiment)) {
    for (const Quantity q : kBoth) {
      // Over the motions of a noise level together: fewer chance differences.
      std::map<double, std::pair<double, double>> sums;
      for (const ExperimentPoint& point : points) {
        const SolverSummary* s = rows.Find(point, solver, loop);
        if (s == nullptr) continue;
        const auto& error = StatisticsOf(*s, Stage::kRefined, q);
        const auto& bound =
            q == Quantity::kRotation ? s->bound_rotation_deg : s->bound_direction_deg;
        if (!error || !bound) continue;
        sums[*point.x].first += error->rms * error->rms;
        sums[*point.x].second += bound->rms * bound->rms;
      }
      for (const auto& [x, sum] : sums) {
        if (!(sum.second > 0)) continue;
        const double ratio = std::sqrt(sum.first / sum.second);
        efficiency.Add(ratio);
        cases.Add(ratio < kFlat,
                  CsvNumber(x) + " px, " + solver + ", " + Name(q) + ": " + Number(ratio));
      }
    }
  }
  cases.Figure("RMS error over RMS bound " + efficiency.Text());
  return cases.Finish();
}

Claim HalfOfRaw(const ExperimentResults& results, const char* loop) {
  const char* experiment = "image-noise";
  const Rows rows(results, experiment);
  Cases cases("Rigel", experiment,
              std::string("at 0.5 px the refined direction error is at most half of the raw one, "
                          "loop ") +
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
