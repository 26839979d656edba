// rigel_compare --merge: reports of shards.
#include <nlohmann/json.hpp>

#include "rigel/problems/evaluation/shard_report.h"
#include "rigel/test/fuzz/fuzz.h"

namespace {

// Numbers that are not finite are written as null.
bool HasNull(const nlohmann::json& json) {
  if (!json.is_structured()) return json.is_null();
  for (const auto& item : json) {
    if (HasNull(item)) return true;
  }
  return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  std::vector<rigel::ComparisonReport> shards;
  std::vector<std::string> names;
  std::string error;
  for (const std::string& text : rigel::fuzz::Parts(data, size)) {
    names.push_back("shard" + std::to_string(names.size()));
    shards.emplace_back();
    if (!rigel::ParseShardReport(text, names.back(), &shards.back(), &error)) {
      rigel::fuzz::RequireMessage(error);
      return 0;
    }
  }
  rigel::ComparisonReport whole;
  if (!rigel::MergeShards(names, &shards, &whole, &error)) {
    rigel::fuzz::RequireMessage(error);
    return 0;
  }
  const std::vector<rigel::SolverSummary> summaries = rigel::SummarizeAll(whole.solvers, true);
  Require(!rigel::ComparisonTable(summaries).empty(), "a table");
  const std::string json = rigel::ComparisonJson(whole, summaries, true);
  Require(!HasNull(nlohmann::json::parse(json)), "no null in a report");
  rigel::ComparisonCsv(whole.solvers);
  return 0;
}
