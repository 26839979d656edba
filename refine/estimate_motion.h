// The whole estimate of a frame pair in one call: RANSAC over a minimal solver, then Refine().
#ifndef RIGEL_REFINE_ESTIMATE_MOTION_H_
#define RIGEL_REFINE_ESTIMATE_MOTION_H_

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/stop.h"
#include "rigel/minimal/ransac/ransac_options.h"
#include "rigel/minimal/solvers/solutions.h"
#include "rigel/refine/refine.h"
#include "rigel/refine/rig_doubts.h"
#include "rigel/refine/search/doubt.h"

namespace rigel {

struct EstimateOptions {
  // A name of SolverCatalogue(), or "auto". "auto" tries the solvers of SuggestSolvers()
  // (solver_choice.h) in turn until a motion is not doubtful (motion_search.h). So a wrong prior
  // costs time and not accuracy, unless refine.use_prior weights it. With a form that takes the
  // prior as exact (kPrior, kPriorDepths), "auto" uses only the first solver.
  std::string solver = "auto";
  RansacOptions ransac;  // with "auto", all solvers share its max_iterations
  bool refine_motion = true;
  // refine.hold_distance needs the prior's distance: the |t| that RANSAC finds may be arbitrary.
  RefineSettings refine;

  // Seconds from the call on, >= 0. After them the call returns the best motion found by then; see
  // MotionEstimate::stopped. It does not interrupt the preparation of the matches or a step in
  // progress.
  std::optional<double> time_limit;
  // Ends the call in the same way once it is true; any thread may set it. Null, or outlives the
  // call.
  const std::atomic<bool>* cancel = nullptr;

  // Looks for matches that contradict the rig (MotionEstimate::rig_doubts). If there are some, it
  // takes the time of one or a few more estimates.
  bool check_rig = true;

  // False with a message in `error` (not null) if a member is out of its range.
  bool IsValid(std::string* error) const;
};

enum class EstimateStatus {
  kNotRun,
  kSuccess,
  kInvalidInput,   // the options, the pair or its prior: see message
  kTooFewMatches,  // fewer than the solver's sample
  kNoSolution,     // no sample gave a motion
  kNotRefined,     // RANSAC succeeded, the refinement did not: pose is RANSAC's
  kNoConsensus,    // random matches could agree as well: pose means nothing
};

const char* EstimateStatusName(EstimateStatus status);
// False if there is no status of that name.
bool ParseEstimateStatus(std::string_view name, EstimateStatus* status);

struct MotionEstimate {
  EstimateStatus status = EstimateStatus::kNotRun;
  std::string message = "EstimateMotion was not called.";
  std::string solver;               // the solver whose hypothesis led to the estimate
  std::vector<SolverTrial> trials;  // the result of each solver; several with "auto"
  Pose pose;                        // f2_from_f1, metres; refined if that was asked for and done
  Solution raw;  // the best-scoring minimal hypothesis of RANSAC, before any optimization
  int num_inliers = 0;
  double inlier_ratio = 0.0;
  int iterations = 0;
  int64_t hypotheses = 0;
  double ransac_ms = 0.0;
  double refine_ms = 0.0;
  RefineSummary refine;
  // What ended the call early; message says it too. The motion, if there is one, is the best found
  // by then. `refine` states no uncertainty unless the refinement was done.
  StopReason stopped = StopReason::kNone;
  // The motion may be wrong, for example because of a wrong prior: see Doubt.
  bool doubtful = false;
  std::string doubt;                 // why; empty if it is not doubtful
  std::vector<RigDoubt> rig_doubts;  // of a refined motion; they do not change the estimate

  bool HasMotion() const {
    return status == EstimateStatus::kSuccess || status == EstimateStatus::kNotRefined;
  }
};

// Estimates the motion f2_from_f1 of the body: X_2 = R X_1 + t, metres. Errors are in the status.
// Never throws, exits or logs because of what `pair` or `options` hold. Thread-safe. The same input
// and seed give the same result, unless a time limit or `cancel` ended the search.
MotionEstimate EstimateMotion(const EstimateOptions& options, const FramePair& pair);

}  // namespace rigel

#endif  // RIGEL_REFINE_ESTIMATE_MOTION_H_
