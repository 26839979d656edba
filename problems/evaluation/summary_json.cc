#include "rigel/problems/evaluation/summary_json.h"

#include <optional>
#include <stdexcept>
#include <string>

#include "rigel/problems/io/json_text.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

void Put(const char* key, const std::optional<Statistics>& s, Json* object) {
  if (!s) return;
  (*object)[key] = StatisticsJson(*s);
}

void PutGroup(const char* key, const Json& group, Json* object) {
  if (!group.empty()) (*object)[key] = group;
}

void PutNees(const char* key, const std::optional<NeesStatistics>& nees, Json* entry) {
  if (!nees) return;
  (*entry)[key] = {{"ratio", nees->ratio},
                   {"degrees_of_freedom", nees->dof},
                   {"low", nees->low},
                   {"high", nees->high}};
}

std::optional<NeesStatistics> GetNees(const Json& entry, const char* key) {
  if (!entry.contains(key)) return std::nullopt;
  const Json& nees = entry.at(key);
  return NeesStatistics{nees.at("ratio").get<double>(), nees.at("degrees_of_freedom").get<double>(),
                        nees.at("low").get<double>(), nees.at("high").get<double>()};
}

std::optional<Statistics> Get(const Json& object, const char* key) {
  if (!object.contains(key)) return std::nullopt;
  const Json& s = object.at(key);
  Statistics statistics;
  statistics.median = s.at("median").get<double>();
  statistics.mean = s.at("mean").get<double>();
  statistics.rms = s.at("rms").get<double>();
  statistics.p90 = s.at("p90").get<double>();
  return statistics;
}

}  // namespace

nlohmann::ordered_json StatisticsJson(const Statistics& s, double unit) {
  return {{"median", unit * s.median},
          {"mean", unit * s.mean},
          {"rms", unit * s.rms},
          {"p90", unit * s.p90}};
}

nlohmann::ordered_json SummaryJson(const SolverSummary& s) {
  Json entry;
  entry["solver"] = s.solver;
  entry["sequence"] = s.sequence;
  entry["pairs"] = s.pairs;
  entry["failures"] = s.failures;
  entry["direction_pairs"] = s.direction_pairs;
  Json raw, refined, bound, time;
  Put("rotation_deg", s.raw_rotation_deg, &raw);
  Put("translation_dir_deg", s.raw_direction_deg, &raw);
  Put("scale", s.raw_scale, &raw);
  PutGroup("raw", raw, &entry);
  Put("rotation_deg", s.refined_rotation_deg, &refined);
  Put("translation_dir_deg", s.refined_direction_deg, &refined);
  Put("scale", s.refined_scale, &refined);
  Put("rig_direction_deg", s.refined_rig_direction_deg, &refined);
  PutGroup("refined", refined, &entry);
  Put("rotation_deg", s.bound_rotation_deg, &bound);
  Put("translation_dir_deg", s.bound_direction_deg, &bound);
  Put("rig_direction_deg", s.bound_rig_direction_deg, &bound);
  PutGroup("bound", bound, &entry);
  PutNees("nees", s.nees, &entry);
  PutNees("nees_rotation", s.nees_rotation, &entry);
  PutNees("nees_rig_direction", s.nees_rig_direction, &entry);
  Put("inlier_ratio", s.inlier_ratio, &entry);
  Put("iterations", s.iterations, &entry);
  Put("ransac", s.ransac_ms, &time);
  Put("refine", s.refine_ms, &time);
  PutGroup("time_ms", time, &entry);
  return entry;
}

SolverSummary ParseSummary(const Json& json) {
  SolverSummary s;
  s.solver = json.at("solver").get<std::string>();
  s.sequence = json.at("sequence").get<std::string>();
  s.pairs = JsonInteger(json.at("pairs"), 0);
  s.failures = JsonInteger(json.at("failures"), 0);
  s.direction_pairs = JsonInteger(json.at("direction_pairs"), 0);
  const Json none = Json::object();
  const auto group = [&](const char* key) -> const Json& {
    const Json& found = json.contains(key) ? json.at(key) : none;
    if (!found.is_object()) throw std::runtime_error(std::string(key) + " is not an object");
    return found;
  };
  const Json& raw = group("raw");
  s.raw_rotation_deg = Get(raw, "rotation_deg");
  s.raw_direction_deg = Get(raw, "translation_dir_deg");
  s.raw_scale = Get(raw, "scale");
  const Json& refined = group("refined");
  s.refined_rotation_deg = Get(refined, "rotation_deg");
  s.refined_direction_deg = Get(refined, "translation_dir_deg");
  s.refined_scale = Get(refined, "scale");
  s.refined_rig_direction_deg = Get(refined, "rig_direction_deg");
  const Json& bound = group("bound");
  s.bound_rotation_deg = Get(bound, "rotation_deg");
  s.bound_direction_deg = Get(bound, "translation_dir_deg");
  s.bound_rig_direction_deg = Get(bound, "rig_direction_deg");
  s.nees = GetNees(json, "nees");
  s.nees_rotation = GetNees(json, "nees_rotation");
  s.nees_rig_direction = GetNees(json, "nees_rig_direction");
  s.inlier_ratio = Get(json, "inlier_ratio");
  s.iterations = Get(json, "iterations");
  const Json& time = group("time_ms");
  s.ransac_ms = Get(time, "ransac");
  s.refine_ms = Get(time, "refine");
  return s;
}

}  // namespace rigel
