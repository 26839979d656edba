// Tables, JSON and CSV of rigel_compare.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/problems/csv.h"
#include "rigel/problems/report.h"
#include "rigel/problems/table.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

std::optional<double> MedianOf(const std::optional<Statistics>& s) {
  return s ? std::optional<double>(s->median) : std::nullopt;
}

std::optional<double> Ratio(const std::optional<Statistics>& error,
                            const std::optional<Statistics>& bound) {
  if (!error || !bound || !(bound->rms > 0)) return std::nullopt;
  return error->rms / bound->rms;
}

void Put(const char* key, const std::optional<Statistics>& s, Json* object) {
  if (!s) return;
  (*object)[key] = {{"median", s->median}, {"mean", s->mean}, {"rms", s->rms}, {"p90", s->p90}};
}

void PutGroup(const char* key, const Json& group, Json* object) {
  if (!group.empty()) (*object)[key] = group;
}

Json SummaryJson(const SolverSummary& s) {
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
  PutGroup("refined", refined, &entry);
  Put("rotation_deg", s.bound_rotation_deg, &bound);
  Put("translation_dir_deg", s.bound_direction_deg, &bound);
  PutGroup("bound", bound, &entry);
  if (s.nees_ratio) {
    entry["nees"] = {{"ratio", *s.nees_ratio},
                     {"degrees_of_freedom", s.nees_dof},
                     {"low", s.nees_low},
                     {"high", s.nees_high}};
  }
  Put("inlier_ratio", s.inlier_ratio, &entry);
  Put("iterations", s.iterations, &entry);
  Put("ransac", s.ransac_ms, &time);
  Put("refine", s.refine_ms, &time);
  PutGroup("time_ms", time, &entry);
  return entry;
}

std::string SequenceTable(const std::vector<SolverSummary>& summaries) {
  // A blank before the first column of each group. The widths given keep it to 100 columns with the
  // longest solver name.
  Table table(1);
  table.AddHeader(
      {"", "", " rotation", "[deg]", "", " direction", "[deg]", "", " scale", "[%]", " time"});
  table.AddHeader({"solver", "fail", " raw", "refined", "bound", " raw", "refined", "bound", " raw",
                   "refined", " [ms]"});
  const auto percent = [](const std::optional<Statistics>& s) {
    return s ? FormatFitted(100.0 * s->median, 2, 5) : std::string("-");
  };
  bool any_bound = false;
  for (const SolverSummary& s : summaries) {
    std::optional<double> ms;
    if (s.ransac_ms && s.refine_ms) ms = s.ransac_ms->median + s.refine_ms->median;
    table.AddRow({s.solver, std::to_string(s.failures),
                  " " + FormatFitted(MedianOf(s.raw_rotation_deg), 4, 6),
                  FormatFitted(MedianOf(s.refined_rotation_deg), 4, 6),
                  FormatFitted(MedianOf(s.bound_rotation_deg), 4, 6),
                  " " + FormatFitted(MedianOf(s.raw_direction_deg), 3, 5),
                  FormatFitted(MedianOf(s.refined_direction_deg), 3, 5),
                  FormatFitted(MedianOf(s.bound_direction_deg), 3, 5), " " + percent(s.raw_scale),
                  percent(s.refined_scale), " " + FormatFitted(ms, 2, 4)});
    any_bound = any_bound || (s.bound_rotation_deg && s.refined_rotation_deg);
  }
  std::string text = table.Format();
  if (any_bound) {
    Table efficiency;
    efficiency.AddHeader({"efficiency: RMS error / RMS bound", "rotation", "direction",
                          "NEES / dof", "dof", "99 % of right ones"});
    for (const SolverSummary& s : summaries) {
      efficiency.AddRow(
          {s.solver, FormatNumber(Ratio(s.refined_rotation_deg, s.bound_rotation_deg), 3),
           FormatNumber(Ratio(s.refined_direction_deg, s.bound_direction_deg), 3),
           FormatNumber(s.nees_ratio, 3), s.nees_ratio ? FormatNumber(s.nees_dof, 2) : "-",
           s.nees_ratio ? FormatNumber(s.nees_low, 2) + " to " + FormatNumber(s.nees_high, 2)
                        : "-"});
    }
    text += "\n" + efficiency.Format();
  }
  return text;
}

}  // namespace

std::string ComparisonTable(const std::vector<SolverSummary>& summaries) {
  // In the order of first appearance: "all" comes first.
  std::vector<std::string> sequences;
  for (const SolverSummary& s : summaries) {
    if (std::find(sequences.begin(), sequences.end(), s.sequence) == sequences.end()) {
      sequences.push_back(s.sequence);
    }
  }
  std::string text;
  for (const std::string& sequence : sequences) {
    std::vector<SolverSummary> group;
    for (const SolverSummary& s : summaries) {
      if (s.sequence == sequence) group.push_back(s);
    }
    if (!text.empty()) text += "\n";
    const int n = group.front().pairs;
    if (sequence == "all") {
      text += n == 1 ? "one pair\n" : "all pairs, " + std::to_string(n) + " of them; medians\n";
    } else {
      text += "sequence " + Shortened(sequence, 60) + ", " + std::to_string(n) +
              (n == 1 ? " pair\n" : " pairs; medians\n");
    }
    text += SequenceTable(group);
  }
  return text;
}

std::string ComparisonJson(const std::vector<SolverSummary>& summaries, int num_pairs,
                           const ReportOptions& options) {
  Json report;
  report["format"] = "rigel-report 1";
  report["pairs"] = num_pairs;
  report["options"] = Json::object();
  for (const auto& [name, value] : options) report["options"][name] = value;
  report["results"] = Json::array();
  for (const SolverSummary& s : summaries) report["results"].push_back(SummaryJson(s));
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ComparisonCsv(
    const std::vector<std::pair<std::string, std::vector<PairResult>>>& results) {
  std::string text =
      "pair,sequence,solver,status,raw_rotation_deg,raw_translation_dir_deg,raw_scale,"
      "refined_rotation_deg,refined_translation_dir_deg,refined_scale,bound_rotation_deg,"
      "bound_translation_dir_deg,inlier_ratio,iterations,ransac_ms,refine_ms\n";
  const auto degrees = [](std::optional<double> radians) {
    return radians ? CsvNumber(RadToDeg(*radians)) : std::string();
  };
  for (const auto& [solver, pairs] : results) {
    for (const PairResult& r : pairs) {
      text += CsvText(r.name) + "," + CsvText(r.sequence) + "," + solver + "," +
              CsvText(EstimateStatusName(r.status));
      for (const std::optional<MotionErrors>* errors : {&r.raw, &r.refined}) {
        const bool has = errors->has_value();
        text += "," + (has ? degrees((*errors)->rotation) : "");
        text += "," + (has ? degrees((*errors)->direction) : "");
        text += "," + (has && (*errors)->scale ? CsvNumber(*(*errors)->scale) : "");
      }
      text += "," + (r.bound ? degrees(r.bound->rotation) : "");
      text += "," + (r.bound ? degrees(r.bound->direction) : "");
      text += "," + CsvNumber(r.inlier_ratio) + "," + std::to_string(r.iterations) + "," +
              CsvNumber(r.ransac_ms) + "," + CsvNumber(r.refine_ms) + "\n";
    }
  }
  return text;
}

}  // namespace rigel
