// Reports of rigel_estimate: tables for people, JSON ("rigel-estimate 1") and CSV for programs.
// Formats: docs/formats.md.
#ifndef RIGEL_PROBLEMS_EVALUATION_ESTIMATE_REPORT_H_
#define RIGEL_PROBLEMS_EVALUATION_ESTIMATE_REPORT_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/io/report_options.h"
#include "rigel/problems/trajectories/trajectory.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

struct MatchCount {
  int all = 0;
  bool any_inter = false;  // any between two cameras
  size_t rig = 0;          // RigNumber()
};

// The motions of many pairs; its lists go together.
struct EstimateReport {
  ReportOptions options;
  std::vector<FramePair> pairs;  // their rigs and matches are not used
  std::vector<MatchCount> matches;
  std::vector<MotionEstimate> estimates;
  RigTest rig_test;  // TestRigOfRun() of these
  // The chained motions, if requested. `refined`: Trajectory::estimate is refined.
  std::optional<std::vector<Trajectory>> trajectories;
  bool refined = true;
};

// One motion a row.
std::string EstimateTable(const EstimateReport& report);
std::string EstimateJson(const EstimateReport& report, bool times);
std::string EstimateCsv(const EstimateReport& report, bool times);

// Doubts about the rig, one line of printable text for each kind and camera pair: the first pair of
// frames with this doubt, and the number of files alike.
std::vector<std::string> RigDoubtLines(const EstimateReport& report);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_ESTIMATE_REPORT_H_
