// Refinement of a motion: nonlinear least squares on the epipolar errors of the inliers.
//
// In turns it minimizes the errors and selects the inliers again. The sign of t comes from
// cheirality (points lie in front of their cameras). The summary has the covariance and what is
// observable. Motions are f2_from_f1, X_2 = R X_1 + t, in radians and metres.
//
// GroupedMatches and the functions that take it are internal: its header is not installed.
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

// Which parameters are free. Every form uses the exact rotation.
enum class RefineForm {
  kFull,   // rotation (3), translation (3)
  kPrior,  // the prior is exact: the angle about its direction, and t (planar: in the plane)
  // Rotation (3), depths l1, l2 of a reference match, which is exact (paper eqs. a2, a5).
  kDepths,
  kPriorDepths,  // the angle, l1 and l2 (planar: one depth less): the paper's model
  kBundle,       // as kFull, and the point of each inlier; reprojection errors, not `residual`
};

const char* RefineFormName(RefineForm form);  // "full", "prior", ..., "bundle"
bool ParseRefineForm(std::string_view name, RefineForm* form);
const char* ResidualName(ResidualKind kind);  // "sampson", "angular", "algebraic"
bool ParseResidual(std::string_view name, ResidualKind* kind);

// The least-squares engine. Both have the same minimum.
enum class RefineEngine {
  kAuto,   // the small engine (small_engine.h) for Sampson residuals and all forms but kBundle
  kCeres,  // a ceres::Problem
};

// The state of a refinement that runs.
struct RefineProgress {
  int round = 0;      // from 1
  int iteration = 0;  // within the round, from 0
  double cost = 0.0;  // 1/2 sum rho(r^2)
};

// The options that a user sets for Refine() and for EstimateMotion().
struct RefineSettings {
  RefineForm form = RefineForm::kFull;
  ResidualKind residual = ResidualKind::kSampson;
  // Adds the prior's direction (gravity, axis or normal) as residuals, divided by their sigma. One
  // without a sigma is left out.
  bool use_prior = false;

  // The length |b| of the motion of the rig's centre is always estimated. A distance that the prior
  // states with a sigma is a measurement and enters. What the matches leave open is held by a weak
  // prior: log |b| is normal with standard deviation 1 about the log of the stated distance, or of
  // this length; metres, > 0.
  double typical_length = 1.0;
  // Holds |t| of the body at the prior's distance, or as at the start if it has none, instead.
  bool hold_distance = false;

  // Gives matches near an epipole a smaller weight (EpipoleWeights), in the fit and in the
  // covariance.
  bool epipole_weights = true;

  LossKind loss = LossKind::kTukey;
  // Scale of the loss in units of the image noise (given, or estimated from the start); > 0.
  double loss_scale_sigmas = 6.0;

  RefineEngine engine = RefineEngine::kAuto;

  int max_rounds = 5;           // >= 1; selections of inliers
  int max_num_iterations = 50;  // >= 0, in each round
  // 1-sigma image noise, pixels, if it is known. Else it is estimated for each camera pair
  // (noise_model.h).
  std::optional<double> noise_px;

  // Seconds from the call on, >= 0, and a flag that any thread may set: either ends the refinement
  // with Termination::kStopped after the iteration in progress.
  std::optional<double> time_limit;
  const std::atomic<bool>* cancel = nullptr;  // null, or outlives the call
  // Called after each iteration, if not empty, by the thread that called Refine().
  std::function<void(const RefineProgress&)> progress;

  // False with a message in `error` (not null) if a member is out of its range.
  bool IsValid(std::string* error) const;
};

// All options of Refine(). The members added here depend on the search that found the start:
// EstimateMotion() sets them from its solver and RANSAC.
struct RefineOptions : RefineSettings {
  RefineOptions() = default;
  explicit RefineOptions(const RefineSettings& settings) : RefineSettings(settings) {}

  // The part of the prior that kPrior and kPriorDepths take as exact and that use_prior weights.
  PriorKind prior_kind = PriorKind::kNone;
  // Pixels, > 0; matches with a larger Sampson error are left out. If the noise is given, the limit
  // is at least 3.75 sigma of it. kAutoThresholdPx: at first as in RansacOptions, then 3.75 sigma
  // of each camera pair.
  double threshold_px = kAutoThresholdPx;
  // Number of motions that were tried before the start was found, >= 1. The more were tried, the
  // more matches must agree (RefineSummary::exceeds_chance).
  double num_tries = 1e4;

  bool IsValid(std::string* error) const;
};

enum class Termination {
  kNotRun,
  kConverged,
  kIterationLimit,  // usable, not converged
  kDegenerate,      // the matches do not determine the free parameters; pose unchanged
  kFailure,         // wrong input; pose unchanged
  // By the time limit or the flag: pose is the best by then. It is not a minimum, so there is no
  // covariance, and nothing counts as observable.
  kStopped,
};

const char* TerminationName(Termination termination);

// How many of the matches from camera1 at time 1 to camera2 at time 2 fit.
struct CameraPairFit {
  int camera1 = 0;
  int camera2 = 0;
  int rows = 0;  // matches of the pair
  int inliers = 0;
  // Unit direction of the baseline R s_i + t - s_j in the body frame at time 2. Matches of this
  // pair alone determine no more of the translation. Zero without a baseline.
  std::array<double, 3> baseline = {0, 0, 0};
  double noise_px = -1.0;  // 1 sigma, given or estimated
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
  // 1 or 0 for each match, in the order of the input. A match that is listed again has the flag of
  // the first, and counts once in num_inliers.
  std::vector<char> inliers;
  std::vector<CameraPairFit> camera_pairs;  // by camera1, then camera2
  double median_residual_px = -1.0;         // median |Sampson error| of the inliers
  double noise_px = -1.0;                   // given or estimated

