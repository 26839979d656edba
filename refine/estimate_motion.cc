#include "rigel/refine/estimate_motion.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rigel/core/alignment.h"
#include "rigel/core/body_axes.h"
#include "rigel/core/enum_names.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/core/rig_centre.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/solvers/two_point_ackermann.h"
#include "rigel/refine/search/chance.h"
#include "rigel/refine/search/motion_search.h"
#include "rigel/refine/search/noise_model.h"
#include "rigel/refine/search/shared_pixels.h"
#include "rigel/refine/solver_choice.h"

namespace rigel {
namespace {

constexpr EnumName<EstimateStatus> kStatusNames[] = {
    {EstimateStatus::kNotRun, "not run"},
    {EstimateStatus::kSuccess, "ok"},
    {EstimateStatus::kInvalidInput, "invalid input"},
    {EstimateStatus::kTooFewMatches, "too few matches"},
    {EstimateStatus::kNoSolution, "no solution"},
    {EstimateStatus::kNotRefined, "not refined"},
    {EstimateStatus::kNoConsensus, "no consensus"}};

double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

// The prior, with the rig's forward direction if it states none. Ackermann motion needs it.
MotionPrior WithForward(const FramePair& pair) {
  MotionPrior prior = pair.prior;
  BodyAxes axes;
  std::string error;
  if (!prior.forward && ResolveBodyAxes(pair.rig, {}, {}, &axes, &error)) {
    prior.forward = axes.forward;
  }
  return prior;
}

}  // namespace

const char* EstimateStatusName(EstimateStatus status) { return NameOf(kStatusNames, status); }

bool ParseEstimateStatus(std::string_view name, EstimateStatus* status) {
  return FindValue(kStatusNames, name, status);
}

bool EstimateOptions::IsValid(std::string* error) const {
  if (!IsSolverName(solver)) {
    *error = "there is no solver '" + solver + "'; expected one of " + SolverNamesWithAuto();
    return false;
  }
  RefineOptions refined(refine);
  // With "auto" the prior's kind is not known yet; any kind is valid here.
  refined.prior_kind = solver == kAutoSolver ? PriorKind::kVertical : FindSolver(solver)->prior;
  return ransac.IsValid(error) && (!refine_motion || refined.IsValid(error)) &&
         IsValidTimeLimit(time_limit, error);
}

namespace {

// One estimate, stage by stage.
class Estimator {
 public:
  Estimator(const EstimateOptions& options, const FramePair& pair)
      : options_(options), pair_(pair), stop_(options.time_limit, options.cancel) {}

  MotionEstimate Run() {
    if (!Check()) return estimate_;
    GroupMatches();
    Search();
    if (!TakeMotion()) return estimate_;
    if (options_.refine_motion) Refine();
    Judge();
    return estimate_;
  }

 private:
  bool Refuse(EstimateStatus status, const std::string& message);
  bool Check();
  bool ChooseSolvers();
  void GroupMatches();
  void Search();
  bool TakeMotion();
  void Refine();
  void Judge();
  std::string WhyRaysAreMissing() const;
  void CheckRig(const Doubt& doubt);
  bool ExceedsChanceUnrefined() const;
  bool Refined() const { return estimate_.refine.IsSolutionUsable(); }
  bool HoldsPrior() const {
    return options_.refine_motion && (options_.refine.form == RefineForm::kPrior ||
                                      options_.refine.form == RefineForm::kPriorDepths);
  }

