#include "rigel/problems/evaluation/drift_report.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/problems/evaluation/summary_json.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/trajectories/drift.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

double Percent(double fraction) { return 100.0 * fraction; }
double DegPer100m(double radians_per_m) { return 100.0 * RadToDeg(radians_per_m); }

// Of the path; nothing where there is none.
std::optional<double> PercentOfPath(const Drift& drift, double metres) {
  if (!(drift.path_length > 0)) return std::nullopt;
  return Percent(metres / drift.path_length);
}

Json SegmentJson(const SegmentDrift& s) {
  return {{"segments", s.segments},
          {"translation_percent", Percent(s.translation)},
          {"rotation_deg_per_100m", DegPer100m(s.rotation)}};
}

Json DriftJson(const Drift& drift) {
  Json json;
  if (!drift.by_length.empty()) {
    Json kitti = SegmentJson(drift.all);
    Json rows = Json::array();
    for (const SegmentDrift& s : drift.by_length) {
      Json row = {{"length_m", s.length}};
      row.update(SegmentJson(s));
      rows.push_back(row);
    }
    kitti["start_step"] = drift.start_step;
    kitti["by_length"] = rows;
    json["kitti"] = kitti;
  }
  json["step"] = {{"translation_m", StatisticsJson(*drift.step_translation)},
                  {"rotation_deg", StatisticsJson(*drift.step_rotation, RadToDeg(1.0))}};
  json["end"] = {{"translation_m", drift.end_translation},
                 {"rotation_deg", RadToDeg(drift.end_rotation)}};
  json["start"] = {{"translation_m", drift.start_translation}};
  const auto end = PercentOfPath(drift, drift.end_translation);
  const auto start = PercentOfPath(drift, drift.start_translation);
  if (end) json["end"]["translation_percent"] = *end;
  if (start) json["start"]["translation_percent"] = *start;
  return json;
}

// "100, 200 and 300 m".
std::string LengthsText(const Drift& drift) {
  std::string text;
  for (size_t k = 0; k < drift.by_length.size(); ++k) {
    if (k > 0) text += k + 1 < drift.by_length.size() ? ", " : " and ";
    text += CsvNumber(drift.by_length[k].length);
  }
  return text + " m";
}

}  // namespace

std::string DriftTable(const EstimateReport& report) {
  if (!report.trajectories) return "";
  Table table;
  table.AddHeader({"", "", "path", "", "KITTI", "[deg/", "step RMS", "", "end", "", "start"});
  table.AddHeader({"drift", "pairs", "[m]", "motions", "[%]", "100 m]", "[mm]", "[deg]", "[%]",
                   "[deg]", "[%]"});
  std::map<std::string, std::vector<size_t>> remarks;  // and the trajectories they are of
  for (size_t k = 0; k < report.trajectories->size(); ++k) {
    const Trajectory& trajectory = (*report.trajectories)[k];
    if (trajectory.truth.empty()) continue;
    const std::string name =
        std::to_string(k) +
        (trajectory.sequence.empty() ? "" : " (" + Shortened(trajectory.sequence, 12) + ")");
    const auto add = [&](const char* motions, const std::vector<Pose>& poses) {
      Drift drift = ComputeDrift(trajectory.truth, poses);
      const bool segments = !drift.by_length.empty();
      const auto some = [&](double value) {
        return segments ? FormatFitted(value, 3, 7) : std::string("-");
      };
      table.AddRow({name, std::to_string(trajectory.NumPairs()),
                    FormatFitted(drift.path_length, 1, 8), motions,
                    some(Percent(drift.all.translation)), some(DegPer100m(drift.all.rotation)),
                    FormatFitted(1e3 * drift.step_translation->rms, 2, 7),
                    FormatFitted(RadToDeg(drift.step_rotation->rms), 4, 7),
                    FormatFitted(PercentOfPath(drift, drift.end_translation), 3, 7),
                    FormatFitted(RadToDeg(drift.end_rotation), 3, 7),
                    FormatFitted(PercentOfPath(drift, drift.start_translation), 3, 7)});
      return drift;
    };
    const Drift drift = add("raw", trajectory.raw);
    if (report.refined) add("refined", trajectory.estimate);
    if (drift.by_length.empty()) {
      remarks["the path is too short for KITTI's metric"].push_back(k);
    } else if (drift.start_step == 1) {
      remarks["KITTI's metric over " + LengthsText(drift) +
              " from every frame: not the benchmark's 100 to 800 m"]
          .push_back(k);
    } else {
      remarks["KITTI's metric over " + LengthsText(drift)].push_back(k);
    }
  }
  if (remarks.empty()) return "";
  std::string text = table.Format();
  for (const auto& [remark, trajectories] : remarks) {
    // Trajectories listed in a remark. Of the others the number is given, so that the line is
    // short.
    constexpr size_t kListed = 5;
    for (size_t k = 0; k < std::min(kListed, trajectories.size()); ++k) {
      text += (k > 0 ? ", " : "") + std::to_string(trajectories[k]);
    }
    if (trajectories.size() > kListed) {
      text += " and " + std::to_string(trajectories.size() - kListed) + " more";
    }
    text += ": " + remark + "\n";
  }
  return text;
}

std::string TrajectoriesJson(const EstimateReport& report) {
  Json json = Json::array();
  for (const Trajectory& trajectory : *report.trajectories) {
    Json entry;
    if (!trajectory.sequence.empty()) entry["sequence"] = trajectory.sequence;
    entry["first_pair"] = report.pairs[trajectory.first_pair].name;
    entry["last_pair"] = report.pairs[trajectory.first_pair + trajectory.NumPairs() - 1].name;
    entry["pairs"] = trajectory.NumPairs();
    entry["still_pairs"] = trajectory.num_still;
    entry["stated_lengths"] = trajectory.num_stated_lengths;
    if (!trajectory.truth.empty()) {
      const Drift raw = ComputeDrift(trajectory.truth, trajectory.raw);
      entry["path_m"] = raw.path_length;
      entry["raw"] = DriftJson(raw);
      if (report.refined) {
        entry["refined"] = DriftJson(ComputeDrift(trajectory.truth, trajectory.estimate));
      }
    }
    json.push_back(entry);
  }
  std::string text;
  for (const char c : JsonText(json, 2)) {
    text += c;
    if (c == '\n') text += "  ";
  }
  return text;
}

}  // namespace rigel
