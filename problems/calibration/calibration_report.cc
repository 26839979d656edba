#include "rigel/problems/calibration/calibration_report.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(AngleBetween(a, b));
}

std::string VectorText(const Eigen::Vector3d& v) {
  return "(" + FormatNumber(v.x(), 5) + ", " + FormatNumber(v.y(), 5) + ", " +
         FormatNumber(v.z(), 5) + ")";
}

std::string DegText(double radians) { return FormatNumber(RadToDeg(radians), 4) + " deg"; }

std::string SigmaText(double radians) {
  return radians < 0 ? "not observable" : "sd " + DegText(radians);
}

// In lines of 100 columns at most, indented by two.
std::string Wrapped(const std::string& message) {
  std::istringstream words(message);
  std::string text, line = " ";
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > 100) {
      text += line + "\n";
      line = " ";
    }
    line += " " + word;
  }
  return text + line + "\n";
}

Json VectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void PutDeg(const char* key, double radians, Json* json) { PutKnown(key, RadToDeg(radians), json); }

double TurnDeg(const Eigen::Matrix3d& C) { return RadToDeg(LogSO3(C).norm()); }

std::string DirectionLine(const char* keyword, const Eigen::Vector3d& v) {
  return std::string(keyword) + " " + CsvNumber(v.x()) + " " + CsvNumber(v.y()) + " " +
         CsvNumber(v.z());
}

// Of a single pair: that of the calibration and the spread of pairs.
double NormalSigma(const PlaneCalibration& plane) {
  return std::hypot(plane.translation_spread, std::max(plane.tilt_sigma, plane.roll_sigma));
}

}  // namespace

std::string CalibrationText(const CalibrationReport& report) {
  std::string text = std::to_string(report.estimated) + " motions of " +
                     std::to_string(report.pairs) + (report.pairs == 1 ? " pair\n" : " pairs\n");
  if (report.plane) {
    const PlaneCalibration& p = *report.plane;
    text += "\nmotion plane, from " + std::to_string(p.translations) + " translations and " +
            std::to_string(p.rotations) + " rotations\n";
    if (p.level == CalibrationLevel::kNone) {
      text += Wrapped("not determined: " + p.message);
    } else {
      text += "  normal                         " + VectorText(p.normal) + ", " +
              FormatNumber(AngleDeg(p.normal, report.start), 3) + " deg from the start\n";
      text += "  start                          " + VectorText(report.start) + "\n";
      text += "  tilt towards the driving       " + SigmaText(p.tilt_sigma) + ", driving along " +
              VectorText(p.driving) + "\n";
      text += "  roll about it                  " + SigmaText(p.roll_sigma) + "\n";
      text += "  spread of single motions       translation " + DegText(p.translation_spread) +
              ", rotation " + DegText(p.rotation_spread) + "\n";
      if (!p.message.empty()) text += Wrapped(p.message);
    }
  }
  if (report.gravity) {
    const GravityCalibration& g = *report.gravity;
    text += "\nmounting of the gravity's frame, from " + std::to_string(g.pairs) +
            " pairs that turn enough\n";
    if (g.level == CalibrationLevel::kNone) {
      text += Wrapped("not determined: " + g.message);
    } else {
      text += "  body from it, rotation vector  " + VectorText(LogSO3(g.C)) + " rad, " +
              FormatNumber(TurnDeg(g.C), 3) + " deg\n";
      text += "  tilt                           " + SigmaText(g.tilt_sigma) + "\n";
      text += "  turn about the vertical        " + SigmaText(g.yaw_sigma) + "\n";
      text += "  spread of single pairs         " + DegText(g.spread) + "\n";
      if (!g.message.empty()) text += Wrapped(g.message);
    }
  }
  return text;
}

