// Reports of rigel_compare and rigel_estimate: tables for people, JSON ("rigel-report 1",
// "rigel-estimate 1") and CSV for programs. Formats: docs/formats.md.
#ifndef RIGEL_PROBLEMS_REPORT_H_
#define RIGEL_PROBLEMS_REPORT_H_

#include <string>
#include <utility>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/comparison.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

// Names and values of the options that made a report, in the order given.
using ReportOptions = std::vector<std::pair<std::string, std::string>>;

// Medians over the pairs, one row an entry; 100 columns at most. Where every pair has a bound, a
// second table gives the efficiency, RMS error over RMS bound.
std::string ComparisonTable(const std::vector<SolverSummary>& summaries);
std::string ComparisonJson(const std::vector<SolverSummary>& summaries, int num_pairs,
                           const ReportOptions& options);

// One row a pair and solver: status, errors, bound, times.
std::string ComparisonCsv(
    const std::vector<std::pair<std::string, std::vector<PairResult>>>& results);

// One motion a row. `pairs` and `estimates` go together.
std::string EstimateTable(const std::vector<FramePair>& pairs,
                          const std::vector<MotionEstimate>& estimates);
std::string EstimateJson(const std::vector<FramePair>& pairs,
                         const std::vector<MotionEstimate>& estimates,
                         const ReportOptions& options);
std::string EstimateCsv(const std::vector<FramePair>& pairs,
                        const std::vector<MotionEstimate>& estimates);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_REPORT_H_
