// Reports of rigel_compare and rigel_estimate: tables for people, JSON ("rigel-report 1",
// "rigel-estimate 1") and CSV for programs. Formats: docs/formats.md.
#ifndef RIGEL_PROBLEMS_EVALUATION_REPORT_H_
#define RIGEL_PROBLEMS_EVALUATION_REPORT_H_

#include <optional>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/evaluation/shard.h"
#include "rigel/problems/io/report_options.h"
#include "rigel/problems/io/version.h"
#include "rigel/problems/trajectories/trajectory.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

// All that a report of rigel_compare is made of.
struct ComparisonReport {
  std::string version = RigelVersion();  // whose results they are; empty: of 0.1
  ReportOptions options;
  std::vector<SolverResults> solvers;  // at least one, all of the same pairs
  std::optional<Shard> shard;          // of a run over a part of the files, ...
  int num_files = 0;                   // ... which are so many in all
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

struct MatchCount {
  int all = 0;
  bool any_inter = false;  // any between two cameras
};

// The motions of many pairs; its lists go together.
struct EstimateReport {
  ReportOptions options;
  std::vector<FramePair> pairs;  // their rigs and matches are not looked at
  std::vector<MatchCount> matches;
  std::vector<MotionEstimate> estimates;
  // The motions chained, where that was asked for; `refined` tells what their
  // `estimate` is.
  std::optional<std::vector<Trajectory>> trajectories;
  bool refined = true;
};

// One motion a row.
std::string EstimateTable(const EstimateReport& report);
std::string EstimateJson(const EstimateReport& report, bool times);
std::string EstimateCsv(const EstimateReport& report, bool times);

// What contradicts the rig, as lines of printable text: of one kind and camera pair the first, with
// its pair and the number of others.
std::vector<std::string> RigDoubtLines(const EstimateReport& report);

// Drift of report.trajectories that have a truth; 100 columns at most. Empty if none has.
std::string DriftTable(const EstimateReport& report);

// The value of "trajectories" in the JSON, its lines after the first indented by two blanks.
std::string TrajectoriesJson(const EstimateReport& report);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_REPORT_H_
