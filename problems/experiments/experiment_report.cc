#include "rigel/problems/experiments/experiment_report.h"

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <functional>

#include <nlohmann/json.hpp>

#include "rigel/problems/evaluation/summary_json.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/json_message.h"
#include "rigel/problems/io/json_text.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;
using Quantity = std::function<std::optional<Statistics>(const SolverSummary&)>;

// "4pt-axis-approx-polished" as "4pt-axis", "approx", "polished": heads of narrow columns.
std::vector<std::string> Broken(const std::string& name) {
  // Characters of a line: as many as "4pt-axis" has, little more than a figure.
  constexpr size_t kWidth = 8;
  std::vector<std::string> parts;
  size_t begin = 0;
  while (begin <= name.size()) {
    const size_t end = std::min(name.find('-', begin), name.size());
    const std::string part = name.substr(begin, end - begin);
    if (!parts.empty() && parts.back().size() + 1 + part.size() <= kWidth) {
      parts.back() += "-" + part;
    } else {
      parts.push_back(part);
    }
    begin = end + 1;
  }
  return parts;
}

Json PointJson(const ExperimentPoint& point) {
  Json json = {{"motion", point.motion}};
  if (point.x) json["x"] = *point.x;
  return json;
}

Json RowJson(const ExperimentRow& row) {
  Json json = PointJson(row.point);
  json["loop"] = row.loop;
  json.update(SummaryJson(row.summary));
  return json;
}

Json OptionsJson(const ExperimentPlan& plan) {
  Json json = {{"quick", plan.options.quick}, {"seed", plan.options.seed}};
  if (plan.spec->variable == ExperimentVariable::kNone) {
    json["every"] = plan.options.every;
    json["motions"] = plan.driven.size();
  } else {
    json["pairs"] = plan.options.pairs;
  }
  return json;
}

const ExperimentRow* Find(const std::vector<ExperimentRow>& rows, const ExperimentPoint& point,
                          const std::string& solver, const char* loop) {
  for (const ExperimentRow& row : rows) {
    if (row.point == point && row.summary.solver == solver && row.loop == loop) return &row;
  }
  return nullptr;
}

std::optional<double> MiddleOf(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  return values[(values.size() - 1) / 2];
}

// The head lines: the names of the solvers broken into lines, all ending in the last line.
void AddHeads(const ExperimentSpec& spec, bool driven, Table* table) {
  std::vector<std::vector<std::string>> heads;
  for (const std::string& solver : spec.solvers) heads.push_back(Broken(solver));
  heads.push_back({"refined"});
  heads.push_back({"bound"});
  size_t depth = 0;
  for (const auto& head : heads) depth = std::max(depth, head.size());
  for (size_t line = 0; line < depth; ++line) {
    const bool last = line + 1 == depth;
    std::vector<std::string> cells = {last ? (driven ? "drive" : "motion") : ""};
    if (!driven) cells.emplace_back(last ? "x" : "");
    for (const auto& head : heads) {
      const size_t skip = depth - head.size();
      cells.push_back(line >= skip ? head[line - skip] : "");
    }
    table->AddHeader(cells);
  }
}

// What a table shows: medians of the paper's loop, times a factor.
struct Shown {
  const char* title;
  Quantity raw, refined, bound;
  double factor = 1.0;
};

// Adds the row of a point. Whether any solver has a value in it.
bool AddPoint(const Shown& shown, const ExperimentSpec& spec, const ExperimentPoint& point,
              const std::vector<ExperimentRow>& rows, std::vector<std::string> cells,
              Table* table) {
  const auto append = [&](const std::optional<Statistics>& s, std::vector<double>* values) {
    if (s) values->push_back(shown.factor * s->median);
  };
  bool any = false;
  std::vector<double> refined_values, bound_values;
  for (const std::string& solver : spec.solvers) {
    const ExperimentRow* row = Find(rows, point, solver, kPaperLoop);
    std::optional<double> value;
    if (row != nullptr) {
      if (const auto s = shown.raw(row->summary)) value = shown.factor * s->median;
      append(shown.refined(row->summary), &refined_values);
      append(shown.bound(row->summary), &bound_values);
    }
    any = any || value.has_value();
    cells.push_back(FormatFitted(value, 4, 7));
  }
  cells.push_back(FormatFitted(MiddleOf(refined_values), 4, 7));
  cells.push_back(FormatFitted(MiddleOf(bound_values), 4, 6));
  table->AddRow(cells);
  return any;
}

