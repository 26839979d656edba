// What all JSON reports share. Not installed: the JSON library is the build's alone.
#ifndef RIGEL_PROBLEMS_IO_REPORT_JSON_H_
#define RIGEL_PROBLEMS_IO_REPORT_JSON_H_

#include <string>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "rigel/problems/io/report_options.h"
#include "rigel/problems/io/version.h"

namespace rigel {

// Its format and the version whose results it holds, which reports of 0.1 (empty) do not state.
nlohmann::ordered_json NewReport(const char* format, const std::string& version = RigelVersion());

// The options that made a report.
nlohmann::ordered_json OptionsJson(const ReportOptions& options);

// [w, x, y, z] of a rotation.
nlohmann::ordered_json QuaternionJson(const Eigen::Matrix3d& R);

// Sets a member to a value that is unknown where it is negative or not finite: there is none then.
void PutKnown(const char* key, double value, nlohmann::ordered_json* object);

// The text of a value, as dump() has it, on one line if `indent` is negative. Numbers that are not
// finite do not exist in JSON: a member that is one is left out, and so is an array that holds one,
// as a matrix is nothing without all of its entries. Bytes that are no UTF-8 are replaced.
std::string JsonText(nlohmann::ordered_json value, int indent);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_REPORT_JSON_H_
