// rigel_compare --baseline: an earlier report, held against itself, and --fail_above.
#include "rigel/problems/evaluation/bounds.h"
#include "rigel/test/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  const std::vector<std::string> parts = rigel::fuzz::Parts(data, size);
  rigel::ReportBounds bounds;
  std::string error;
  if (!rigel::ParseBaseline(parts[0], "baseline", &bounds.baseline, &error)) {
    rigel::fuzz::RequireMessage(error);
  }
  if (parts.size() > 1 && !rigel::ParseStatisticBounds(parts[1], &bounds.statistics, &error)) {
    rigel::fuzz::RequireMessage(error);
  }
  bounds.tolerance = 0.05;
  for (const std::string& line : rigel::MissedBounds(bounds, bounds.baseline)) {
    rigel::fuzz::RequireMessage(line);
  }
  for (const std::string& line : rigel::MissedBounds(bounds, {})) {
    rigel::fuzz::RequireMessage(line);
  }
  return 0;
}
