#include "rigel/problems/evaluation/bounds.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "rigel/problems/evaluation/summary_json.h"
#include "rigel/problems/io/json_message.h"
#include "rigel/problems/io/json_text.h"
#include "rigel/problems/io/match_file_words.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/table.h"
#include "rigel/refine/solver_choice.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

// Degrees, and fraction of a scale. Errors of noise-free files are rounding: a fraction of them is
// no bound.
constexpr double kErrorRounding = 1e-9;

// The number at a path like "refined.rotation_deg.median"; none if there is none.
std::optional<double> NumberAt(const Json& entry, std::string_view path) {
  const Json* place = &entry;
  while (true) {
    const size_t dot = path.find('.');
    const auto item = place->find(std::string(path.substr(0, dot)));
    if (item == place->end()) return std::nullopt;
    place = &*item;
    if (dot == std::string_view::npos) break;
    path.remove_prefix(dot + 1);
  }
  return place->is_number() ? std::optional<double>(place->get<double>()) : std::nullopt;
}

// An entry with every statistic that a report may have.
Json CompleteEntry() {
  SolverSummary s;
  s.raw_rotation_deg = s.raw_direction_deg = s.raw_scale = Statistics();
  s.refined_rotation_deg = s.refined_direction_deg = s.refined_scale = Statistics();
  s.refined_rig_direction_deg = s.bound_rig_direction_deg = Statistics();
  s.bound_rotation_deg = s.bound_direction_deg = Statistics();
  s.nees = s.nees_rotation = s.nees_rig_direction = NeesStatistics();
  s.inlier_ratio = s.iterations = s.ransac_ms = s.refine_ms = Statistics();
  return SummaryJson(s);
}

// "4pt-axis", "4pt-axis, sequence 06".
std::string EntryName(const SolverSummary& entry) {
  // Bytes of the name in a message: a name in a foreign report may have any length.
  constexpr size_t kMaxBytes = 60;
  std::string name = entry.solver;
  if (entry.sequence != "all") name += ", sequence " + entry.sequence;
  if (name.size() > kMaxBytes) name = name.substr(0, kMaxBytes) + "...";
  return Printable(name);
}

const SolverSummary* FindEntry(const std::vector<SolverSummary>& entries, const std::string& solver,
                               const std::string& sequence) {
  const auto entry = std::find_if(entries.begin(), entries.end(), [&](const SolverSummary& s) {
    return s.solver == solver && s.sequence == sequence;
  });
  return entry == entries.end() ? nullptr : &*entry;
}

void CheckStatistic(const StatisticBound& bound, const SolverSummary& entry,
                    std::vector<std::string>* missed) {
  const std::string what = "--fail_above: " + EntryName(entry) + ": " + bound.statistic + " is ";
  const std::optional<double> value = NumberAt(SummaryJson(entry), bound.statistic);
  if (!value) {
    missed->push_back(what + "missing, the bound is " + FormatShort(bound.limit));
  } else if (!(*value <= bound.limit)) {
    missed->push_back(what + FormatShort(*value) + ", above " + FormatShort(bound.limit));
  }
}

// One entry of the baseline against that of the same solver and sequence.
void CheckEntry(const SolverSummary& before, const SolverSummary& now, double tolerance,
                std::vector<std::string>* missed) {
  const std::string name = "--baseline: " + EntryName(before) + ": ";
  if (now.pairs != before.pairs) {
    missed->push_back(name + "pairs is " + std::to_string(now.pairs) + ", it was " +
                      std::to_string(before.pairs));
  }
  const Json entry = SummaryJson(now);
  const Json earlier = SummaryJson(before);
  const auto check = [&](const std::string& path, double slack) {
    const std::optional<double> was = NumberAt(earlier, path);
    if (!was) return;
    const std::optional<double> value = NumberAt(entry, path);
    const double limit = *was * (1.0 + tolerance) + slack;
    if (!value) {
      missed->push_back(name + path + " is missing, it was " + FormatShort(*was));
    } else if (!(*value <= limit)) {
      missed->push_back(name + path + " is " + FormatShort(*value) + ", above " +
                        FormatShort(limit) + "; it was " + FormatShort(*was));
    }
  };
  check("failures", 0.0);
  const std::string group = earlier.contains("refined") ? "refined" : "raw";
  if (earlier.contains(group)) {
    for (const auto& [quantity, statistics] : earlier.at(group).items()) {
      for (const auto& [statistic, ignored] : statistics.items()) {
        check(group + "." + quantity + "." + statistic, kErrorRounding);
      }
    }
  }
  const double least = before.direction_pairs * (1.0 - tolerance);
  if (now.direction_pairs < least) {
    missed->push_back(name + "direction_pairs is " + std::to_string(now.direction_pairs) +
                      ", below " + FormatShort(least) + "; it was " +
                      std::to_string(before.direction_pairs));
  }
}

}  // namespace

