// Common parts of all JSON reports. Not installed: users need no JSON library.
#ifndef RIGEL_PROBLEMS_IO_REPORT_JSON_H_
#define RIGEL_PROBLEMS_IO_REPORT_JSON_H_

#include <string>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "rigel/problems/io/report_options.h"
#include "rigel/problems/io/version.h"

namespace rigel {

// A report with its format and the version that made it. Reports of 0.1 (empty) do not state it.
nlohmann::ordered_json NewReport(const char* format, const std::string& version = RigelVersion());

// The options that made a report.
nlohmann::ordered_json OptionsJson(const ReportOptions& options);

// [w, x, y, z] of a rotation.
nlohmann::ordered_json QuaternionJson(const Eigen::Matrix3d& R);

// Sets a member. Does nothing if the value is negative or not finite, which means unknown.
void PutKnown(const char* key, double value, nlohmann::ordered_json* object);

// The text of a value, as dump() makes it; on one line if `indent` is negative. JSON has no number
// that is not finite: such a member is left out, and so is an array that contains one. Bytes that
// are not UTF-8 are replaced.
std::string JsonText(nlohmann::ordered_json value, int indent);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_REPORT_JSON_H_
