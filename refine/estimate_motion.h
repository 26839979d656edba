// The whole estimate of a frame pair in one call: RANSAC over a minimal solver, then Refine().
#ifndef RIGEL_REFINE_ESTIMATE_MOTION_H_
#define RIGEL_REFINE_ESTIMATE_MOTION_H_

#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/ransac.h"
#include "rigel/minimal/solutions.h"
#include "rigel/refine/refine.h"

namespace rigel {

struct EstimateOptions {
  // A name of SolverCatalogue(), or "auto": SuggestSolvers() of solver_choice.h, one after the
  // other while the result is doubtful, so that a wrong prior costs time and not accuracy (unless
  // refine.use_prior weighs it). With a form that takes the prior as exact (kPrior, kPriorDepths)
  // only the first of them.
  std::string solver = "4pt-axis";
  RansacOptions ransac;
  bool refine_motion = true;
  // ScaleMode::kFixed needs the prior's distance: the |t| that RANSAC finds may be arbitrary.
  // The solver's prior replaces refine.prior_kind; refine.threshold_px is taken from ransac.
  RefineOptions refine;

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
};

const char* EstimateStatusName(EstimateStatus status);

enum class RigDoubtKind {
  kFrozen,   // camera1 shows the same image twice
  kFewFit,   // few of the matches between camera1 and camera2 fit
  kSwapped,  // more would fit if the two were swapped
};

// What in a pair contradicts its rig, for a person to look into (rig_doubts.h).
struct RigDoubt {
  RigDoubtKind kind = RigDoubtKind::kFewFit;
  int camera1 = 0;  // at most camera2
  int camera2 = 0;
  std::string message;  // "cameras 0-1: 12 of 760 fit; are they swapped, ..."
};

struct MotionEstimate {
  EstimateStatus status = EstimateStatus::kNotRun;
  std::string message = "EstimateMotion was not called.";
  std::string solver;  // whose hypotheses led to it
  Pose pose;           // the estimate: refined where that was asked for and done
  Solution raw;        // the best-scoring minimal hypothesis of RANSAC, before any optimization
  int num_inliers = 0;
  double inlier_ratio = 0.0;
  int iterations = 0;
  int64_t hypotheses = 0;
  double ransac_ms = 0.0;
  double refine_ms = 0.0;
  RefineSummary refine;
  std::vector<RigDoubt> rig_doubts;  // of a refined motion; the estimate is as without them

  bool HasMotion() const {
    return status == EstimateStatus::kSuccess || status == EstimateStatus::kNotRefined;
  }
};

// Never throws, exits or logs on what `pair` or `options` hold. Thread-safe; the same input and
// seed give the same result.
MotionEstimate EstimateMotion(const EstimateOptions& options, const FramePair& pair);

}  // namespace rigel

#endif  // RIGEL_REFINE_ESTIMATE_MOTION_H_
