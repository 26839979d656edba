#include "rigel/problems/benchmarks/ransac_benchmark.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "rigel/core/enum_names.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/benchmarks/ransac_measurement.h"
#include "rigel/problems/benchmarks/ransac_tasks.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

// OpenGV takes seconds a pair.
constexpr int kOpenGvPairs = 5;

constexpr EnumName<RansacExperiment> kExperimentNames[] = {
    {RansacExperiment::kSpeed, "speed"},
    {RansacExperiment::kOutliers, "outliers"},
    {RansacExperiment::kAblation, "ablation"},
    {RansacExperiment::kMoving, "moving"},
    {RansacExperiment::kFiles, "files"}};

using Json = nlohmann::ordered_json;

std::optional<double> Ratio(std::optional<double> a, std::optional<double> b) {
  if (!a || !b || !(*b > 0)) return std::nullopt;
  return *a / *b;
}

std::string Percent(std::optional<double> share) {
  return share ? FormatNumber(100.0 * *share, 1) : "-";
}

std::string Count(std::optional<int> count) { return count ? std::to_string(*count) : "-"; }

std::string TimeMs(const RansacBenchmarkRow& row) {
  return row.time_ms ? FormatFitted(row.time_ms->median, 2, 6) : "-";
}

std::string TimeP90Ms(const RansacBenchmarkRow& row) {
  return row.time_ms ? FormatFitted(row.time_ms->p90, 2, 6) : "-";
}

std::string SpeedTable(const std::vector<RansacBenchmarkRow>& rows) {
  Table table(1);
  table.AddHeader({"", "", "time", "[ms]", "of it", "iter-", "error", "[deg]", "clean", "", "bound",
                   "", "suc-", ""});
  table.AddHeader({"solver", "form", "median", "spread", "refine", "tions", "rot.", "dir.", "rot.",
                   "dir.", "rot.", "dir.", "cess", "pairs"});
  for (const RansacBenchmarkRow& row : rows) {
    table.AddRow({row.solver, row.form, TimeMs(row), FormatFitted(row.time_spread_ms, 2, 5),
                  FormatFitted(row.refine_ms, 2, 5), FormatNumber(row.iterations, 0),
                  FormatNumber(row.rotation_deg, 4), FormatNumber(row.direction_deg, 3),
                  FormatFitted(Ratio(row.rotation_deg, row.clean_rotation_deg), 2, 4),
                  FormatFitted(Ratio(row.direction_deg, row.clean_direction_deg), 2, 4),
                  FormatFitted(row.efficiency_rotation, 2, 4),
                  FormatFitted(row.efficiency_direction, 2, 4), Percent(row.success),
                  std::to_string(row.pairs)});
  }
  return table.Format();
}

// Solvers or variants in scenes with outliers and cars.
std::string SuccessTable(const std::vector<RansacBenchmarkRow>& rows, RansacExperiment experiment) {
  const bool ablation = experiment == RansacExperiment::kAblation;
  const bool moving = experiment == RansacExperiment::kMoving;
  Table table(1);
  std::vector<std::string> header1 = {"outl."};
  std::vector<std::string> header2 = {"[%]"};
  const auto column = [&](const std::string& first, const std::string& second) {
    header1.push_back(first);
    header2.push_back(second);
  };
  if (moving) column("car", "[%]");
  if (!ablation && !moving) column("", "matches");
  column("", "solver");
  if (ablation) column("", "variant");
  column("time", "median");
  column("[ms]", "p90");
  column("itera-", "tions");
  column("error", "rot.");
  column("[deg]", "dir.");
  if (!ablation) {
    column("bound", "rot.");
    column("", "dir.");
  }
  if (moving) column("static", "[%]");
  column("success", "[%]");
  column("", "missed");
  table.AddHeader(header1);
  table.AddHeader(header2);
  for (const RansacBenchmarkRow& row : rows) {
    std::vector<std::string> cells = {FormatNumber(100.0 * row.outlier_share, 0)};
    if (moving) cells.push_back(FormatNumber(100.0 * row.moving_share, 0));
    if (!ablation && !moving) cells.push_back(std::to_string(row.num_matches));
    cells.push_back(row.solver);
    if (ablation) cells.push_back(row.variant);
    cells.push_back(TimeMs(row));
    cells.push_back(TimeP90Ms(row));
    cells.push_back(FormatNumber(row.iterations, 0));
    cells.push_back(FormatNumber(row.rotation_deg, 4));
    cells.push_back(FormatNumber(row.direction_deg, 3));
    if (!ablation) {
      cells.push_back(FormatNumber(row.efficiency_rotation, 2));
      cells.push_back(FormatNumber(row.efficiency_direction, 2));
    }
    if (moving) cells.push_back(Percent(row.static_wins));
    cells.push_back(Percent(row.success));
    cells.push_back(Count(row.missed));
    table.AddRow(cells);
  }
  return table.Format();
}