  const EstimateOptions& options_;
  const FramePair& pair_;
  Stop stop_;
  std::vector<const SolverInfo*> solvers_;
  MotionPrior prior_;
  RansacOptions ransac_;
  DistinctSet distinct_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  GroupedMatches matches_;
  MotionSearch search_;
  MotionEstimate estimate_;
};

bool Estimator::Refuse(EstimateStatus status, const std::string& message) {
  estimate_.status = status;
  estimate_.message = message;
  return false;
}

bool Estimator::Check() {
  std::string error;
  if (!options_.IsValid(&error) || !pair_.IsValid(&error)) {
    return Refuse(EstimateStatus::kInvalidInput, error);
  }
  const double distance = pair_.prior.distance.value_or(0.0);
  if (options_.refine_motion && options_.refine.hold_distance && !(distance > 0)) {
    return Refuse(EstimateStatus::kInvalidInput,
                  "|t| is to be held, and the prior states no positive distance");
  }
  ransac_ = options_.ransac;
  ransac_.threshold_px = ThresholdPx(options_.ransac.threshold_px, pair_.rig);
  return ChooseSolvers();
}

bool Estimator::ChooseSolvers() {
  solvers_ = {FindSolver(options_.solver)};
  if (options_.solver == kAutoSolver) {
    solvers_ = SuggestSolvers(pair_.prior);
    if (HoldsPrior()) solvers_.resize(1);
    if (HoldsPrior() && solvers_[0]->prior == PriorKind::kNone) {
      return Refuse(EstimateStatus::kInvalidInput,
                    std::string("auto: there is no prior for the refinement '") +
                        RefineFormName(options_.refine.form) + "' to hold");
    }
  }
  prior_ = WithForward(pair_);
  for (const SolverInfo* solver : solvers_) {
    Alignment alignment;
    std::string error;
    if (!MakeAlignment(prior_, solver->prior, &alignment, &error)) {
      return Refuse(EstimateStatus::kInvalidInput, options_.solver + ": " + error);
    }
  }
  return true;
}

// The search is for the motion of the rig's centre; the body's motion is computed from it at the
// end. The Ackermann model describes the motion of the body's origin.
void Estimator::GroupMatches() {
  const auto start = std::chrono::steady_clock::now();
  if (solvers_[0]->solve != &Solve2ptAckermann) centre_ = RigCentre(pair_.rig);
  distinct_ = KeepDistinct(pair_.matches, pair_.columns);
  matches_ = GroupedMatches(WithOrigin(pair_.rig, centre_), distinct_.matches, distinct_.columns,
                            pair_.Interval());
  estimate_.ransac_ms = MillisecondsSince(start);
}

void Estimator::Search() {
  const auto start = std::chrono::steady_clock::now();
  search_ = SearchMotion(solvers_, prior_, matches_, ransac_, &stop_);
  // RANSAC counted the inliers among the matches that it scored; this counts them among all.
  if (search_.best.found && matches_.size() > ransac_.max_scored) {
    matches_.ScoreInFront(search_.best.best, ransac_.threshold_px,
                          std::numeric_limits<double>::infinity(), &search_.best.num_inliers);
  }
  estimate_.ransac_ms += MillisecondsSince(start);
}

// Takes over the result of the search. False if there is no motion.
bool Estimator::TakeMotion() {
  estimate_.iterations += search_.iterations;
  estimate_.hypotheses += search_.hypotheses;
  estimate_.trials = std::move(search_.trials);
  estimate_.stopped = stop_.reason();
  if (search_.solver == nullptr) {
    const std::string without_rays = WhyRaysAreMissing();
    return Refuse(matches_.size() < solvers_[0]->sample_size ? EstimateStatus::kTooFewMatches
                                                             : EstimateStatus::kNoSolution,
                  estimate_.trials[0].note + (without_rays.empty() ? "" : "; " + without_rays));
  }
  estimate_.solver = search_.solver->name;
  const RansacResult<Solution>& ransac = search_.best;
  if (!ransac.found) {
    return Refuse(EstimateStatus::kNoSolution,
                  estimate_.stopped != StopReason::kNone
                      ? stop_.Message() + " before a motion was found"
                      : "no sample of the matches determines a motion");
  }
  estimate_.raw = ransac.best_minimal;
  estimate_.raw.t = MotionOfBody(ransac.best_minimal, centre_).t;
  estimate_.pose = MotionOfBody(ransac.best, centre_);
  estimate_.num_inliers = ransac.num_inliers;
  estimate_.status = EstimateStatus::kSuccess;
  estimate_.message = estimate_.stopped != StopReason::kNone ? stop_.Message() : "ok";
  return true;
}

void Estimator::Refine() {
  const auto start = std::chrono::steady_clock::now();
  RefineOptions refine(options_.refine);
  refine.prior_kind = search_.solver->prior;
  refine.threshold_px = options_.ransac.threshold_px;
  refine.num_tries = std::max(1.0, static_cast<double>(estimate_.hypotheses));
  const std::optional<double> left = stop_.SecondsLeft();
  if (left) refine.time_limit = std::min(*left, refine.time_limit.value_or(*left));
  if (refine.cancel == nullptr) refine.cancel = options_.cancel;
  std::vector<Pose> others;
  for (int k = 0; k < search_.best.num_others; ++k) {
    others.push_back(MotionOfBody(search_.best.others[k], centre_));
  }
  estimate_.refine = RefineAbout(refine, matches_, centre_, pair_.prior, others, &estimate_.pose);
  estimate_.refine_ms += MillisecondsSince(start);
  if (!Refined()) {
    estimate_.status = EstimateStatus::kNotRefined;
    estimate_.message = "not refined: " + estimate_.refine.message;
    return;
  }
  estimate_.num_inliers = estimate_.refine.num_inliers;
  if (estimate_.refine.stopped == StopReason::kNone) return;
  estimate_.stopped = estimate_.refine.stopped;
  // Refine() was given only the rest of the limit; the message names the whole.
  if (stop_.Asked()) estimate_.refine.message = stop_.Message();
  estimate_.message = estimate_.refine.message;
}

bool Estimator::ExceedsChanceUnrefined() const {
  return ExceedsChance(matches_, MotionOfPoint(estimate_.pose, centre_), estimate_.num_inliers,
                       matches_.size(), ransac_.threshold_px,
                       static_cast<double>(estimate_.hypotheses));
}

// Consensus and doubts, over the distinct matches; then the inliers among all.
void Estimator::Judge() {
  estimate_.inlier_ratio = estimate_.num_inliers / static_cast<double>(matches_.size());
  if (Refined()) estimate_.refine.inliers = distinct_.OfAll(estimate_.refine.inliers);
  if (!(Refined() ? estimate_.refine.exceeds_chance : ExceedsChanceUnrefined())) {
    estimate_.status = EstimateStatus::kNoConsensus;
    estimate_.message = std::to_string(estimate_.num_inliers) + " of " +
                        std::to_string(matches_.size()) +
                        " matches agree on a motion, no more than chance allows";
    if (options_.solver != kAutoSolver && search_.solver->prior != PriorKind::kNone) {
      estimate_.message += "; is the prior right?";
    }
    const std::string without_rays = WhyRaysAreMissing();
    if (!without_rays.empty()) estimate_.message += "; " + without_rays;
    if (estimate_.stopped != StopReason::kNone) estimate_.message += "; " + stop_.Message();
    return;
  }
  // The noise of the noisiest camera pair, once it is known.
  double noise_px = 0.0;
  for (const CameraPairFit& fit : estimate_.refine.camera_pairs) {
    noise_px = std::max(noise_px, fit.noise_px);
  }
  const double threshold_px = noise_px > 0 ? kThresholdSigmas * noise_px : ransac_.threshold_px;
  const Doubt doubt =
      FindDoubt(pair_.prior, *search_.solver, MotionOfPoint(estimate_.pose, centre_), matches_,
                threshold_px, noise_px);
  estimate_.doubtful = doubt.Any();
  estimate_.doubt = doubt.Reason();
  if (estimate_.status == EstimateStatus::kSuccess && options_.refine_motion &&
      options_.check_rig && estimate_.stopped == StopReason::kNone) {
    CheckRig(doubt);
  }
}

// One clause if many pixels have no ray; else empty.
std::string Estimator::WhyRaysAreMissing() const {
  constexpr double kMany = 0.1;  // the black corners of fisheyes have fewer
  const int without = matches_.num_given() - matches_.size();
  if (!(without > kMany * matches_.num_given())) return "";
  return std::to_string(without) + " of " + std::to_string(matches_.num_given()) +
         " matches have a pixel without a ray; are the parameters of the cameras right?";
}

void Estimator::CheckRig(const Doubt& doubt) {
  EstimateOptions again = options_;
  again.time_limit = stop_.SecondsLeft();
  again.check_rig = false;
  again.ransac.max_iterations = std::min(options_.ransac.max_iterations, kMaxSwapIterations);
  const auto inliers_with = [&again](const FramePair& other) {
    const MotionEstimate e = EstimateMotion(again, other);
    return e.status == EstimateStatus::kSuccess ? e.num_inliers : 0;
  };
  const bool prior_is_doubted = doubt.SaysWrong() && search_.solver->prior != PriorKind::kNone;
  estimate_.rig_doubts = FindRigDoubts(pair_, !options_.refine.hold_distance, prior_is_doubted,
                                       estimate_.refine, inliers_with);
  const std::string without_rays = WhyRaysAreMissing();
  if (!without_rays.empty()) {
    estimate_.rig_doubts.push_back({RigDoubtKind::kNoRays, 0, 0, without_rays});
  }
}

}  // namespace

MotionEstimate EstimateMotion(const EstimateOptions& options, const FramePair& pair) {
  return Estimator(options, pair).Run();
}

}  // namespace rigel