  // Covariance of the perturbation (d, e) of R <- Exp(d) R, t <- t + e: rotation (radians) first,
  // then translation (metres). It covers the parameters that were free: all six, 5 if |t| was held,
  // 2 to 4 if the prior was exact. The depth forms take their reference as exact here. Empty if not
  // determined. With the stated errors of the calibration.
  std::optional<Matrix6d> covariance;
  // The same of the motion (R, b) of the rig's centre, see below. With a body's origin far from the
  // cameras it is the more accurate one: it has no differences of large numbers.
  std::optional<Matrix6d> rig_covariance;
  // Where the rig states errors of its calibration (RigCamera): the part of `covariance` that they
  // make. It is the same error in all pairs of the rig, so that it adds up along a drive, and the
  // rest does not. And for each camera the derivatives of (d, e) by its errors: the turn d of
  // Q <- Exp(d) Q (radians), the shift e of s <- s + e (metres), the growth of the focal lengths.
  std::optional<Matrix6d> calibration_covariance;
  std::vector<UnalignedMatrix<6, 7>> calibration_gain;
  // Another motion of the body that fits as well within what the noise allows: a plane that one
  // camera sees has two. Where the two differ by more than the standard deviations, nothing that
  // differs is observable. Looked for among the motions that the search found.
  std::optional<Pose> other_motion;
  // False if the noise of the pixels makes so much of the information that a linear theory of the
  // errors does not hold: see covariance_note. The covariance is then a rough one.
  bool covariance_valid = false;
  std::string covariance_note;    // why it is not valid; empty if it is
  std::string weakest_direction;  // of the covariance, in words (WeakestDirection)
  double rotation_sigma = -1.0;   // radians; -1 if there is no covariance
  double direction_sigma = -1.0;  // of t, radians
  // The motion b = R c + t - c of the rig's centre c (RigCentre(), body frame, metres): its unit
  // direction in the body frame at time 2, and that direction's standard deviation. It is often
  // known where the direction of t is not: with an origin far from the cameras and unknown |b|.
  Eigen::Vector3d rig_center = Eigen::Vector3d::Zero();
  Eigen::Vector3d rig_direction = Eigen::Vector3d::Zero();
  double rig_direction_sigma = -1.0;   // radians
  double relative_scale_sigma = -1.0;  // of |b| by the matches alone; infinite if not determined
  double length_sigma = -1.0;          // of |b| with a stated distance and the weak prior
  bool length_held = false;            // |t| was held
  double parallax_px = -1.0;           // see ParallaxPercentilePx()
  double parallax_limit_px = -1.0;     // what it has to exceed for translation_observable
  // The rig stands: b = 0 and a rotation alone explain both components of the pixels. `covariance`
  // says what t can be at most, if points are 50 typical lengths away.
  bool stands = false;
  bool exceeds_chance = false;  // more matches agree than random ones would
  bool rotation_observable = false;
  bool translation_observable = false;      // the direction of t is observable
  bool rig_translation_observable = false;  // the direction of b is
  bool scale_observable = false;            // relative_scale_sigma is at most 5 percent

  bool IsSolutionUsable() const {
    return termination == Termination::kConverged || termination == Termination::kIterationLimit ||
           termination == Termination::kStopped;
  }
  // The direction of the rig's own motion is known, which an edge or a step of a trajectory needs.
  bool RigDirectionKnown() const { return translation_observable || rig_translation_observable; }
  std::string BriefReport() const;
  // If all inliers are of one pair of different cameras: that pair, else null. Such matches
  // determine the motion except the length of the pair's baseline.
  const CameraPairFit* OnlyCameraPair() const;
  // One clause that says what is observable and what is not, with the standard deviations.
  std::string ObservabilityReport() const;
};
static_assert(kSameLayoutEverywhere<RefineSummary>, "no member of RefineSummary may be aligned");

// Refines `pose` (f2_from_f1 of the body, metres), which must be near the true motion. `pose` must
// not be null. Never throws, exits or logs. On kDegenerate and kFailure `pose` is unchanged and the
// summary has a message. Thread-safe; deterministic unless stopped. Times of cameras and columns of
// matches are left out: EstimateMotion() takes them.
RefineSummary Refine(const RefineOptions& options, const Rig& rig,
                     const std::vector<Match>& matches, const MotionPrior& prior, Pose* pose);
// Internal: the same for matches that are grouped already.
RefineSummary Refine(const RefineOptions& options, const GroupedMatches& matches,
                     const MotionPrior& prior, Pose* pose);

// Internal: Refine() for `matches` whose body frame has its origin at the point `origin` of the
// body. `pose` and the summary are of the body. If `origin` is the rig's centre, the matches are
// not copied. `others` are motions of the body that may fit as well as `pose`: the best is taken.
RefineSummary RefineAbout(const RefineOptions& options, const GroupedMatches& matches,
                          const Eigen::Vector3d& origin, const MotionPrior& prior,
                          const std::vector<Pose>& others, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_REFINE_H_
