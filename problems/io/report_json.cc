#include "rigel/problems/io/report_json.h"

#include <algorithm>
#include <cmath>
#include <iterator>

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

std::string JsonText(Json value, int indent) {
  if (!KeepWhatExists(&value)) value = Json::array();
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace rigel
