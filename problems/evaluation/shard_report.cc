#include "rigel/problems/evaluation/shard_report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/problems/io/json_message.h"
#include "rigel/problems/io/json_text.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

// The angle from which RadToDeg() makes exactly `degrees`, so that a merged report has the
// statistics of the whole. DegToRad() may be off by some units in the last place.
double ExactRadians(double degrees) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double radians = DegToRad(degrees);
  double below = radians;
  double above = radians;
  for (int k = 0; k < 4; ++k) {
    if (RadToDeg(below) == degrees) return below;
    if (RadToDeg(above) == degrees) return above;
    below = std::nextafter(below, -kInfinity);
    above = std::nextafter(above, kInfinity);
  }
  return radians;
}

// Exceptions of the JSON library and these end the reading. They do not leave this file.
[[noreturn]] void Fail(const std::string& what) { throw std::runtime_error(what); }

MotionErrors Errors(const Json& json) {
  MotionErrors errors;
  errors.rotation = ExactRadians(json.at("rotation_deg").get<double>());
  if (json.contains("translation_dir_deg")) {
    errors.direction = ExactRadians(json.at("translation_dir_deg").get<double>());
  }
  if (json.contains("scale")) errors.scale = json.at("scale").get<double>();
  if (json.contains("rig_direction_deg")) {
    errors.rig_direction = ExactRadians(json.at("rig_direction_deg").get<double>());
  }
  return errors;
}

std::optional<NormalizedError> Nees(const Json& result, const char* key) {
  if (!result.contains(key)) return std::nullopt;
  const Json& nees = result.at(key);
  return NormalizedError{nees.at("value").get<double>(),
                         JsonInteger(nees.at("degrees_of_freedom"), 1)};
}

EstimateStatus Status(const std::string& name) {
  EstimateStatus status;
  if (!ParseEstimateStatus(name, &status)) Fail("there is no status '" + name + "'");
  return status;
}

PairResult Result(const Json& json) {
  PairResult result;
  result.status = Status(json.at("status").get<std::string>());
  result.failed = result.status != EstimateStatus::kSuccess;
  if (result.failed) result.message = json.at("message").get<std::string>();
  if (json.contains("raw")) result.raw = Errors(json.at("raw"));
  if (json.contains("refined")) result.refined = Errors(json.at("refined"));
  if (json.contains("bound")) {
    const MotionErrors bound = Errors(json.at("bound"));
    result.bound = MotionBound{bound.rotation, bound.direction, bound.rig_direction};
  }
  result.nees = Nees(json, "nees");
  result.nees_rotation = Nees(json, "nees_rotation");
  result.nees_rig_direction = Nees(json, "nees_rig_direction");
  result.inlier_ratio = json.at("inlier_ratio").get<double>();
  result.iterations = JsonInteger(json.at("iterations"), 0);
  if (json.contains("reason")) result.doubt = json.at("reason").get<std::string>();
  if (json.contains("time_ms")) {
    result.ransac_ms = json.at("time_ms").at("ransac").get<double>();
    result.refine_ms = json.at("time_ms").at("refine").get<double>();
  }
  return result;
}

bool HasSolver(const ComparisonReport& report, const std::string& name) {
  return std::any_of(report.solvers.begin(), report.solvers.end(),
                     [&](const SolverResults& s) { return s.solver == name; });
}

ComparisonReport Report(std::string_view text) {
  const Json json = ParseJson(text);
  if (json.at("format") != "rigel-report 1") Fail("its format is not 'rigel-report 1'");
  if (!json.contains("shard")) Fail("it is not the report of a shard: made without --shard=i/n");
  ComparisonReport report;
  report.version.clear();
  if (json.contains("rigel_version")) report.version = json.at("rigel_version").get<std::string>();
  const Json& shard = json.at("shard");
  report.shard = Shard{JsonInteger(shard.at("index"), 0), JsonInteger(shard.at("count"), 1)};
  report.num_files = JsonInteger(shard.at("files"), 0);
  if (report.shard->index >= report.shard->count) Fail("the index of its shard is not below count");
  for (const auto& [name, value] : json.at("options").items()) {
    report.options.emplace_back(name, value.get<std::string>());
  }
  for (const Json& entry : json.at("results")) {
    const auto solver = entry.at("solver").get<std::string>();
    // Further entries of a solver are those of sequences.
    if (!HasSolver(report, solver)) report.solvers.push_back({solver, {}});
  }
  if (report.solvers.empty()) Fail("it has no results");
  for (const Json& entry : json.at("pair_results")) {
    for (SolverResults& solver : report.solvers) {
      PairResult result = Result(entry.at("solvers").at(solver.solver));
      result.name = entry.at("pair").get<std::string>();
      if (entry.contains("sequence")) result.sequence = entry.at("sequence").get<std::string>();
      solver.pairs.push_back(std::move(result));
    }
  }
  const int num_pairs = JsonInteger(json.at("pairs"), 0);
  if (report.solvers.front().pairs.size() != static_cast<size_t>(num_pairs)) {
    Fail("it has the results of " + std::to_string(report.solvers.front().pairs.size()) +
         " pairs, expected " + std::to_string(num_pairs));
  }
  return report;
}

// The line of a number that is too large for a double; 0 for other errors. The library states the
// line of syntax errors itself, but only the number for this one.
int LineOfOverflow(std::string_view text, const std::exception& exception) {
  const std::string message = exception.what();
  const std::string what = "number overflow parsing '";
  const size_t begin = message.find(what);
  if (begin == std::string::npos) return 0;
  std::string number = message.substr(begin + what.size());
  number.erase(std::min(number.rfind('\''), number.size()));
  const size_t place = std::min(text.find(number), text.size());
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + place, '\n'));
}

