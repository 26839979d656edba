// Reports of rigel_compare: tables for people, JSON ("rigel-report 1") and CSV for programs.
// Formats: docs/formats.md.
#ifndef RIGEL_PROBLEMS_EVALUATION_COMPARISON_REPORT_H_
#define RIGEL_PROBLEMS_EVALUATION_COMPARISON_REPORT_H_

#include <optional>
#include <string>
#include <vector>

#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/evaluation/shard.h"
#include "rigel/problems/io/report_options.h"
#include "rigel/problems/io/version.h"

namespace rigel {

// The content of a report of rigel_compare.
struct ComparisonReport {
  std::string version = RigelVersion();  // that made the results; empty: 0.1
  ReportOptions options;
  std::vector<SolverResults> solvers;  // at least one, all of the same pairs
  std::optional<Shard> shard;          // if the run had only a part of the files
  int num_files = 0;                   // of all shards together
};

// Medians over all pairs, one row a solver; 100 columns at most. Where every pair has a bound, a
// second table gives the efficiency, RMS error over RMS bound. Where there are summaries of
// sequences, SequenceTables() follows.
std::string ComparisonTable(const std::vector<SolverSummary>& summaries);

// With the results of each pair, one line a pair, if `per_pair` is true.
std::string ComparisonJson(const ComparisonReport& report,
                           const std::vector<SolverSummary>& summaries, bool per_pair);

// One row a pair and solver: status, errors, bound, times.
std::string ComparisonCsv(const std::vector<SolverResults>& solvers);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_COMPARISON_REPORT_H_
