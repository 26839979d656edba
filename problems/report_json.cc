#include "rigel/problems/report_json.h"

namespace rigel {

nlohmann::ordered_json NewReport(const char* format, const std::string& version) {
  nlohmann::ordered_json report;
  report["format"] = format;
  if (!version.empty()) report["rigel_version"] = version;
  return report;
}

}  // namespace rigel