std::string CalibrationJson(const CalibrationReport& report) {
  Json json = NewReport("rigel-prior-calibration 1");
  json["options"] = OptionsJson(report.options);
  json["pairs"] = report.pairs;
  json["estimated"] = report.estimated;
  if (report.plane) {
    const PlaneCalibration& p = *report.plane;
    Json plane = {{"level", CalibrationLevelName(p.level)},
                  {"translations", p.translations},
                  {"rotations", p.rotations}};
    if (!p.message.empty()) plane["message"] = p.message;
    if (p.level != CalibrationLevel::kNone) {
      plane["normal"] = VectorJson(p.normal);
      plane["start"] = VectorJson(report.start);
      plane["change_deg"] = AngleDeg(p.normal, report.start);
      plane["driving"] = VectorJson(p.driving);
      PutDeg("tilt_sd_deg", p.tilt_sigma, &plane);
      PutDeg("roll_sd_deg", p.roll_sigma, &plane);
      PutDeg("translation_spread_deg", p.translation_spread, &plane);
      PutDeg("rotation_spread_deg", p.rotation_spread, &plane);
    }
    json["plane"] = plane;
  }
  if (report.gravity) {
    const GravityCalibration& g = *report.gravity;
    Json gravity = {{"level", CalibrationLevelName(g.level)}, {"pairs", g.pairs}};
    if (!g.message.empty()) gravity["message"] = g.message;
    if (g.level != CalibrationLevel::kNone) {
      gravity["q_wxyz"] = QuaternionJson(g.C);
      gravity["change_deg"] = TurnDeg(g.C);
      PutDeg("tilt_sd_deg", g.tilt_sigma, &gravity);
      PutDeg("yaw_sd_deg", g.yaw_sigma, &gravity);
      PutDeg("spread_deg", g.spread, &gravity);
    }
    json["gravity"] = gravity;
  }
  return PrintableJson(JsonText(json, 2) + "\n");
}

std::map<std::string, std::string> PlaneLines(const PlaneCalibration& plane, bool normal,
                                              bool axis) {
  std::map<std::string, std::string> lines;
  if (plane.level == CalibrationLevel::kNone) return lines;
  if (normal) {
    lines["normal"] = DirectionLine("normal", plane.normal);
    lines["normal_sigma_deg"] = plane.level == CalibrationLevel::kFull
                                    ? "normal_sigma_deg " + CsvNumber(RadToDeg(NormalSigma(plane)))
                                    : "";
  }
  if (axis) {
    lines["axis"] = DirectionLine("axis", plane.normal);
    lines["axis_sigma_deg"] = "";
  }
  return lines;
}

std::map<std::string, std::string> GravityLines(const GravityCalibration& gravity,
                                                const MotionPrior& stated) {
  std::map<std::string, std::string> lines;
  if (gravity.level == CalibrationLevel::kNone) return lines;
  if (stated.gravity1) lines["gravity1"] = DirectionLine("gravity1", gravity.C * *stated.gravity1);
  if (stated.gravity2) lines["gravity2"] = DirectionLine("gravity2", gravity.C * *stated.gravity2);
  return lines;
}

std::string CalibrationMark(const std::string& line) { return "# rigel_calibrate_prior " + line; }

std::map<std::string, std::string> MarkLines(const CalibrationReport& report, bool normal,
                                             bool axis) {
  std::map<std::string, std::string> lines;
  const auto mark = [&](const std::string& line, double turn_deg) {
    const std::string words = CalibrationMark(line);
    lines[words] = words + " turned by " + FormatNumber(turn_deg, 6) + " deg";
  };
  if (report.plane && report.plane->level != CalibrationLevel::kNone) {
    const double turn_deg = AngleDeg(report.plane->normal, report.start);
    if (normal) mark("normal", turn_deg);
    if (axis) mark("axis", turn_deg);
  }
  if (report.gravity && report.gravity->level != CalibrationLevel::kNone) {
    mark("gravity", TurnDeg(report.gravity->C));
  }
  return lines;
}

}  // namespace rigel
