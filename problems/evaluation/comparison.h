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

// True if any match is between two cameras. Without a refinement this is the only sign that the
// scale is observable (docs/conventions.md).
bool HasInterCameraMatches(const FramePair& pair);

struct ComparisonOptions {
  std::vector<std::string> solvers;  // empty: all whose prior every pair has
  MatchUse use = MatchUse::kAll;
  PriorSourceOptions prior;
  // The error of the calibration, 1 sigma per axis, radians and metres: of all cameras, instead of
  // what a file states. Both 0: what the file states.
  double calibration_rotation_sigma = 0.0;
  double calibration_position_sigma = 0.0;
  EstimateOptions estimate;  // its solver is replaced by each of `solvers`
  int num_threads = 1;
};

// Errors of one motion. An error that does not exist is left out:
//   - of the direction, where the true translation is too short (kMinTrueTranslation) or the
//     direction is not observable; of the rig's direction, the same for the motion of the rig's
//     centre (rig_centre.h);
//   - of the scale, where it is not observable; without a refinement, where no match is between two
//     cameras.
struct MotionErrors {
  double rotation = 0.0;  // radians
  std::optional<double> direction;
  std::optional<double> scale;          // fraction
  std::optional<double> rig_direction;  // of a refined motion
};

// The part of a CramerRaoBound that reports show.
struct MotionBound {
  double rotation = 0.0;                           // radians
  std::optional<double> direction, rig_direction;  // none where the true motion has none
};

// A normalized estimation error squared (NEES): a refined error, weighted by the inverse of its
// covariance. If the covariance is right, the mean over many pairs is `dof`.
struct NormalizedError {
  double value = 0.0;
  int dof = 0;
};

struct PairResult {
  std::string name;
  std::string sequence;
  EstimateStatus status = EstimateStatus::kNotRun;
  std::string message;
  std::optional<MotionErrors> raw, refined;
  std::optional<MotionBound> bound;
  // Of rotation and translation: 6 degrees of freedom, or the rank of the covariance; of pairs
  // whose direction is observable.
  std::optional<NormalizedError> nees;
  std::optional<NormalizedError> nees_rotation;       // of the rotation's block: 3
  std::optional<NormalizedError> nees_rig_direction;  // where that has an error: 2
  double inlier_ratio = 0.0;
  int iterations = 0;
  std::string doubt;                           // MotionEstimate::doubt; empty if there is none
  std::optional<double> ransac_ms, refine_ms;  // none where times are left out

  // No estimate, or no refined one where a refinement was requested.
  bool failed = true;
};

// Metres. The direction of a shorter true translation is not compared: errors of the truth exceed
// it.
inline constexpr double kMinTrueTranslation = 1e-2;

// Runs one solver on a pair whose matches are selected and whose prior is applied.
PairResult ComparePair(const FramePair& pair, const EstimateOptions& options);

// The same for all `pairs`, in input order. Apart from the times, results do not depend on the
// number of threads. `progress` (may be empty) is called after each pair, from any thread.
std::vector<PairResult> RunSolver(const std::vector<FramePair>& pairs,
                                  const EstimateOptions& options, int num_threads,
                                  const std::function<void()>& progress);

// Mean NEES over mean degrees of freedom, and the 99 percent interval of this ratio if the
// covariance is right.
struct NeesStatistics {
  double ratio = 0.0;
  double dof = 0.0;
  double low = 0.0, high = 0.0;
};

struct SolverResults {
  std::string solver;
  std::vector<PairResult> pairs;
};

// Statistics of one solver over a group of pairs (docs/formats.md).
struct SolverSummary {
  std::string solver;
  std::string sequence = "all";
  int pairs = 0;
  int failures = 0;
  int direction_pairs = 0;
  std::optional<Statistics> raw_rotation_deg, raw_direction_deg, raw_scale;
  std::optional<Statistics> refined_rotation_deg, refined_direction_deg, refined_scale;
  std::optional<Statistics> refined_rig_direction_deg;
  std::optional<Statistics> bound_rotation_deg, bound_direction_deg, bound_rig_direction_deg;
  std::optional<NeesStatistics> nees, nees_rotation, nees_rig_direction;
  std::optional<Statistics> inlier_ratio, iterations, ransac_ms, refine_ms;
};

SolverSummary Summarize(const std::string& solver, const std::string& sequence,
                        const std::vector<PairResult>& results);

// "all" of each solver and then, if asked for, each sequence that has a name.
std::vector<SolverSummary> SummarizeAll(const std::vector<SolverResults>& solvers,
                                        bool by_sequence);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_COMPARISON_H_
