#include "rigel/problems/evaluation/comparison_report.h"

#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/problems/evaluation/sequence_tables.h"
#include "rigel/problems/evaluation/summary_json.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

Json ErrorsJson(const MotionErrors& errors) {
  Json object = {{"rotation_deg", RadToDeg(errors.rotation)}};
  if (errors.direction) object["translation_dir_deg"] = RadToDeg(*errors.direction);
  if (errors.scale) object["scale"] = *errors.scale;
  if (errors.rig_direction) object["rig_direction_deg"] = RadToDeg(*errors.rig_direction);
  return object;
}

void PutNees(const char* key, const std::optional<NormalizedError>& nees, Json* object) {
  if (nees) (*object)[key] = {{"value", nees->value}, {"degrees_of_freedom", nees->dof}};
}

Json ResultJson(const PairResult& r) {
  Json object = {{"status", EstimateStatusName(r.status)}};
  if (r.failed) object["message"] = r.message;
  if (r.raw) object["raw"] = ErrorsJson(*r.raw);
  if (r.refined) object["refined"] = ErrorsJson(*r.refined);
  if (r.bound) {
    object["bound"] =
        ErrorsJson({r.bound->rotation, r.bound->direction, {}, r.bound->rig_direction});
  }
  PutNees("nees", r.nees, &object);
  PutNees("nees_rotation", r.nees_rotation, &object);
  PutNees("nees_rig_direction", r.nees_rig_direction, &object);
  object["inlier_ratio"] = r.inlier_ratio;
  object["iterations"] = r.iterations;
  if (!r.doubt.empty()) {
    object["doubtful"] = true;
    object["reason"] = r.doubt;
  }
  if (r.ransac_ms && r.refine_ms) {
    object["time_ms"] = {{"ransac", *r.ransac_ms}, {"refine", *r.refine_ms}};
  }
  return object;
}

// All solvers' results of one pair.
Json PairJson(const ComparisonReport& report, size_t k) {
  const PairResult& first = report.solvers.front().pairs[k];
  Json object = {{"pair", first.name}};
  if (!first.sequence.empty()) object["sequence"] = first.sequence;
  for (const SolverResults& s : report.solvers) {
    object["solvers"][s.solver] = ResultJson(s.pairs[k]);
  }
  return object;
}

std::string CsvDegrees(std::optional<double> radians) {
  return radians ? CsvNumber(RadToDeg(*radians)) : "";
}

std::string CsvOptional(std::optional<double> value) { return value ? CsvNumber(*value) : ""; }

// ",rotation,direction,scale"; the cells of what there is not are empty.
std::string CsvErrors(const std::optional<MotionErrors>& errors) {
  if (!errors) return ",,,";
  return "," + CsvDegrees(errors->rotation) + "," + CsvDegrees(errors->direction) + "," +
         CsvOptional(errors->scale);
}

std::string CsvRow(const std::string& solver, const PairResult& r) {
  const std::string bound =
      r.bound ? "," + CsvDegrees(r.bound->rotation) + "," + CsvDegrees(r.bound->direction) : ",,";
  return CsvText(r.name) + "," + CsvText(r.sequence) + "," + solver + "," +
         CsvText(EstimateStatusName(r.status)) + CsvErrors(r.raw) + CsvErrors(r.refined) + bound +
         "," + CsvNumber(r.inlier_ratio) + "," + std::to_string(r.iterations) + "," +
         CsvOptional(r.ransac_ms) + "," + CsvOptional(r.refine_ms) + "\n";
}

std::string SolverTable(const std::vector<SolverSummary>& summaries) {
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
          {s.solver, FormatNumber(Efficiency(s.refined_rotation_deg, s.bound_rotation_deg), 3),
           FormatNumber(Efficiency(s.refined_direction_deg, s.bound_direction_deg), 3),
           s.nees ? FormatNumber(s.nees->ratio, 3) : "-",
           s.nees ? FormatNumber(s.nees->dof, 2) : "-",
           s.nees ? FormatNumber(s.nees->low, 2) + " to " + FormatNumber(s.nees->high, 2) : "-"});
    }
    text += "\n" + efficiency.Format();
  }
  return text;
}

}  // namespace

std::string ComparisonTable(const std::vector<SolverSummary>& summaries) {
  // Only the summaries over all sequences: sequences have tables of their own.
  std::vector<SolverSummary> all;
  for (const SolverSummary& s : summaries) {
    if (s.sequence == "all") all.push_back(s);
  }
  if (all.empty()) return SequenceTables(summaries);
  const int n = all.front().pairs;
  std::string text =
      n == 1 ? "one pair\n" : "all pairs, " + std::to_string(n) + " of them; medians\n";
  text += SolverTable(all);
  if (summaries.size() > all.size()) text += "\n" + SequenceTables(summaries);
  return text;
}

std::string ComparisonJson(const ComparisonReport& report,
                           const std::vector<SolverSummary>& summaries, bool per_pair) {
  Json json = NewReport("rigel-report 1", report.version);
  json["pairs"] = report.solvers.front().pairs.size();
  if (report.shard) {
    json["shard"] = {{"index", report.shard->index},
                     {"count", report.shard->count},
                     {"files", report.num_files}};
  }
  json["options"] = OptionsJson(report.options);
  json["results"] = Json::array();
  for (const SolverSummary& s : summaries) json["results"].push_back(SummaryJson(s));
  std::string text = JsonText(json, 2);
  if (per_pair) {
    // Written line by line: a JSON tree of many pairs would be large.
    text.resize(text.size() - 2);  // the line break and bracket of the end
    text += ",\n  \"pair_results\": [";
    for (size_t k = 0; k < report.solvers.front().pairs.size(); ++k) {
      text += k == 0 ? "\n    " : ",\n    ";
      text += JsonText(PairJson(report, k), -1);
    }
    text += report.solvers.front().pairs.empty() ? "]\n}" : "\n  ]\n}";
  }
  return PrintableJson(text + "\n");
}

std::string ComparisonCsv(const std::vector<SolverResults>& solvers) {
  std::string text =
      "pair,sequence,solver,status,raw_rotation_deg,raw_translation_dir_deg,raw_scale,"
      "refined_rotation_deg,refined_translation_dir_deg,refined_scale,bound_rotation_deg,"
      "bound_translation_dir_deg,inlier_ratio,iterations,ransac_ms,refine_ms\n";
  for (const auto& [solver, pairs] : solvers) {
    for (const PairResult& r : pairs) text += CsvRow(solver, r);
  }
  return text;
}

}  // namespace rigel