// Empty if no solver has a value at any point.
std::string QuantityTable(const ExperimentPlan& plan, const std::vector<ExperimentRow>& rows,
                          const Shown& shown) {
  const ExperimentSpec& spec = *plan.spec;
  const bool driven = spec.variable == ExperimentVariable::kNone;
  Table table(1);
  AddHeads(spec, driven, &table);
  bool any = false;
  for (const ExperimentPoint& point : plan.points) {
    std::vector<std::string> cells = {driven ? point.sequence : point.motion};
    if (!driven) cells.push_back(CsvNumber(*point.x));
    any = AddPoint(shown, spec, point, rows, std::move(cells), &table) || any;
  }
  return any ? std::string(shown.title) + "\n" + table.Format() : "";
}

struct Column {
  const char* name;
  std::optional<Statistics> SolverSummary::*statistics;
};

constexpr Column kColumns[] = {
    {"raw_rotation_deg", &SolverSummary::raw_rotation_deg},
    {"raw_translation_dir_deg", &SolverSummary::raw_direction_deg},
    {"raw_scale", &SolverSummary::raw_scale},
    {"refined_rotation_deg", &SolverSummary::refined_rotation_deg},
    {"refined_translation_dir_deg", &SolverSummary::refined_direction_deg},
    {"refined_scale", &SolverSummary::refined_scale},
    {"bound_rotation_deg", &SolverSummary::bound_rotation_deg},
    {"bound_translation_dir_deg", &SolverSummary::bound_direction_deg},
    {"inlier_ratio", &SolverSummary::inlier_ratio},
    {"iterations", &SolverSummary::iterations},
    {"ransac_ms", &SolverSummary::ransac_ms},
    {"refine_ms", &SolverSummary::refine_ms},
};

}  // namespace

std::string ExperimentTable(const ExperimentPlan& plan, const std::vector<ExperimentRow>& rows) {
  const std::string x = plan.spec->x_name;
  std::string text = std::string(plan.spec->name) + ": " + plan.spec->about + "\n";
  text += "medians of the raw motions by solver, the largest inlier count winning";
  text += x.empty() ? "" : "; x = " + x;
  text += "\n\n";
  const auto add = [&](const char* gap, const Shown& shown) {
    const std::string table = QuantityTable(plan, rows, shown);
    if (!table.empty()) text += gap + table;
  };
  const Quantity rotation = std::mem_fn(&SolverSummary::refined_rotation_deg);
  const Quantity rotation_bound = std::mem_fn(&SolverSummary::bound_rotation_deg);
  const Quantity direction = std::mem_fn(&SolverSummary::refined_direction_deg);
  const Quantity direction_bound = std::mem_fn(&SolverSummary::bound_direction_deg);
  add("", {"rotation error [deg]", std::mem_fn(&SolverSummary::raw_rotation_deg), rotation,
           rotation_bound});
  add("\n", {"translation direction error [deg]", std::mem_fn(&SolverSummary::raw_direction_deg),
             direction, direction_bound});
  if (plan.spec->variable == ExperimentVariable::kNone) {
    add("\n", {"refined: rotation error [deg]", rotation, rotation, rotation_bound});
    add("\n",
        {"refined: translation direction error [deg]", direction, direction, direction_bound});
  }
  // Elsewhere the scale is observable without noise at most.
  if (plan.spec->variable == ExperimentVariable::kInterShare) {
    const auto no_bound = [](const SolverSummary&) { return std::optional<Statistics>(); };
    add("\n", {"scale error [%]", std::mem_fn(&SolverSummary::raw_scale),
               std::mem_fn(&SolverSummary::refined_scale), no_bound, 100.0});
  }
  return text;
}

std::string ExperimentJson(const ExperimentPlan& plan, const std::vector<ExperimentRow>& rows) {
  const ExperimentSpec& spec = *plan.spec;
  Json json = NewReport("rigel-experiment 1");
  json["experiment"] = spec.name;
  json["about"] = spec.about;
  if (spec.variable != ExperimentVariable::kNone) {
    json["x"] = {{"name", spec.x_name}, {"label", spec.x_label}};
  }
  json["options"] = OptionsJson(plan);
  json["results"] = Json::array();
  // One row a line: readable, and small in a diff.
  std::string text = JsonText(json, 1);
  text.resize(text.rfind("[]"));
  text += "[";
  for (size_t k = 0; k < rows.size(); ++k) {
    text += (k > 0 ? ",\n  " : "\n  ") + JsonText(RowJson(rows[k]), -1);
  }
  return text + "\n ]\n}\n";
}

