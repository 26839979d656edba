// What the claims are evaluated with: medians of an experiment's rows, and claims that are to hold
// in several cases. Not installed.
#ifndef RIGEL_PROBLEMS_CLAIM_CASES_H_
#define RIGEL_PROBLEMS_CLAIM_CASES_H_

#include <string>
#include <vector>

#include "rigel/problems/experiment_claims.h"

namespace rigel::claims {

using Names = std::vector<std::string>;
using Value = std::optional<double>;

enum class Stage { kRaw, kRefined };
enum class Quantity { kRotation, kDirection };
inline constexpr Quantity kBoth[] = {Quantity::kRotation, Quantity::kDirection};

const char* Name(Quantity quantity);

const std::optional<Statistics>& StatisticsOf(const SolverSummary& summary, Stage stage,
                                              Quantity quantity);

std::string Number(Value value);           // three digits after the point, two from 1 on; "-"
std::string Range(Value low, Value high);  // "1.20 to 3.40"
void AppendItem(const std::string& separator, const std::string& item, std::string* list);
std::string PointName(const ExperimentPoint& point);  // "forward at 0.5", "00"

// The rows of one experiment; none if it is not among the results, which must outlive it.
class Rows {
 public:
  Rows(const ExperimentResults& results, const std::string& experiment);

  std::vector<ExperimentPoint> Points() const;

  // Null if there is none.
  const SolverSummary* Find(const ExperimentPoint& point, const std::string& solver,
                            const char* loop) const;

  Value Median(const ExperimentPoint& point, const std::string& solver, Quantity quantity,
               Stage stage = Stage::kRaw, const char* loop = kPaperLoop) const;

  // Least and largest raw median of some solvers in the paper's loop; nothing unless all are there.
  Value Least(const ExperimentPoint& point, const Names& solvers, Quantity quantity) const;
  Value Largest(const ExperimentPoint& point, const Names& solvers, Quantity quantity) const;
  // Mean time of RANSAC over all solved pairs of all points in the paper's loop, milliseconds.
  Value MeanTime(const std::string& solver) const;

  // Fewest solved pairs behind a summary; 0 without rows.
  int FewestPairs() const;

  std::string Span(const ExperimentPoint& point, const Names& solvers, Quantity quantity) const;

 private:
  const std::vector<ExperimentRow>* rows_ = nullptr;
};

// "medians of 60 pairs scatter by about 13 percent": of an error whose median has a relative
// standard error of one over the root of the number of pairs, about as the norm of a Gaussian.
std::string Scatter(const Rows& rows);

// A claim that is to hold in each of several cases: confirmed in all, partly in three of four.
class Cases {
 public:
  Cases(const char* source, const char* experiment, const std::string& text);

  // `what` says where and how it does not hold.
  void Add(bool holds, const std::string& what);

  // a < b, where both are there.
  void Less(const std::string& where, Value a, const std::string& a_name, Value b,
            const std::string& b_name);

  void Figure(const std::string& text);

  // More than half of the cases are enough; else it is not confirmed.
  void Majority() { majority_ = true; }

  // Whatever the cases say, there are too few pairs; `what` says how many are needed.
  void TooFew(const std::string& what) { too_few_ = what; }

  // What explains it where it does not hold. Every claim has one.
  void Reason(const std::string& text) { reason_ = text; }

  // Not measured if there was no case.
  Claim Finish() const;

 private:
  Claim claim_;
  std::string reason_;
  std::string too_few_;
  bool majority_ = false;
  int count_ = 0;
  int held_ = 0;
  int num_shown_ = 0;
};

std::vector<Claim> SyntheticClaims(const ExperimentResults& results);
std::vector<Claim> KittiClaims(const ExperimentResults& results);
std::vector<Claim> RefinementClaims(const ExperimentResults& results);

}  // namespace rigel::claims

#endif  // RIGEL_PROBLEMS_CLAIM_CASES_H_
