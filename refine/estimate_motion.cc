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

MotionEstimate Refused(EstimateStatus status, const std::string& message) {
  MotionEstimate estimate;
  estimate.status = status;
  estimate.message = message;
  return estimate;
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

MotionEstimate EstimateMotion(const EstimateOptions& options, const FramePair& pair) {
  Stop stop(options.time_limit, options.cancel);
  std::string error;
  if (!options.IsValid(&error) || !pair.IsValid(&error)) {
    return Refused(EstimateStatus::kInvalidInput, error);
  }
  RansacOptions ransac_options = options.ransac;
  ransac_options.threshold_px = ThresholdPx(options.ransac.threshold_px, pair.rig);
  const double distance = pair.prior.distance.value_or(0.0);
  if (options.refine_motion && options.refine.scale == ScaleMode::kFixed &&
      !(distance > 0 && std::isfinite(distance))) {
    return Refused(EstimateStatus::kInvalidInput,
                   "|t| is to be held, and the prior states no positive distance");
  }
  const bool choose = options.solver == kAutoSolver;
  const bool exact_prior =
      options.refine_motion && (options.refine.form == RefineForm::kPrior ||
                                options.refine.form == RefineForm::kPriorDepths);
  std::vector<const SolverInfo*> solvers = {FindSolver(options.solver)};
  if (choose) {
    solvers = SuggestSolvers(pair.prior);
    if (exact_prior) solvers.resize(1);
    if (exact_prior && solvers[0]->prior == PriorKind::kNone) {
      return Refused(EstimateStatus::kInvalidInput,
                     std::string("auto: there is no prior for the refinement '") +
                         RefineFormName(options.refine.form) + "' to hold");
    }
  }
  const MotionPrior prior = WithForward(pair);
  for (const SolverInfo* solver : solvers) {
    Alignment alignment;
    if (!MakeAlignment(prior, solver->prior, &alignment, &error)) {
      return Refused(EstimateStatus::kInvalidInput, options.solver + ": " + error);
    }
  }

  const auto ransac_start = std::chrono::steady_clock::now();
  // The search is for the motion of the rig's centre; the body's motion is computed from it at the
  // end. The Ackermann model describes the motion of the body's origin.
  const bool ackermann = solvers[0]->solve == &Solve2ptAckermann;
  const Eigen::Vector3d centre =
      ackermann ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : RigCentre(pair.rig);
  const GroupedMatches matches(WithOrigin(pair.rig, centre), pair.matches);
  MotionSearch search = SearchMotion(solvers, prior, matches, ransac_options, &stop);
  // RANSAC counted the inliers among the matches that it scored; this counts them among all.
  if (search.best.found && matches.size() > ransac_options.max_scored) {
    matches.ScoreInFront(search.best.best, ransac_options.threshold_px,
                         std::numeric_limits<double>::infinity(), &search.best.num_inliers);
  }
  MotionEstimate estimate;
  estimate.iterations = search.iterations;
  estimate.hypotheses = search.hypotheses;
  estimate.trials = std::move(search.trials);
  estimate.ransac_ms = MillisecondsSince(ransac_start);
  estimate.stopped = stop.reason();
  if (search.solver == nullptr) {
    estimate.status = matches.size() < solvers[0]->sample_size ? EstimateStatus::kTooFewMatches
                                                               : EstimateStatus::kNoSolution;
    estimate.message = estimate.trials[0].note;
    return estimate;
  }
  estimate.solver = search.solver->name;
  const RansacResult<Solution>& ransac = search.best;
  if (!ransac.found) {
    estimate.status = EstimateStatus::kNoSolution;
    estimate.message = estimate.stopped != StopReason::kNone
                           ? stop.Message() + " before a motion was found"
                           : "no sample of the matches determines a motion";
    return estimate;
  }
  estimate.raw = ransac.best_minimal;
  estimate.raw.t = MotionOfBody(ransac.best_minimal, centre).t;
  estimate.pose = MotionOfBody(ransac.best, centre);
  estimate.num_inliers = ransac.num_inliers;
  estimate.status = EstimateStatus::kSuccess;
  estimate.message = estimate.stopped != StopReason::kNone ? stop.Message() : "ok";
  if (options.refine_motion) {
    const auto refine_start = std::chrono::steady_clock::now();
    RefineOptions refine(options.refine);
    refine.prior_kind = search.solver->prior;
    refine.threshold_px = ransac_options.threshold_px;
    refine.num_tries = static_cast<double>(search.hypotheses);
    const std::optional<double> left = stop.SecondsLeft();
    if (left) refine.time_limit = std::min(*left, refine.time_limit.value_or(*left));
    if (refine.cancel == nullptr) refine.cancel = options.cancel;
    estimate.refine = RefineAbout(refine, matches, centre, pair.prior, &estimate.pose);
    estimate.refine_ms = MillisecondsSince(refine_start);
    if (estimate.refine.IsSolutionUsable()) {
      estimate.num_inliers = estimate.refine.num_inliers;
      if (estimate.refine.stopped != StopReason::kNone) {
        estimate.stopped = estimate.refine.stopped;
        // Refine() was given only the rest of the limit; the message names the whole.
        if (stop.Asked()) estimate.refine.message = stop.Message();
        estimate.message = estimate.refine.message;
      }
    } else {
      estimate.status = EstimateStatus::kNotRefined;
      estimate.message = "not refined: " + estimate.refine.message;
    }
  }
  estimate.inlier_ratio = estimate.num_inliers / static_cast<double>(matches.size());
  const Pose about_centre = MotionOfPoint(estimate.pose, centre);
  const bool exceeds_chance =
      estimate.refine.IsSolutionUsable()
          ? estimate.refine.exceeds_chance
          : ExceedsChance(matches, about_centre, estimate.num_inliers, ransac_options.threshold_px,
                          static_cast<double>(search.hypotheses));
  if (!exceeds_chance) {
    estimate.status = EstimateStatus::kNoConsensus;
    estimate.message = std::to_string(estimate.num_inliers) + " of " +
                       std::to_string(matches.size()) +
                       " matches agree on a motion, no more than chance allows";
    if (options.solver != kAutoSolver && search.solver->prior != PriorKind::kNone) {
      estimate.message += "; is the prior right?";
    }
    if (estimate.stopped != StopReason::kNone) estimate.message += "; " + stop.Message();
    return estimate;
  }
  const Doubt doubt =
      FindDoubt(pair.prior, *search.solver, about_centre, matches, ransac_options.threshold_px);
  estimate.doubtful = doubt.Any();
  estimate.doubt = doubt.Reason();
  if (estimate.status == EstimateStatus::kSuccess && options.refine_motion && options.check_rig &&
      estimate.stopped == StopReason::kNone) {
    EstimateOptions again = options;
    again.time_limit = stop.SecondsLeft();
    again.check_rig = false;
    again.ransac.max_iterations = std::min(options.ransac.max_iterations, kMaxSwapIterations);
    const auto inliers_with = [&again](const FramePair& other) {
      const MotionEstimate e = EstimateMotion(again, other);
      return e.status == EstimateStatus::kSuccess ? e.num_inliers : 0;
    };
    const bool prior_is_doubted = estimate.doubtful && search.solver->prior != PriorKind::kNone;
    estimate.rig_doubts =
        FindRigDoubts(pair, options.refine.scale, prior_is_doubted, estimate.refine, inliers_with);
  }
  return estimate;
}

}  // namespace rigel
