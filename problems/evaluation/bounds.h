// Bounds on the statistics of a report of rigel_compare. They turn recordings into a regression
// test (docs/regression.md).
#ifndef RIGEL_PROBLEMS_EVALUATION_BOUNDS_H_
#define RIGEL_PROBLEMS_EVALUATION_BOUNDS_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rigel/problems/evaluation/comparison.h"

namespace rigel {

// "refined.rotation_deg.median at most 0.03", over all pairs.
struct StatisticBound {
  std::string solver;     // empty: each solver of the report
  std::string statistic;  // its path in an entry of the JSON report, with dots
  double limit = 0.0;
};

struct ReportBounds {
  std::vector<StatisticBound> statistics;
  std::optional<int> max_failures;  // of each solver
  // Entries of an earlier report, each a bound on the entry of the same solver and sequence:
  //   - the number of pairs is the same;
  //   - failures and refined errors (raw errors where there are no refined ones) exceed the earlier
  //     ones by at most `tolerance`, a fraction;
  //   - the number of pairs with an observable direction falls by at most `tolerance`.
  std::vector<SolverSummary> baseline;
  double tolerance = 0.0;
};

// "STATISTIC:LIMIT,SOLVER/STATISTIC:LIMIT,...". False with a message if it is anything else, there
// is no such solver or no report can have the statistic.
bool ParseStatisticBounds(std::string_view text, std::vector<StatisticBound>* bounds,
                          std::string* error);

// The entries of a report (format "rigel-report 1"); `name` stands for its path in messages. False
// with a message, one line of printable text, if it is none or has no entry.
bool ParseBaseline(std::string_view text, const std::string& name,
                   std::vector<SolverSummary>* baseline, std::string* error);

// One line for each bound that `summaries` miss. They include the summaries over all sequences. A
// missing statistic misses its bound.
std::vector<std::string> MissedBounds(const ReportBounds& bounds,
                                      const std::vector<SolverSummary>& summaries);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_BOUNDS_H_