bool ParseStatisticBounds(std::string_view text, std::vector<StatisticBound>* bounds,
                          std::string* error) {
  const Json complete = CompleteEntry();
  const std::string_view all = text;
  std::vector<StatisticBound> parsed;
  while (!text.empty()) {
    const size_t comma = std::min(text.find(','), text.size());
    const std::string_view item = text.substr(0, comma);
    text.remove_prefix(std::min(comma + 1, text.size()));
    if (item.empty()) continue;
    const std::string quoted = "'" + Printable(std::string(item)) + "'";
    const size_t colon = item.rfind(':');
    StatisticBound bound;
    if (colon == std::string_view::npos || !ParseFinite(item.substr(colon + 1), &bound.limit)) {
      *error = quoted + ": expected STATISTIC:LIMIT, as in refined.rotation_deg.median:0.03";
      return false;
    }
    const std::string_view name = item.substr(0, colon);
    const size_t slash = name.find('/');
    if (slash != std::string_view::npos) {
      bound.solver = name.substr(0, slash);
      if (!IsSolverName(bound.solver)) {
        *error = quoted + ": there is no solver " + Quoted(bound.solver) + "; expected one of " +
                 SolverNamesWithAuto();
        return false;
      }
    }
    bound.statistic = slash == std::string_view::npos ? name : name.substr(slash + 1);
    if (!NumberAt(complete, bound.statistic)) {
      *error = quoted +
               ": no such statistic; expected its path in a report, as "
               "refined.rotation_deg.median, refined.translation_dir_deg.p90, refined.scale.rms, "
               "raw.rotation_deg.mean, failures";
      return false;
    }
    parsed.push_back(std::move(bound));
  }
  if (parsed.empty() && !all.empty()) {
    *error = "no bound in '" + Printable(std::string(all)) + "', expected STATISTIC:LIMIT,...";
    return false;
  }
  *bounds = std::move(parsed);
  return true;
}

bool ParseBaseline(std::string_view text, const std::string& name,
                   std::vector<SolverSummary>* baseline, std::string* error) {
  try {
    const Json json = ParseJson(text);
    if (json.at("format") != "rigel-report 1") {
      throw std::runtime_error("its format is not 'rigel-report 1'");
    }
    std::vector<SolverSummary> entries;
    for (const Json& entry : json.at("results")) entries.push_back(ParseSummary(entry));
    if (entries.empty()) throw std::runtime_error("it has no results");
    *baseline = std::move(entries);
    return true;
  } catch (const std::exception& e) {
    *error = Printable(name + ": not a report of rigel_compare: " + JsonMessage(e));
    return false;
  }
}

std::vector<std::string> MissedBounds(const ReportBounds& bounds,
                                      const std::vector<SolverSummary>& summaries) {
  std::vector<std::string> missed;
  for (const StatisticBound& bound : bounds.statistics) {
    bool any = false;
    for (const SolverSummary& entry : summaries) {
      if (entry.sequence != "all" || (!bound.solver.empty() && entry.solver != bound.solver)) {
        continue;
      }
      CheckStatistic(bound, entry, &missed);
      any = true;
    }
    if (!any) {
      missed.push_back("--fail_above: " + bound.solver + ": " + bound.statistic +
                       " is missing, the report does not have this solver");
    }
  }
  for (const SolverSummary& entry : summaries) {
    if (!bounds.max_failures || entry.sequence != "all" || entry.failures <= *bounds.max_failures) {
      continue;
    }
    missed.push_back("--max_failures: " + EntryName(entry) + ": failures is " +
                     std::to_string(entry.failures) + ", above " +
                     std::to_string(*bounds.max_failures));
  }
  for (const SolverSummary& before : bounds.baseline) {
    const SolverSummary* now = FindEntry(summaries, before.solver, before.sequence);
    if (now != nullptr) {
      CheckEntry(before, *now, bounds.tolerance, &missed);
    } else {
      missed.push_back("--baseline: " + EntryName(before) + ": is missing, it was there");
    }
  }
  return missed;
}

}  // namespace rigel
