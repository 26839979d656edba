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
  // A name of SolverCatalogue(), or "auto": SuggestSolvers() of solver_choice.h, as many of them as
  // it takes to find a motion beyond doubt (motion_search.h), so that a wrong prior costs time and
  // not accuracy (unless refine.use_prior weighs it). With a form that takes the prior as exact
  // (kPrior, kPriorDepths) only the first of them.
  std::string solver = "auto";
  RansacOptions ransac;  // of "auto", its max_iterations are those of all solvers together
  bool refine_motion = true;
  // ScaleMode::kFixed needs the prior's distance: the |t| that RANSAC finds may be arbitrary.
  // The solver's prior replaces refine.prior_kind; refine.threshold_px is taken from ransac.
  RefineOptions refine;

  // Seconds from the call on, >= 0: after them the result is the best motion found by then, see
  // MotionEstimate::stopped. What prepares the matches and a step in progress are not cut short.
  std::optional<double> time_limit;
  // Ends the call likewise once it is true; any thread may set it. Null, or outlives the call.
  const std::atomic<bool>* cancel = nullptr;

  // Looks for what contradicts the rig (MotionEstimate::rig_doubts). Takes time where something
  // does: a second estimate or a few.
  bool check_rig = true;

  bool IsValid(std::string* error) const;
};

enum class EstimateStatus {
  kNotRun,
  kSuccess,
  kInvalidInput,   // the options, the pair or its prior: see message
  kTooFewMatches,  // fewer than the solver's sample
  kNoSolution,     // no sample gave a motion
  kNotRefined,     // RANSAC succeeded, the refinement did not: pose is RANSAC's
  kNoConsensus,    // no more matches agree than chance allows: pose means nothing
};

const char* EstimateStatusName(EstimateStatus status);
// False if there is no status of that name.
bool ParseEstimateStatus(std::string_view name, EstimateStatus* status);

struct MotionEstimate {
  EstimateStatus status = EstimateStatus::kNotRun;
  std::string message = "EstimateMotion was not called.";
  std::string solver;               // whose hypotheses led to it
  std::vector<SolverTrial> trials;  // what became of each solver; several with "auto"
  Pose pose;                        // the estimate: refined where that was asked for and done
  Solution raw;  // the best-scoring minimal hypothesis of RANSAC, before any optimization
  int num_inliers = 0;
  double inlier_ratio = 0.0;
  int iterations = 0;
  int64_t hypotheses = 0;
  double ransac_ms = 0.0;
  double refine_ms = 0.0;
  RefineSummary refine;
  // What ended the call early; message says it too. The motion, if there is one, is the best found
  // by then, and refine states no uncertainty unless it was done.
  StopReason stopped = StopReason::kNone;
  // Something speaks against the motion, as where the prior is wrong: see Doubt.
  bool doubtful = false;
  std::string doubt;                 // what; empty if nothing does
  std::vector<RigDoubt> rig_doubts;  // of a refined motion; the estimate is as without them

  bool HasMotion() const {
    return status == EstimateStatus::kSuccess || status == EstimateStatus::kNotRefined;
  }
};

// Never throws, exits or logs on what `pair` or `options` hold. Thread-safe; the same input and
// seed give the same result, unless a time limit or a cancel ended the search.
MotionEstimate EstimateMotion(const EstimateOptions& options, const FramePair& pair);

}  // namespace rigel

#endif  // RIGEL_REFINE_ESTIMATE_MOTION_H_
