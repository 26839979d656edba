// The paper's claims on KITTI (its tables 2 to 4), on the motions of KITTI with simulated points.
#include <algorithm>

#include "rigel/problems/claim_cases.h"
#include "rigel/problems/table.h"

namespace rigel::claims {
namespace {

constexpr char kExperiment[] = "kitti-motions";

const Names kSixDof = {"17pt-li", "6pt-stewenius", "6pt-ventura"};
const Names kFourPoint = {"4pt-lee", "4pt-liu", "4pt-approx", "4pt-axis-approx"};
const Names kAll = {"17pt-li", "6pt-stewenius", "6pt-ventura",     "4pt-lee",
                    "4pt-liu", "4pt-approx",    "4pt-axis-approx", "3pt-approx"};

// The median over the sequences of a solver's medians.
Value Middle(const Rows& rows, const std::string& solver, Quantity q) {
  std::vector<double> values;
  for (const ExperimentPoint& point : rows.Points()) {
    if (const Value value = rows.Median(point, solver, q)) values.push_back(*value);
  }
  const auto statistics = ComputeStatistics(values);
  return statistics ? Value(statistics->median) : std::nullopt;
}

std::string Ranking(const Rows& rows, Quantity q) {
  std::vector<std::pair<double, std::string>> order;
  for (const std::string& solver : kAll) {
    if (const Value value = Middle(rows, solver, q)) order.emplace_back(*value, solver);
  }
  std::sort(order.begin(), order.end());
  std::string text;
  for (const auto& [value, solver] : order) {
    AppendItem(", ", solver + " " + Number(value), &text);
  }
  return text;
}

std::string TimeRanking(const Rows& rows) {
  std::vector<std::pair<double, std::string>> order;
  for (const std::string& solver : kAll) {
    if (const Value value = rows.MeanTime(solver)) order.emplace_back(*value, solver);
  }
  std::sort(order.begin(), order.end());
  std::string text;
  for (const auto& [value, solver] : order) {
    AppendItem(", ", solver + " " + FormatNumber(value, 2), &text);
  }
  return text;
}

// In how many sequences each 4-point solver is the best of the four.
std::string Wins(const Rows& rows, Quantity q, const std::string& wanted, int* won, int* all) {
  std::string text;
  *won = *all = 0;
  for (const std::string& solver : kFourPoint) {
    int wins = 0, sequences = 0;
    for (const ExperimentPoint& point : rows.Points()) {
      const Value value = rows.Median(point, solver, q);
      const Value least = rows.Least(point, kFourPoint, q);
      if (!value || !least) continue;
      ++sequences;
      if (*value <= *least) ++wins;
    }
    *all = std::max(*all, sequences);
    if (solver == wanted) *won = wins;
    AppendItem(", ", solver + " " + std::to_string(wins), &text);
  }
  return text;
}

}  // namespace

std::vector<Claim> KittiClaims(const ExperimentResults& results) {
  const Rows rows(results, kExperiment);
  const Quantity rotation = Quantity::kRotation, direction = Quantity::kDirection;
  Cases four("paper", kExperiment, "the 4-point solvers beat the 6-DoF ones in rotation");
  Cases translation("paper", kExperiment,
                    "the 4-point solvers beat 17pt-li and 6pt-stewenius in direction");
  Cases three("paper", kExperiment,
              "3pt-approx is about as accurate as the 4-point solvers in rotation (within half)");
  Cases three_dir("paper", kExperiment, "3pt-approx beats 17pt-li and 6pt-stewenius in direction");
  for (const ExperimentPoint& point : rows.Points()) {
    const std::string at = PointName(point);
    four.Less(at, rows.Largest(point, kFourPoint, rotation), "worst 4-point",
              rows.Least(point, kSixDof, rotation), "best 6-DoF");
    const Value linear = rows.Least(point, {"17pt-li", "6pt-stewenius"}, direction);
    translation.Less(at, rows.Largest(point, kFourPoint, direction), "worst 4-point", linear,
                     "best of the two");
    three_dir.Less(at, rows.Median(point, "3pt-approx", direction), "3pt-approx", linear,
                   "best of the two");
    const Value a = rows.Median(point, "3pt-approx", rotation);
    const Value b = rows.Largest(point, kFourPoint, rotation);
    if (a && b) three.Add(*a < 1.5 * *b, at + ": " + Number(a) + ", worst 4-point " + Number(b));
  }
  four.Figure("medians over the drives, deg: " + Ranking(rows, rotation));
  translation.Figure("medians over the drives, deg: " + Ranking(rows, direction));
  const auto pair_of = [&](Quantity q) {
    return "3pt-approx " + Number(Middle(rows, "3pt-approx", q)) + ", 4pt-approx " +
           Number(Middle(rows, "4pt-approx", q)) + ", 17pt-li " +
           Number(Middle(rows, "17pt-li", q)) + " deg";
  };
  three.Figure(pair_of(rotation));
  three_dir.Figure(pair_of(direction));

  const std::string simulated =
      "Motions are KITTI's, points simulated and gravity and axis exact, unlike the paper's";
  four.Reason(simulated);
  translation.Reason(simulated);
  three_dir.Reason(simulated);
  three.Reason(
      "A car pitches and rolls: 3pt-approx leaves that out of its model, while the 4-point solvers "
      "get it here from an exact prior");

  // "In partial sequences" and "superior in 00, 01, 05, 06 and 10": 5 of 11 in both tables.
  constexpr int kPaperWins = 5;
  int won = 0, all = 0;
  Cases lee("paper", kExperiment,
            "4pt-lee is slightly best in rotation in several drives (5 of 11)");
  const std::string lee_wins = Wins(rows, rotation, "4pt-lee", &won, &all);
  if (all > 0)
    lee.Add(11 * won >= kPaperWins * all,
            "best in " + std::to_string(won) + " of " + std::to_string(all));
  lee.Reason("The priors are exact here, an IMU's in the paper");
  lee.Figure("best of the four in drives: " + lee_wins);
  Cases axis("paper", kExperiment,
             "4pt-axis-approx is marginally best in direction in several drives (5 of 11)");
  const std::string axis_wins = Wins(rows, direction, "4pt-axis-approx", &won, &all);
  if (all > 0)
    axis.Add(11 * won >= kPaperWins * all,
             "best in " + std::to_string(won) + " of " + std::to_string(all));
  axis.Reason("The priors are exact here, an IMU's in the paper");
  axis.Figure("best of the four in drives: " + axis_wins);

  Cases fastest("paper", kExperiment, "4pt-axis-approx is the fastest solver in RANSAC");
  Cases linear_fast("paper", kExperiment,
                    "17pt-li, with one solution, is faster in RANSAC than 4pt-lee, 4pt-approx and "
                    "3pt-approx");
  const Value axis_time = rows.MeanTime("4pt-axis-approx");
  for (const std::string& solver : kAll) {
    const Value time = rows.MeanTime(solver);
    if (solver != "4pt-axis-approx") fastest.Less("mean ms", axis_time, "axis", time, solver);
    if (solver == "4pt-lee" || solver == "4pt-approx" || solver == "3pt-approx") {
      linear_fast.Less("mean ms", rows.MeanTime("17pt-li"), "17pt-li", time, solver);
    }
  }
  fastest.Figure("mean ms: " + TimeRanking(rows));

  Cases limit("paper", kExperiment, "the 6-DoF solvers reach the limit of iterations");
  std::string iterations;
  const double max_iterations =
      ExperimentEstimate("17pt-li", kPaperLoop, 0.5).ransac.max_iterations;
  for (const std::string& solver : kAll) {
    std::vector<double> values;
    for (const ExperimentPoint& point : rows.Points()) {
      const SolverSummary* s = rows.Find(point, solver, kPaperLoop);
      if (s == nullptr || !s->iterations) continue;
      values.push_back(s->iterations->median);
      if (std::find(kSixDof.begin(), kSixDof.end(), solver) != kSixDof.end()) {
        limit.Add(s->iterations->median >= max_iterations,
                  PointName(point) + ": " + solver + " " + FormatNumber(s->iterations->median, 0));
      }
    }
    if (const auto s = ComputeStatistics(values)) {
      AppendItem(", ", solver + " " + FormatNumber(s->median, 0), &iterations);
    }
  }
  limit.Figure("iterations: " + iterations);
  linear_fast.Figure("mean ms as above; iterations: " + iterations);
  const std::string implementation =
      "Times are of Rigel's own solvers and scoring; at least 100 and at most 1000 iterations are "
      "Rigel's choice, the paper does not state its numbers";
  fastest.Reason(implementation + "; iterations: " + iterations);
  linear_fast.Reason(implementation + "; a sample of 17 without outliers is rare");
  limit.Reason(
      "At most 1000 iterations are Rigel's choice, the paper does not state its limit; a fifth of "
      "the simulated matches are outliers");
  Cases slower("paper", kExperiment,
               "3pt-approx is slightly slower in RANSAC than 4pt-liu, 4pt-axis-approx and "
               "4pt-approx (to 2.5 times)");
  const Value three_time = rows.MeanTime("3pt-approx");
  for (const char* solver : {"4pt-liu", "4pt-axis-approx", "4pt-approx"}) {
    const Value time = rows.MeanTime(solver);
    if (!three_time || !time) continue;
    slower.Add(*three_time > *time && *three_time < 2.5 * *time,
               std::string("mean ms: 3pt-approx ") + Number(three_time) + ", " + solver + " " +
                   Number(time));
  }
  slower.Figure("mean ms as above");
  slower.Reason(implementation +
                ". The paper's own table of times in RANSAC has 3pt-approx slowest of them, that "
                "of single calls between 4pt-approx and 4pt-lee");
  return {four.Finish(),  translation.Finish(), lee.Finish(),     axis.Finish(),
          three.Finish(), three_dir.Finish(),   fastest.Finish(), linear_fast.Finish(),
          limit.Finish(), slower.Finish()};
}

}  // namespace rigel::claims
