// What rigel_calibrate_prior prints (format "rigel-prior-calibration 1", docs/formats.md), and the
// header lines that a calibration gives.
#ifndef RIGEL_PROBLEMS_CALIBRATION_CALIBRATION_REPORT_H_
#define RIGEL_PROBLEMS_CALIBRATION_CALIBRATION_REPORT_H_

#include <map>
#include <optional>
#include <string>

#include "rigel/problems/calibration/prior_calibration.h"
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

// Lines by keyword, for ReplaceHeaderLines(). `normal` with its sigma, of the calibration and of
// single motions, and `axis` have the plane's normal; an empty line takes out what stood there. A
// normal whose roll is not determined has no sigma, nor has an axis: how far a rotation is about it
// depends on how large it is.
std::map<std::string, std::string> PlaneLines(const PlaneCalibration& plane, bool normal,
                                              bool axis);

// The gravity lines of a pair, turned into the body frame; none if it states none.
std::map<std::string, std::string> GravityLines(const GravityCalibration& gravity,
                                                const MotionPrior& stated);

// How the comment line begins that tells a file whose `line` (normal, axis, gravity) is calibrated.
// Files calibrated and not look alike otherwise, and gravity must not be turned twice.
std::string CalibrationMark(const std::string& line);

// Those comment lines by their beginnings, for ReplaceHeaderLines(): of what is determined.
std::map<std::string, std::string> MarkLines(const CalibrationReport& report, bool normal,
                                             bool axis);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_CALIBRATION_CALIBRATION_REPORT_H_