std::string ShardText(const Shard& shard) {
  return std::to_string(shard.index) + "/" + std::to_string(shard.count);
}

std::string VersionText(const ComparisonReport& report) {
  return report.version.empty() ? "0.1" : report.version;
}

const std::string* FindOption(const ReportOptions& options, const std::string& name) {
  for (const auto& [key, value] : options) {
    if (key == name) return &value;
  }
  return nullptr;
}

// The first option in which the two differ; empty if there is none.
std::string Difference(const ReportOptions& a, const ReportOptions& b) {
  const auto text = [](const std::string* value) {
    return value == nullptr ? "not there" : "'" + *value + "'";
  };
  for (const ReportOptions* options : {&a, &b}) {
    for (const auto& [name, ignored] : *options) {
      const std::string* in_a = FindOption(a, name);
      const std::string* in_b = FindOption(b, name);
      if (in_a == nullptr || in_b == nullptr || *in_a != *in_b) {
        return name + " is " + text(in_a) + " and " + text(in_b);
      }
    }
  }
  return "";
}

// Why the two are not shards of one run; empty if they are.
std::string WhyNotTogether(const ComparisonReport& a, const ComparisonReport& b) {
  if (a.shard->count != b.shard->count || a.num_files != b.num_files) {
    return "not shards of the same input: " + ShardText(*a.shard) + " of " +
           std::to_string(a.num_files) + " files and " + ShardText(*b.shard) + " of " +
           std::to_string(b.num_files);
  }
  if (a.version != b.version) {
    return "made by other versions: " + VersionText(a) + " and " + VersionText(b);
  }
  const std::string difference = Difference(a.options, b.options);
  return difference.empty() ? "" : "made with other options: " + difference;
}

// The report of each shard, by its index. False with what is wrong if they are not all of the
// shards of one run, each once.
bool CheckShards(const std::vector<std::string>& names, const std::vector<ComparisonReport>& shards,
                 std::vector<int>* report_of, std::string* what) {
  if (shards.empty()) {
    *what = "no reports to merge";
    return false;
  }
  const ComparisonReport& first = shards.front();
  const auto count = static_cast<size_t>(first.shard->count);
  // The stated count may be wrong: memory is bounded by the number of reports.
  report_of->assign(std::min(count, shards.size()), -1);
  std::map<int, size_t> report_of_index;
  for (size_t k = 0; k < shards.size(); ++k) {
    const ComparisonReport& report = shards[k];
    const std::string why_not = WhyNotTogether(first, report);
    if (!why_not.empty()) {
      *what = names.front() + " and " + names[k] + ": " + why_not;
      return false;
    }
    const auto [other, is_new] = report_of_index.emplace(report.shard->index, k);
    if (!is_new) {
      *what = names[other->second] + " and " + names[k] + ": both are shard " +
              ShardText(*report.shard);
      return false;
    }
    if (static_cast<size_t>(report.shard->index) < report_of->size()) {
      (*report_of)[report.shard->index] = static_cast<int>(k);
    }
  }
  if (shards.size() >= count) return true;
  const auto missing = std::find(report_of->begin(), report_of->end(), -1);
  const auto index = static_cast<int>(missing - report_of->begin());
  *what = "shard " + ShardText({index, first.shard->count}) +
          " is missing: " + std::to_string(shards.size()) + " reports of " + std::to_string(count);
  return false;
}

// The results of the shards, in the order of `report_of`. False with what is wrong if nothing is
// left.
bool JoinShards(const std::vector<int>& report_of, std::vector<ComparisonReport>* shards,
                ComparisonReport* whole, std::string* what) {
  const ComparisonReport& first = shards->front();
  whole->version = first.version;
  whole->options = first.options;
  whole->shard.reset();
  whole->num_files = 0;
  whole->solvers.clear();
  // If solvers were chosen by the priors, the whole report has those that every shard has.
  for (const SolverResults& solver : first.solvers) {
    if (std::all_of(shards->begin(), shards->end(), [&](const ComparisonReport& report) {
          return HasSolver(report, solver.solver);
        })) {
      whole->solvers.push_back({solver.solver, {}});
    }
  }
  if (whole->solvers.empty()) {
    *what = "no solver's prior is in every file";
    return false;
  }
  for (const int k : report_of) {
    for (SolverResults& solver : whole->solvers) {
      for (SolverResults& part : (*shards)[k].solvers) {
        if (part.solver != solver.solver) continue;
        std::move(part.pairs.begin(), part.pairs.end(), std::back_inserter(solver.pairs));
        part.pairs.clear();
      }
    }
  }
  if (whole->solvers.front().pairs.empty()) {
    *what = "no pair in any of the reports";
    return false;
  }
  return true;
}

}  // namespace

bool ParseShardReport(std::string_view text, const std::string& name, ComparisonReport* report,
                      std::string* error) {
  try {
    *report = Report(text);
    return true;
  } catch (const std::exception& e) {
    const int line = LineOfOverflow(text, e);
    *error = Printable(name + (line > 0 ? ":" + std::to_string(line) : "") +
                       ": not a report that can be merged: " + JsonMessage(e));
    return false;
  }
}

bool MergeShards(const std::vector<std::string>& names, std::vector<ComparisonReport>* shards,
                 ComparisonReport* whole, std::string* error) {
  std::string what;
  std::vector<int> report_of;
  if (!CheckShards(names, *shards, &report_of, &what) ||
      !JoinShards(report_of, shards, whole, &what)) {
    *error = Printable(what);
    return false;
  }
  return true;
}

}  // namespace rigel