std::string ExperimentCsv(const ExperimentPlan& plan, const std::vector<ExperimentRow>& rows) {
  std::string text = "experiment,motion,sequence,x,solver,loop,pairs,failures,direction_pairs";
  for (const Column& column : kColumns) {
    for (const char* kind : {"median", "mean", "rms", "p90"}) {
      text += std::string(",") + column.name + "_" + kind;
    }
  }
  text += "\n";
  for (const ExperimentRow& row : rows) {
    const SolverSummary& s = row.summary;
    text += std::string(plan.spec->name) + "," + CsvText(row.point.motion) + "," +
            CsvText(row.point.sequence) + "," + (row.point.x ? CsvNumber(*row.point.x) : "") + "," +
            CsvText(s.solver) + "," + row.loop + "," + std::to_string(s.pairs) + "," +
            std::to_string(s.failures) + "," + std::to_string(s.direction_pairs);
    for (const Column& column : kColumns) {
      const std::optional<Statistics>& v = s.*column.statistics;
      text += v ? "," + CsvNumber(v->median) + "," + CsvNumber(v->mean) + "," + CsvNumber(v->rms) +
                      "," + CsvNumber(v->p90)
                : ",,,,";
    }
    text += "\n";
  }
  return text;
}

std::string PointLine(const ExperimentPoint& point, const std::vector<ExperimentRow>& rows,
                      const std::string& run) {
  Json json;
  if (!run.empty()) json["run"] = run;
  json.update(PointJson(point));
  if (!point.sequence.empty()) json["sequence"] = point.sequence;
  json["rows"] = Json::array();
  for (const ExperimentRow& row : rows) {
    Json entry = {{"loop", row.loop}};
    entry.update(SummaryJson(row.summary));
    json["rows"].push_back(std::move(entry));
  }
  return JsonText(json, -1) + "\n";
}

bool ParsePointLine(const std::string& line, ExperimentPoint* point,
                    std::vector<ExperimentRow>* rows, std::string* run, std::string* error) {
  try {
    const Json json = ParseJson(line);
    ExperimentPoint parsed;
    std::string parsed_run;
    if (json.contains("run")) parsed_run = json.at("run").get<std::string>();
    parsed.motion = json.at("motion").get<std::string>();
    if (json.contains("sequence")) parsed.sequence = json.at("sequence").get<std::string>();
    if (json.contains("x")) parsed.x = json.at("x").get<double>();
    std::vector<ExperimentRow> parsed_rows;
    for (const Json& entry : json.at("rows")) {
      parsed_rows.push_back({parsed, entry.at("loop").get<std::string>(), ParseSummary(entry)});
    }
    *point = parsed;
    *rows = std::move(parsed_rows);
    *run = parsed_run;
    return true;
  } catch (const std::exception& e) {
    *error = JsonMessage(e);
    // This text has one line. Its number in the file is known to the caller.
    const std::string first_line = " at line 1, column ";
    const size_t place = error->find(first_line);
    if (place != std::string::npos) error->replace(place, first_line.size(), " at column ");
    return false;
  }
}

std::string RunId(const ExperimentPlan& plan) {
  uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  const auto add = [&](const std::string& text) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  };
  add(PlanLine(plan, ""));
  for (const ExperimentPoint& point : plan.points) add(PointLine(point, {}, ""));
  for (const DrivenMotion& motion : plan.driven) {
    add(motion.sequence);
    for (const Pose* pose : {&motion.world_from_body1, &motion.world_from_body2}) {
      for (const double v : pose->R.reshaped()) add(" " + CsvNumber(v));
      for (const double v : pose->t) add(" " + CsvNumber(v));
    }
  }
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, hash);
  return text;
}

std::string PlanLine(const ExperimentPlan& plan, const std::string& run) {
  Json json;
  json["format"] = "rigel-experiment-points 1";
  json["experiment"] = plan.spec->name;
  json["options"] = OptionsJson(plan);
  json["solvers"] = plan.spec->solvers;
  if (!run.empty()) json["run"] = run;
  return JsonText(json, -1) + "\n";
}

}  // namespace rigel
