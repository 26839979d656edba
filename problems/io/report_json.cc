#include "rigel/problems/io/report_json.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "rigel/core/pose.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

bool IsNumberOfNothing(const Json& value) {
  return value.is_number_float() && !std::isfinite(value.get<double>());
}

// False if the value itself is to be left out.
bool KeepWhatExists(Json* value) {
  if (value->is_object()) {
    for (auto it = value->begin(); it != value->end();) {
      it = KeepWhatExists(&it.value()) ? std::next(it) : value->erase(it);
    }
    return true;
  }
  if (value->is_array()) {
    return std::all_of(value->begin(), value->end(),
                       [](Json& entry) { return KeepWhatExists(&entry); });
  }
  return !IsNumberOfNothing(*value);
}

}  // namespace

nlohmann::ordered_json NewReport(const char* format, const std::string& version) {
  nlohmann::ordered_json report;
  report["format"] = format;
  if (!version.empty()) report["rigel_version"] = version;
  return report;
}

nlohmann::ordered_json OptionsJson(const ReportOptions& options) {
  Json json = Json::object();
  for (const auto& [name, value] : options) json[name] = value;
  return json;
}

nlohmann::ordered_json QuaternionJson(const Eigen::Matrix3d& R) {
  Pose pose;
  pose.R = R;
  const Eigen::Quaterniond q = pose.Quaternion();
  return {q.w(), q.x(), q.y(), q.z()};
}

void PutKnown(const char* key, double value, nlohmann::ordered_json* object) {
  if (std::isfinite(value) && value >= 0) (*object)[key] = value;
}

std::string JsonText(Json value, int indent) {
  if (!KeepWhatExists(&value)) value = Json::array();
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace rigel
