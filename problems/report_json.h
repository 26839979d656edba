// What every JSON report begins with. Not installed: the JSON library is the build's alone.
#ifndef RIGEL_PROBLEMS_REPORT_JSON_H_
#define RIGEL_PROBLEMS_REPORT_JSON_H_

#include <string>

#include <nlohmann/json.hpp>

#include "rigel/problems/version.h"

namespace rigel {

// Its format and the version whose results it holds, which reports of 0.1 (empty) do not state.
nlohmann::ordered_json NewReport(const char* format, const std::string& version = RigelVersion());

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_REPORT_JSON_H_
