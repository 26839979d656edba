// The output of rigel_calibrate_prior (format "rigel-prior-calibration 1", docs/formats.md), and
// the header lines of a calibration.
#ifndef RIGEL_PROBLEMS_CALIBRATION_CALIBRATION_REPORT_H_
#define RIGEL_PROBLEMS_CALIBRATION_CALIBRATION_REPORT_H_

#include <map>
#include <optional>
#include <string>

#include "rigel/problems/calibration/gravity_calibration.h"
#include "rigel/problems/calibration/plane_calibration.h"
#include "rigel/problems/io/report_options.h"

namespace rigel {

struct CalibrationReport {
  ReportOptions options;
  int pairs = 0;      // files read
  int estimated = 0;  // of them, with a motion
  Eigen::Vector3d start = Eigen::Vector3d::UnitY();
  std::optional<PlaneCalibration> plane;
  std::optional<GravityCalibration> gravity;
};

std::string CalibrationText(const CalibrationReport& report);
std::string CalibrationJson(const CalibrationReport& report);

// Lines by keyword, for ReplaceHeaderLines(); an empty line removes the old one. `normal` and
// `axis` are the normal of the plane. The sigma of `normal` is that of the calibration and of
// single motions together. A normal whose roll is not determined has no sigma. An axis has none
// either: how accurate it is depends on the angle of the rotation.
std::map<std::string, std::string> PlaneLines(const PlaneCalibration& plane, bool normal,
                                              bool axis);

// The gravity lines of a pair, turned into the body frame; none if it states none.
std::map<std::string, std::string> GravityLines(const GravityCalibration& gravity,
                                                const MotionPrior& stated);

// The beginning of the comment line that marks a file as calibrated; `line` is normal, axis or
// gravity. Without the mark, gravity could be turned twice.
std::string CalibrationMark(const std::string& line);

// These comment lines by their beginnings, for ReplaceHeaderLines(), for what is determined.
std::map<std::string, std::string> MarkLines(const CalibrationReport& report, bool normal,
                                             bool axis);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_CALIBRATION_CALIBRATION_REPORT_H_
