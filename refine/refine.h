// Refinement of a motion on matches: nonlinear least squares with Ceres on epipolar residuals, with
// re-selection of inliers, the sign of t by cheirality, and the uncertainty of the result.
#ifndef RIGEL_REFINE_REFINE_H_
#define RIGEL_REFINE_REFINE_H_

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/match.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/core/pose.h"
#include "rigel/core/prior.h"
#include "rigel/core/rig.h"
#include "rigel/core/stop.h"
#include "rigel/refine/least_squares/least_squares.h"

namespace rigel {

class GroupedMatches;

// Which parameters are free; every form uses the exact rotation.
enum class RefineForm {
  kFull,         // rotation (3), translation (3; 2 on the sphere where scale is not observable)
  kPrior,        // the prior is exact: its angle, and t (planar: t in the plane)
  kDepths,       // rotation (3), l1 and l2 of a reference match, which is exact too (the paper)
  kPriorDepths,  // the angle, l1 and l2 (planar: one depth less): the paper's model in full
  kBundle,       // as kFull, and each inlier's point: reprojection errors, whatever `residual` says
};

const char* RefineFormName(RefineForm form);  // "full", "prior", ..., "bundle"
bool ParseRefineForm(std::string_view name, RefineForm* form);
const char* ResidualName(ResidualKind kind);  // "sampson", "angular", "algebraic"
bool ParseResidual(std::string_view name, ResidualKind* kind);

enum class ScaleMode {
  kAuto,  // free where the matches determine it (kScaleObservableRatio), else kept as it was found
  kFree,
  kFixed,  // |t| is the prior's distance where it has one, else as at the start
};

// Between Gaussian noise and outliers anywhere in an image, residuals beyond this many sigma are
// likelier outliers. A gate at 3 sigma costs 2 to 3 percent of the accuracy.
inline constexpr double kGateSigmas = 3.75;

// What the least squares run on. Both have the same minimum.
enum class RefineEngine {
  kAuto,   // the small engine (small_engine.h) where it can: Sampson residuals, not kBundle
  kCeres,  // a ceres::Problem
};

// Where a refinement is.
struct RefineProgress {
  int round = 0;      // from 1
  int iteration = 0;  // of the round's least squares, from 0
  double cost = 0.0;  // 1/2 sum rho(r^2) by now
};

// What a user sets, in Refine() and in EstimateMotion() alike.
struct RefineSettings {
  RefineForm form = RefineForm::kFull;
  ResidualKind residual = ResidualKind::kSampson;
  // Adds the prior as residuals weighted by its sigma, with its distance if it has one; a part
  // without a sigma stays out.
  bool use_prior = false;

  // Matches near an epipole count less (EpipoleWeights), in the fit and in the covariance.
  bool epipole_weights = true;

  LossKind loss = LossKind::kCauchy;
  // Scale of the loss in units of the image noise (given, or estimated from the start); > 0.
  double loss_scale_sigmas = 4.0;

  RefineEngine engine = RefineEngine::kAuto;

  int max_rounds = 5;           // >= 1; selections of inliers
  int max_num_iterations = 50;  // >= 0, a round
  ScaleMode scale = ScaleMode::kAuto;
  // 1-sigma image noise where it is known; else estimated: 1.4826 times the median |residual| of
  // the n inliers, times sqrt(n / (n - 6)); at least a third of the threshold below 16 inliers.
  std::optional<double> noise_px;

  // Seconds from the call on, >= 0, and a flag that any thread may set: either ends the refinement
  // with Termination::kStopped after the iteration in progress.
  std::optional<double> time_limit;
  const std::atomic<bool>* cancel = nullptr;  // null, or outlives the call
  // Called after each iteration, where it is not empty, by the thread that called Refine().
  std::function<void(const RefineProgress&)> progress;

  bool IsValid(std::string* error) const;
};

// All that Refine() takes. The search that found the start knows what is added here:
// EstimateMotion() takes it from its solver and RANSAC.
struct RefineOptions : RefineSettings {
  RefineOptions() = default;
  explicit RefineOptions(const RefineSettings& settings) : RefineSettings(settings) {}

  // Which part of the prior the forms kPrior and kPriorDepths take as exact, and which part
  // use_prior weighs.
  PriorKind prior_kind = PriorKind::kNone;
  // > 0; matches with a larger Sampson error are left out. Where the noise is given, nothing below
  // kGateSigmas of it is. kAutoThresholdPx: as of RansacOptions.
  double threshold_px = kAutoThresholdPx;
  // >= 1; so many motions were tried before the start was found, which the number of matches that
  // agree must make up for (RefineSummary::exceeds_chance).
  double num_tries = 1e4;

