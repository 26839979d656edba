// Drift of the trajectories of rigel_estimate: table and JSON.
#ifndef RIGEL_PROBLEMS_EVALUATION_DRIFT_REPORT_H_
#define RIGEL_PROBLEMS_EVALUATION_DRIFT_REPORT_H_

#include <string>

#include "rigel/problems/evaluation/estimate_report.h"

namespace rigel {

// Drift of report.trajectories that have a truth; 100 columns at most. Empty if none has.
std::string DriftTable(const EstimateReport& report);

// The value of "trajectories" in the JSON, its lines after the first indented by two blanks.
std::string TrajectoriesJson(const EstimateReport& report);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_DRIFT_REPORT_H_
