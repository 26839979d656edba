// What the matches of a run say about the calibration of its rig (rig_doubts.h), as JSON and in
// words. Not installed: users need no JSON library.
#ifndef RIGEL_PROBLEMS_EVALUATION_RIG_TEST_REPORT_H_
#define RIGEL_PROBLEMS_EVALUATION_RIG_TEST_REPORT_H_

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "rigel/core/rig.h"
#include "rigel/problems/evaluation/estimate_report.h"
#include "rigel/refine/rig_doubts.h"

namespace rigel {

// A number that equal rigs have in common.
size_t RigNumber(const Rig& rig);

// The test over the pairs that have the rig of the first one.
RigTest TestRigOfRun(const EstimateReport& report);

nlohmann::ordered_json RigTestJson(const RigTest& test);

// "camera 1: pitch -0.022 +- 0.001 deg in 50 pairs (p < 1e-9): ...": the cameras and turns that are
// off, in one line. Empty if the test does not say that the rig is off.
std::string RigTestLine(const RigTest& test);
// The rig is off if chance makes such a score this seldom, with the errors of the calibration.
inline constexpr double kRigIsOff = 1e-3;

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_RIG_TEST_REPORT_H_
