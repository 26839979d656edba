// Raw against refined accuracy of solvers over frame pairs with known truth.
#ifndef RIGEL_PROBLEMS_EVALUATION_COMPARISON_H_
#define RIGEL_PROBLEMS_EVALUATION_COMPARISON_H_

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/statistics.h"
#include "rigel/problems/scenes/prior_source.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

enum class MatchUse { kAll, kIntra, kInter };

bool ParseMatchUse(std::string_view name, MatchUse* use);  // "all", "intra", "inter"

// Keeps the matches of that kind.
void SelectMatches(MatchUse use, FramePair* pair);

// Without a refinement nothing measures what the matches determine; that the scale is known can
// then be said only where there are matches between cameras (docs/conventions.md).
bool HasInterCameraMatches(const FramePair& pair);

struct ComparisonOptions {
  std::vector<std::string> solvers;  // empty: all whose prior every pair has
  MatchUse use = MatchUse::kAll;
  PriorSourceOptions prior;
  EstimateOptions estimate;      // its solver is replaced by each of `solvers`
  bool use_stated_noise = true;  // the noise that the files state
  int num_threads = 1;
};

// One motion against the truth. An error that does not exist is left out: the direction where the
// truth or the estimate has none that means something, the scale where it is not observable or,
// without a refinement, where no match is between cameras.
struct MotionErrors {
  double rotation = 0.0;  // radians
  std::optional<double> direction;
  std::optional<double> scale;  // fraction
};

// The part of a CramerRaoBound that reports give.
struct MotionBound {
  double rotation = 0.0;            // radians
  std::optional<double> direction;  // none where the true motion has none
};

struct PairResult {
  std::string name;
  std::string sequence;
  EstimateStatus status = EstimateStatus::kNotRun;
  std::string message;
  std::optional<MotionErrors> raw, refined;
  std::optional<MotionBound> bound;
  // Normalized estimation error squared: the refined error in units of its stated covariance. Its
  // mean over many pairs is the degrees of freedom if the covariance is right.
  std::optional<double> nees;
  int nees_dof = 0;  // 6, or 5 where |t| was held
  double inlier_ratio = 0.0;
  int iterations = 0;
  std::string doubt;                           // MotionEstimate::doubt; empty if there is none
  std::optional<double> ransac_ms, refine_ms;  // none where times are left out

  // No estimate, or one that could not be refined where that was asked for.
  bool failed = true;
};

// Below this the true motion has no direction that an estimate could be held to, metres.
inline constexpr double kMinTrueTranslation = 1e-2;

// The options for one pair: the noise that the pair states, if any, is the refinement's.
EstimateOptions WithStatedNoise(EstimateOptions options, const FramePair& pair);

// Runs one solver on a pair (already selected and with its prior applied). The noise that the pair
// states is the refinement's, unless `use_stated_noise` is false.
PairResult ComparePair(const FramePair& pair, const EstimateOptions& options,
                       bool use_stated_noise);

// The same for all of `pairs`. Results in input order and the same for any number of threads, but
// for the times. `progress` (may be empty) is called after each pair, from any thread.
std::vector<PairResult> RunSolver(const std::vector<FramePair>& pairs,
                                  const EstimateOptions& options, int num_threads,
                                  const std::function<void()>& progress,
                                  bool use_stated_noise = true);

struct SolverResults {
  std::string solver;
  std::vector<PairResult> pairs;
};

// What a report says of one solver over a group of pairs (docs/formats.md).
struct SolverSummary {
  std::string solver;
  std::string sequence = "all";
  int pairs = 0;
  int failures = 0;
  int direction_pairs = 0;
  std::optional<Statistics> raw_rotation_deg, raw_direction_deg, raw_scale;
  std::optional<Statistics> refined_rotation_deg, refined_direction_deg, refined_scale;
  std::optional<Statistics> bound_rotation_deg, bound_direction_deg;
  // Mean NEES over mean degrees of freedom, and the 99 percent interval of that ratio for a right
  // covariance.
  std::optional<double> nees_ratio;
  double nees_dof = 0.0, nees_low = 0.0, nees_high = 0.0;
  std::optional<Statistics> inlier_ratio, iterations, ransac_ms, refine_ms;
};

SolverSummary Summarize(const std::string& solver, const std::string& sequence,
                        const std::vector<PairResult>& results);

// "all" of each solver and then, if asked for, each sequence that has a name.
std::vector<SolverSummary> SummarizeAll(const std::vector<SolverResults>& solvers,
                                        bool by_sequence);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_COMPARISON_H_
