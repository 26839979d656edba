#include "rigel/problems/claim_cases.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigel/problems/csv.h"
#include "rigel/problems/table.h"

namespace rigel::claims {

const char* Name(Quantity quantity) {
  return quantity == Quantity::kRotation ? "rotation" : "direction";
}

const std::optional<Statistics>& StatisticsOf(const SolverSummary& s, Stage stage, Quantity q) {
  if (stage == Stage::kRaw) {
    return q == Quantity::kRotation ? s.raw_rotation_deg : s.raw_direction_deg;
  }
  return q == Quantity::kRotation ? s.refined_rotation_deg : s.refined_direction_deg;
}

std::string Number(Value value) {
  if (!value) return "-";
  return FormatNumber(value, *value < 1.0 ? 3 : 2);
}

std::string Range(Value low, Value high) {
  const std::string a = Number(low), b = Number(high);
  return a == b ? a : a + " to " + b;
}

void AppendItem(const std::string& separator, const std::string& item, std::string* list) {
  if (!list->empty()) *list += separator;
  *list += item;
}

std::string PointName(const ExperimentPoint& point) {
  if (!point.x) return point.sequence;
  return point.motion + " at " + CsvNumber(*point.x);
}

Rows::Rows(const ExperimentResults& results, const std::string& experiment) {
  const auto found = results.find(experiment);
  if (found != results.end()) rows_ = &found->second;
}

std::vector<ExperimentPoint> Rows::Points() const {
  std::vector<ExperimentPoint> points;
  if (rows_ == nullptr) return points;
  for (const ExperimentRow& row : *rows_) {
    if (std::find(points.begin(), points.end(), row.point) == points.end()) {
      points.push_back(row.point);
    }
  }
  return points;
}

const SolverSummary* Rows::Find(const ExperimentPoint& point, const std::string& solver,
                                const char* loop) const {
  if (rows_ == nullptr) return nullptr;
  for (const ExperimentRow& row : *rows_) {
    if (row.point == point && row.summary.solver == solver && row.loop == loop) {
      return &row.summary;
    }
  }
  return nullptr;
}

Value Rows::Median(const ExperimentPoint& point, const std::string& solver, Quantity q, Stage stage,
                   const char* loop) const {
  const SolverSummary* s = Find(point, solver, loop);
  if (s == nullptr || !StatisticsOf(*s, stage, q)) return std::nullopt;
  return StatisticsOf(*s, stage, q)->median;
}

Value Rows::Least(const ExperimentPoint& point, const Names& solvers, Quantity q) const {
  Value least;
  for (const std::string& solver : solvers) {
    const Value value = Median(point, solver, q);
    if (!value) return std::nullopt;
    if (!least || *value < *least) least = value;
  }
  return least;
}

Value Rows::Largest(const ExperimentPoint& point, const Names& solvers, Quantity q) const {
  Value largest;
  for (const std::string& solver : solvers) {
    const Value value = Median(point, solver, q);
    if (!value) return std::nullopt;
    if (!largest || *value > *largest) largest = value;
  }
  return largest;
}

Value Rows::MeanTime(const std::string& solver) const {
  if (rows_ == nullptr) return std::nullopt;
  double sum = 0.0;
  int pairs = 0;
  for (const ExperimentRow& row : *rows_) {
    const SolverSummary& s = row.summary;
    if (s.solver != solver || row.loop != kPaperLoop || !s.ransac_ms) continue;
    const int solved = s.pairs - s.failures;
    sum += solved * s.ransac_ms->mean;
    pairs += solved;
  }
  if (pairs == 0) return std::nullopt;
  return sum / pairs;
}

int Rows::FewestPairs() const {
  if (rows_ == nullptr || rows_->empty()) return 0;
  int fewest = std::numeric_limits<int>::max();
  for (const ExperimentRow& row : *rows_) {
    fewest = std::min(fewest, row.summary.pairs - row.summary.failures);
  }
  return fewest;
}

std::string Scatter(const Rows& rows) {
  const int pairs = rows.FewestPairs();
  if (pairs < 1) return "";
  return "medians of " + std::to_string(pairs) + " pairs scatter by about " +
         FormatNumber(100.0 / std::sqrt(pairs), 0) + " percent";
}

std::string Rows::Span(const ExperimentPoint& point, const Names& solvers, Quantity q) const {
  return Range(Least(point, solvers, q), Largest(point, solvers, q));
}

Cases::Cases(const char* source, const char* experiment, const std::string& text) {
  claim_.source = source;
  claim_.experiment = experiment;
  claim_.text = text;
}

void Cases::Add(bool holds, const std::string& what) {
  ++count_;
  if (holds) ++held_;
  if (!holds && num_shown_++ < 2) AppendItem("; ", what, &claim_.why);
}

void Cases::Less(const std::string& where, Value a, const std::string& a_name, Value b,
                 const std::string& b_name) {
  if (!a || !b) return;
  Add(*a < *b, where + ": " + a_name + " " + Number(a) + ", " + b_name + " " + Number(b));
}

void Cases::Figure(const std::string& text) { AppendItem("; ", text, &claim_.figures); }

namespace {

Verdict Judge(int held, int count) {
  if (held == count) return Verdict::kConfirmed;
  return 4 * held >= 3 * count ? Verdict::kPartly : Verdict::kNotConfirmed;
}

}  // namespace

Claim Cases::Finish() const {
  Claim claim = claim_;
  if (count_ == 0) {
    claim.figures = "";
    return claim;
  }
  if (!too_few_.empty()) {
    claim.verdict = Verdict::kTooFewPairs;
    claim.why = too_few_;
    return claim;
  }
  if (majority_) {
    const bool most = 2 * held_ > count_;
    claim.verdict = most ? Verdict::kConfirmed : Verdict::kNotConfirmed;
    if (most) {
      claim.why.clear();
      AppendItem("; ",
                 "holds in " + std::to_string(held_) + " of " + std::to_string(count_) + " cases",
                 &claim.figures);
      return claim;
    }
  } else {
    claim.verdict = Judge(held_, count_);
  }
  if (held_ < count_ && count_ > 1) {
    claim.why = "holds in " + std::to_string(held_) + " of " + std::to_string(count_) +
                " cases; not in " + claim_.why;
  }
  if (held_ < count_ && !reason_.empty()) claim.why += ". " + reason_;
  return claim;
}

}  // namespace rigel::claims
