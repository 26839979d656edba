// A SolverSummary as JSON, as in the reports of rigel_compare and rigel_experiment. Not installed:
// users need no JSON library.
#ifndef RIGEL_PROBLEMS_EVALUATION_SUMMARY_JSON_H_
#define RIGEL_PROBLEMS_EVALUATION_SUMMARY_JSON_H_

#include <nlohmann/json.hpp>

#include "rigel/problems/evaluation/comparison.h"

namespace rigel {

// Median, mean, RMS and 90th percentile, times `unit`.
nlohmann::ordered_json StatisticsJson(const Statistics& statistics, double unit = 1.0);

nlohmann::ordered_json SummaryJson(const SolverSummary& summary);

// Numbers come back as they were, to the last bit. Throws the library's exceptions on what
// SummaryJson() does not write.
SolverSummary ParseSummary(const nlohmann::ordered_json& json);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_SUMMARY_JSON_H_