std::string FilesTable(const std::vector<RansacBenchmarkRow>& rows) {
  Table table(1);
  table.AddHeader(
      {"", "", "time", "[ms]", "", "of it", "", "itera-", "inliers", "error", "[deg]", ""});
  table.AddHeader({"solver", "matches", "median", "spread", "p90", "RANSAC", "refine", "tions",
                   "[%]", "rot.", "dir.", "fail"});
  for (const RansacBenchmarkRow& row : rows) {
    table.AddRow({row.solver, std::to_string(row.num_matches), TimeMs(row),
                  FormatNumber(row.time_spread_ms, 2), TimeP90Ms(row),
                  FormatNumber(row.ransac_ms, 2), FormatNumber(row.refine_ms, 2),
                  FormatNumber(row.iterations, 0), Percent(row.inlier_ratio),
                  FormatNumber(row.rotation_deg, 4), FormatNumber(row.direction_deg, 3),
                  std::to_string(row.failures)});
  }
  return table.Format();
}

// Left out if there is none.
void Put(const char* key, std::optional<double> value, Json* object) {
  if (value) (*object)[key] = *value;
}

}  // namespace

bool ParseRansacExperiment(std::string_view name, RansacExperiment* experiment) {
  RansacExperiment found;
  if (!FindValue(kExperimentNames, name, &found) || found == RansacExperiment::kFiles) return false;
  *experiment = found;
  return true;
}

const char* RansacExperimentName(RansacExperiment experiment) {
  return NameOf(kExperimentNames, experiment);
}

int CountRansacRows(const RansacBenchmarkOptions& options) {
  return static_cast<int>(MakeRansacTasks(options).size());
}

std::vector<RansacBenchmarkRow> BenchmarkRansac(const RansacBenchmarkOptions& options,
                                                const std::function<void()>& progress) {
  std::vector<RansacBenchmarkRow> rows;
  for (const RansacTask& task : MakeRansacTasks(options)) {
    const int pairs = task.opengv.empty() ? options.pairs : std::min(options.pairs, kOpenGvPairs);
    rows.push_back(MeasureRansac(task, MakeRansacProblems(task.scene, pairs)));
    if (progress) progress();
  }
  return rows;
}

std::vector<RansacBenchmarkRow> BenchmarkRansacOnFiles(const RansacBenchmarkOptions& options,
                                                       const std::vector<FramePair>& pairs) {
  std::vector<RansacProblem> problems;
  for (const FramePair& pair : pairs) problems.push_back({pair, std::nullopt});
  std::vector<RansacBenchmarkRow> rows;
  for (RansacTask& task : MakeRansacTasks(options)) {
    // No prior of a file is exact.
    if (!task.opengv.empty() || task.estimate.refine.form != RefineForm::kFull) continue;
    const PriorKind kind = FindSolver(task.estimate.solver)->prior;
    const bool usable = std::all_of(pairs.begin(), pairs.end(), [kind](const FramePair& pair) {
      return HasPrior(pair.prior, kind);
    });
    if (!usable && options.solvers.empty()) continue;
    task.scene.outlier_share = 0.0;
    rows.push_back(MeasureRansac(task, problems));
  }
  return rows;
}

std::string RansacBenchmarkTable(const std::vector<RansacBenchmarkRow>& rows,
                                 RansacExperiment experiment) {
  switch (experiment) {
    case RansacExperiment::kSpeed:
      return SpeedTable(rows);
    case RansacExperiment::kFiles:
      return FilesTable(rows);
    default:
      return SuccessTable(rows, experiment);
  }
}

std::string RansacBenchmarkJson(const std::vector<RansacBenchmarkRow>& rows,
                                const RansacBenchmarkOptions& options) {
  Json report = NewReport("rigel-ransac-benchmark 1");
  report["experiment"] = RansacExperimentName(options.experiment);
  report["options"] = {{"seed", options.seed}};
  report["results"] = Json::array();
  for (const RansacBenchmarkRow& row : rows) {
    Json entry = {{"solver", row.solver}, {"form", row.form}};
    if (!row.variant.empty()) entry["variant"] = row.variant;
    if (options.experiment != RansacExperiment::kFiles) {
      entry["outlier_share"] = row.outlier_share;
      entry["moving_share"] = row.moving_share;
    }
    entry["matches"] = row.num_matches;
    entry["pairs"] = row.pairs;
    entry["failures"] = row.failures;
    if (row.time_ms) {
      entry["time_ms"] = {{"median", row.time_ms->median},
                          {"p90", row.time_ms->p90},
                          {"spread", row.time_spread_ms},
                          {"ransac", row.ransac_ms},
                          {"refine", row.refine_ms}};
      entry["iterations"] = row.iterations;
      entry["inlier_ratio"] = row.inlier_ratio;
    }
    Put("rotation_deg", row.rotation_deg, &entry);
    Put("translation_dir_deg", row.direction_deg, &entry);
    Put("clean_rotation_deg", row.clean_rotation_deg, &entry);
    Put("clean_translation_dir_deg", row.clean_direction_deg, &entry);
    Put("efficiency_rotation", row.efficiency_rotation, &entry);
    Put("efficiency_translation_dir", row.efficiency_direction, &entry);
    Put("success", row.success, &entry);
    if (row.missed) entry["missed"] = *row.missed;
    Put("static_wins", row.static_wins, &entry);
    report["results"].push_back(entry);
  }
  return JsonText(report, 2) + "\n";
}

}  // namespace rigel