  bool IsValid(std::string* error) const;
};

enum class Termination {
  kNotRun,
  kConverged,
  kIterationLimit,  // usable, not converged
  kDegenerate,      // the matches do not determine the free parameters; pose unchanged
  kFailure,         // wrong input; pose unchanged
  // By the time limit or the flag: pose is the best by then. It is no minimum, so that there is no
  // covariance, and nothing is called observable.
  kStopped,
};

const char* TerminationName(Termination termination);

// How many of the matches from camera1 at time 1 to camera2 at time 2 fit.
struct CameraPairFit {
  int camera1 = 0;
  int camera2 = 0;
  int rows = 0;
  int inliers = 0;
  // Unit direction of R s_i + t - s_j in the body frame at time 2: what such matches alone know of
  // the translation. Zero without a baseline.
  std::array<double, 3> baseline = {0, 0, 0};
};

struct RefineSummary {
  Termination termination = Termination::kNotRun;
  std::string message = "Refine was not called.";
  StopReason stopped = StopReason::kNone;  // what stopped it, with kStopped
  int num_rounds = -1;
  int num_iterations = -1;     // of all rounds
  double initial_cost = -1.0;  // 1/2 sum rho(r^2) over the first and the last selection
  double final_cost = -1.0;

  int num_inliers = 0;
  std::vector<char> inliers;                // 1 or 0 for each match, in the order of the input
  std::vector<CameraPairFit> camera_pairs;  // by camera1, then camera2
  double median_residual_px = -1.0;         // median |Sampson error| of the inliers
  double noise_px = -1.0;                   // given or estimated

  // Covariance of (rotation, translation) for R <- Exp(d) R, t <- t + e over the parameters that
  // were free: of rank 5 where |t| was held, 2 to 4 where the prior was exact. Where the
  // direction of t is not observable, of all six, so that the rotation's part covers what the
  // translation may be. The depth forms state it without the error of their reference. Empty if
  // not determined.
  std::optional<Matrix6d> covariance;
  std::string weakest_direction;  // of the covariance, in words (WeakestDirection)
  double rotation_sigma = -1.0;   // radians; -1 if there is no covariance
  double direction_sigma = -1.0;  // of t, radians
  // FittedPoint(). Where its length was held, the information lacks what is along b.
  Eigen::Vector3d fitted_point = Eigen::Vector3d::Zero();
  double rig_direction_sigma = -1.0;   // of b, radians: small where a long lever spoils that of t
  double relative_scale_sigma = -1.0;  // of |b|, a fraction; infinite if not determined
  double parallax_px = -1.0;           // see ParallaxPercentilePx()
  double parallax_limit_px = -1.0;     // what it has to exceed for translation_observable
  bool scale_free = false;             // |t| was refined, not held
  bool exceeds_chance = false;         // more matches agree than random ones would
  bool rotation_observable = false;
  bool translation_observable = false;      // the direction of t means something
  bool rig_translation_observable = false;  // that of b does
  bool scale_observable = false;

  bool IsSolutionUsable() const {
    return termination == Termination::kConverged || termination == Termination::kIterationLimit ||
           termination == Termination::kStopped;
  }
  // The direction of the rig's own motion is known: enough for an edge or a step.
  bool RigDirectionKnown() const { return translation_observable || rig_translation_observable; }
  std::string BriefReport() const;
  // The one camera pair that all inliers are of, if that is of two cameras: it fixes the motion up
  // to the length of its baseline, whatever |t| is. Null otherwise.
  const CameraPairFit* OnlyCameraPair() const;
  // One clause on what is and what is not observable, and by how much.
  std::string ObservabilityReport() const;
};
static_assert(kSameLayoutEverywhere<RefineSummary>, "no member of RefineSummary may be aligned");

// Refines `pose`, which must be near the motion. Never throws, exits or logs; on kDegenerate and
// kFailure `pose` is unchanged. Thread-safe; deterministic unless stopped.
RefineSummary Refine(const RefineOptions& options, const GroupedMatches& matches,
                     const MotionPrior& prior, Pose* pose);
RefineSummary Refine(const RefineOptions& options, const Rig& rig,
                     const std::vector<Match>& matches, const MotionPrior& prior, Pose* pose);

// The point of the body whose motion b a refinement fits (rig_centre.h): the rig's centre, or the
// body's origin where the options hold |t| of the body or weigh the prior's distance.
Eigen::Vector3d FittedPoint(const RefineOptions& options, const MotionPrior& prior, const Rig& rig);

// The same where the origin of the body frame of `matches` is `origin` of the body's: `pose` and
// the summary are of the body. With `origin` the rig's centre nothing is copied.
RefineSummary RefineAbout(const RefineOptions& options, const GroupedMatches& matches,
                          const Eigen::Vector3d& origin, const MotionPrior& prior, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_REFINE_H_
