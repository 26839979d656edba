#include "rigel/refine/refine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/metrics.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/core/rig_centre.h"
#include "rigel/refine/fit.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/observability.h"
#include "rigel/refine/search/chance.h"
#include "rigel/refine/search/length_vote.h"
#include "rigel/refine/search/plane_twin.h"
#include "rigel/refine/search/shared_pixels.h"
#include "rigel/refine/search/sign_and_scale.h"
#include "rigel/refine/standing.h"

namespace rigel {
namespace {

// One refinement. Its poses are motions of `point` (body frame), which is the origin of the rig of
// `matches`. The summary is of the body.
class Refiner {
 public:
  Refiner(const RefineOptions& options, bool gate_follows_noise, const GroupedMatches& matches,
          const Eigen::Vector3d& point, const MotionPrior& prior, const std::vector<Pose>& others)
      : options_(options),
        matches_(matches),
        point_(point),
        prior_(prior),
        others_(others),
        sign_subset_(matches.EvenSubset(kSignSubset)),
        fitter_(options, gate_follows_noise, matches, point, prior) {}

  // The stages of a refinement, in order. Each goes on from the fit of the one before.
  RefineSummary Run(Pose* pose) {
    if (!Check(*pose)) return summary_;
    fit_.pose = *pose;
    summary_.num_rounds = 0;
    summary_.num_iterations = 0;
    Start();
    const bool done = FitUntilSelectionStays(false) && TryOtherLengths() && TryOthers() &&
                      FitUntilSelectionStays(true);
    Describe(done);
    if (summary_.IsSolutionUsable()) *pose = fit_.pose;
    return summary_;
  }

 private:
  bool Check(const Pose& start);
  void Start();
  void GiveDirection();
  bool FitUntilSelectionStays(bool exclude_implausible);
  bool LengthIsOpen() const;
  double CostOf(const Pose& pose, double threshold_px, double sigma_px) const;
  double VotedLength() const;
  bool TryOtherLengths();
  double DifferenceOfNoise(const Pose& a, const Pose& b, double threshold_px) const;
  bool TryOthers();
  void TryStart(const Pose& start);
  bool ExceedsChanceAt(double threshold_px) const;
  std::optional<StandingMotion> FindStanding() const;
  void Describe(bool done);
  void CountCameraPairs();
  bool GoesOn() { return !fitter_.stop()->Asked(); }
  // For scores and signs: that of the noisiest camera pair.
  double Threshold() const {
    const auto largest = std::max_element(fit_.noise.sigma_of.begin(), fit_.noise.sigma_of.end());
    return kThresholdSigmas * *largest;
  }

  const RefineOptions& options_;
  const GroupedMatches& matches_;
  const Eigen::Vector3d point_;
  const MotionPrior& prior_;
  const std::vector<Pose>& others_;  // motions of the body
  const GroupedMatches sign_subset_;
  Fitter fitter_;
  Fit fit_;
  std::optional<Pose> other_;  // of the point, a minimum that fits as well
  RefineSummary summary_;
};

bool Refiner::Check(const Pose& start) {
  const auto fail = [this](const std::string& message) {
    summary_.termination = Termination::kFailure;
    summary_.message = message;
    return false;
  };
  std::string error;
  if (!options_.IsValid(&error) || !fitter_.Prepare(&error) || !prior_.IsValid(&error)) {
    return fail(error);
  }
  if (!start.AllFinite()) return fail("the start is not finite");
  constexpr double kMaxRotationDefect = 1e-6;
  if (!((start.R.transpose() * start.R - Eigen::Matrix3d::Identity()).norm() <
        kMaxRotationDefect) ||
      !(start.R.determinant() > 0)) {
    return fail("the start's R is not a rotation");
  }
  if (matches_.HasTimes() && options_.form == RefineForm::kBundle) {
    return fail("the form 'bundle' does not know of cameras that fire at other times");
  }
  if (matches_.size() == 0) {
    summary_.termination = Termination::kDegenerate;
    summary_.message = "0 inliers";
    return false;
  }
  return true;
}

// Direction, sign and length of the start.
void Refiner::Start() {
  constexpr double kNothing = 1e-9;  // metres: t of the body, up to rounding
  if (MotionOfBody(fit_.pose, point_).t.norm() < kNothing) GiveDirection();
  ResolveSign(sign_subset_, options_.threshold_px, &fit_.pose);
  // Before the fit: matches that hardly determine |t| would not move it far enough. With a distance
  // of zero there is no direction to refine, so the start's |t| is kept.
  if (prior_.distance.value_or(0.0) > 0) {
    const Eigen::Vector3d center = RigCentre(matches_.rig());
    const Pose body =
        WithBodyLength(MotionOfBody(fit_.pose, point_), center + point_, *prior_.distance);
    fit_.pose = MotionOfPoint(body, point_);
  }
}

// A start without translation has no direction: the best fit from six.
void Refiner::GiveDirection() {
  constexpr double kLoose = 20.0;  // thresholds: the start fits only roughly
  const GroupedMatches& matches = sign_subset_;
  const std::vector<char> all(matches.size(), 1);
  SmallEngine engine(matches);
  LeastSquaresOptions options;
  options.loss = LossKind::kCauchy;
  options.loss_scale = kLoose * options_.threshold_px;
  options.max_num_iterations = 20;
  double best = std::numeric_limits<double>::infinity();
  Pose found = fit_.pose;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      Pose candidate = fit_.pose;
      candidate.t = sign * options_.typical_length * Eigen::Vector3d::Unit(axis);
      engine.Minimize(options, all, fitter_.PriorAt(candidate), options_.threshold_px, &candidate);
      const double score = matches.ScoreInFront(candidate, options_.threshold_px, best, nullptr);
      if (score < best) {
        best = score;
        found = candidate;
      }
    }
  }
  fit_.pose = found;
}

// Selection of inliers and least squares in turn until the selection stays.
bool Refiner::FitUntilSelectionStays(bool exclude_implausible) {
  fitter_.Select(exclude_implausible, &fit_);
  for (int round = 0; round < options_.max_rounds; ++round) {
    if (!fitter_.FitOnce(exclude_implausible, &fit_, &summary_)) return false;
    if (!GoesOn()) break;
    // Depths can run through zero to the other sign of t, behind the cameras.
    if (fitter_.HasReference()) ResolveSign(sign_subset_, Threshold(), &fit_.pose);
    if (round + 1 == options_.max_rounds) {
      // The motion stays the minimum over its inliers.
      fit_.errors.Set(matches_, fit_.pose, options_.threshold_px);
      break;
    }
    const bool changed = fitter_.Select(exclude_implausible, &fit_);
    if (!changed && !fitter_.ReferenceIsStale(fit_)) break;
  }
  return true;
}

// True if the matches do not determine the length. At the false minima of intra-camera matches it
// seems well determined, so the kind of the matches decides, not only the information.
bool Refiner::LengthIsOpen() const {
  if (options_.hold_distance) return false;
  const bool all_intra =
      std::all_of(matches_.groups().begin(), matches_.groups().end(),
                  [](const MatchGroup& group) { return group.camera1 == group.camera2; });
  return all_intra ||
         RelativeScaleSigma(fitter_.MatchInformation(fit_), fit_.pose) > kScaleObservableRatio;
}

// Of all matches and of the prior, pixels^2.
double Refiner::CostOf(const Pose& pose, double threshold_px, double sigma_px) const {
  PriorResiduals::Residuals r;
  fitter_.PriorAt(pose).Evaluate(pose, &r, nullptr);
  constexpr double kNoBound = std::numeric_limits<double>::infinity();
  return matches_.ScoreInFront(pose, threshold_px, kNoBound, nullptr) +
         sigma_px * sigma_px * r.squaredNorm();
}

// The length with the best score, of that of the fit and those that the matches vote for. It is
// looked at with a threshold that forgives what the fit bent for a wrong length.
double Refiner::VotedLength() const {
  constexpr double kLoose = 3.0;    // thresholds
  constexpr double kReached = 0.1;  // of the logarithm: the fit has been as far as that
  const double length = fit_.pose.t.norm();
  const std::vector<double> votes = VoteOnLength(matches_, fit_.pose, fit_.noise.sigma_px);
  if (votes.empty()) return length;
  const auto score = [&](double of_length, double bound) {
    Pose pose = fit_.pose;
    pose.t *= of_length / length;
    return matches_.ScoreInFront(pose, kLoose * Threshold(), bound, nullptr);
  };
  double best = length;
  double least = score(length, std::numeric_limits<double>::infinity());
  for (const double voted : votes) {
    if (std::abs(std::log(voted / length)) < kReached) continue;
    const double score_of_voted = score(voted, least);
    if (!(score_of_voted < least)) continue;
    least = score_of_voted;
    best = voted;
  }
  return best;
}

// The length of the start is that of a few matches, and where the matches leave it open a guess.
// From a wrong one the fit can end at a false minimum, with |b| as small as the arms of the
// cameras.
bool Refiner::TryOtherLengths() {
  constexpr double kNear = 1.0;  // of the logarithm: a standard deviation of the weak prior
  if (!GoesOn() || options_.hold_distance) return true;
  const double voted = VotedLength();
  const auto try_length = [this](double length) {
    TryStart({fit_.pose.R, length / fit_.pose.t.norm() * fit_.pose.t});
  };
  if (voted != fit_.pose.t.norm()) try_length(voted);
  if (!GoesOn() || !LengthIsOpen()) return true;
  const double typical =
      prior_.distance.value_or(0.0) > 0 ? *prior_.distance : options_.typical_length;
  if (std::abs(std::log(typical / fit_.pose.t.norm())) > kNear) try_length(typical);
  return true;
}

// The largest difference of the costs of two motions that noise makes if both are right: they see
// the noise of each match from other sides (Vuong, Likelihood ratio tests for model selection and
// non-nested hypotheses, 1989).
double Refiner::DifferenceOfNoise(const Pose& a, const Pose& b, double threshold_px) const {
  constexpr double kSigmas = 3.0;
  const double t2 = threshold_px * threshold_px;
  std::vector<double> errors[2];
  std::vector<char> inliers[2];
  matches_.SelectInliers(a, threshold_px, &errors[0], &inliers[0]);
  matches_.SelectInliers(b, threshold_px, &errors[1], &inliers[1]);
  double sum = 0.0, squares = 0.0;
  for (int k = 0; k < matches_.size(); ++k) {
    const double d = (inliers[0][k] ? errors[0][k] : t2) - (inliers[1][k] ? errors[1][k] : t2);
    sum += d;
    squares += d * d;
  }
  return kSigmas * std::sqrt(std::max(0.0, squares - sum * sum / matches_.size()));
}

// True if two fits ended at one minimum.
bool IsSameMotion(const Pose& a, const Pose& b) {
  constexpr double kTurn = 1e-4;    // radians
  constexpr double kChange = 1e-2;  // of b
  return RotationError(a.R, b.R) < kTurn && (a.t - b.t).norm() < kChange * a.t.norm();
}

// Fits from the other motions that the search found, and from the second motion of a plane. Keeps
// the best. Of two that fit alike the other is told.
bool Refiner::TryOthers() {
  // A start that costs more does not end at a fit that is alike.
  constexpr double kMaxStart = 1.5;
  for (const Pose& body : others_) {
    Pose start = MotionOfPoint(body, point_);
    // Of intra-camera matches a length may be anything.
    if (start.t.norm() > fitter_.max_length()) start.t *= fit_.pose.t.norm() / start.t.norm();
    if (CostOf(start, Threshold(), fit_.noise.sigma_px) <
        kMaxStart * CostOf(fit_.pose, Threshold(), fit_.noise.sigma_px)) {
      TryStart(start);
    }
  }
  const std::optional<Pose> twin = PlaneTwin(sign_subset_, fit_.pose, fit_.noise.sigma_px);
  if (twin.has_value()) TryStart(*twin);
  return true;
}

// Fits from another motion, and keeps the better fit. Of two that are as good within noise it keeps
// that with the smaller turn and tells the other.
void Refiner::TryStart(const Pose& start) {
  if (!GoesOn()) return;
  const double threshold = Threshold(), sigma = fit_.noise.sigma_px;  // the same for both
  Fit found = fit_;
  RefineSummary summary = summary_;
  fit_.pose = start;
  if (!FitUntilSelectionStays(false) || IsSameMotion(fit_.pose, found.pose)) {
    std::swap(fit_, found);
    std::swap(summary_, summary);
    return;
  }
  const double difference =
      CostOf(fit_.pose, threshold, sigma) - CostOf(found.pose, threshold, sigma);
  const bool alike = std::abs(difference) < DifferenceOfNoise(fit_.pose, found.pose, threshold);
  const bool better = alike ? fit_.pose.R.trace() > found.pose.R.trace() : difference < 0;
  if (!better) {
    std::swap(fit_, found);
    std::swap(summary_, summary);
  }
  if (alike) {
    other_ = found.pose;
  } else if (better) {
    other_.reset();
  }
}

void Refiner::CountCameraPairs() {
  const std::vector<RigCamera>& cameras = matches_.rig().cameras;
  for (size_t g = 0; g < matches_.groups().size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    CameraPairFit pair;
    pair.camera1 = group.camera1;
    pair.camera2 = group.camera2;
    pair.rows = group.size;
    pair.noise_px = fit_.noise.sigma_of[g];
    for (int k = group.begin; k < group.begin + group.size; ++k) pair.inliers += fit_.inliers[k];
    pair.median_residual_px = SignedMedianResidual(matches_, group, fit_);
    const Eigen::Vector3d b =
        fit_.pose.R * cameras[group.camera1].s + fit_.pose.t - cameras[group.camera2].s;
    const double norm = b.norm();
    if (norm > 0) pair.baseline = {b.x() / norm, b.y() / norm, b.z() / norm};
    summary_.camera_pairs.push_back(pair);
  }
}

// Counts the inliers below the threshold, not those between it and the gate: more outliers fit
// there.
bool Refiner::ExceedsChanceAt(double threshold_px) const {
  std::vector<char> near = fit_.inliers;
  int num_near = 0;
  for (size_t k = 0; k < near.size(); ++k) {
    if (!(fit_.errors.squared[k] < threshold_px * threshold_px)) near[k] = 0;
    num_near += near[k];
  }
  return ExceedsChance(
      matches_, fit_.pose, CountDistinctPixels(num_near, SharedWithin(fitter_.shared(), near)),
      CountDistinctPixels(matches_.size(), fitter_.shared()), threshold_px, options_.num_tries);
}

// The rotation of a rig whose points move by no more than noise, if it is one that stands.
std::optional<StandingMotion> Refiner::FindStanding() const {
  // Of the limit: a wrong turn of the full model makes a parallax of its own.
  constexpr double kNearly = 2.0;
  if (options_.form != RefineForm::kFull || options_.residual != ResidualKind::kSampson ||
      options_.hold_distance || !(summary_.parallax_px <= kNearly * summary_.parallax_limit_px) ||
      !MayStand(prior_) || OnALine(matches_, fit_)) {
    return std::nullopt;
  }
  return FitStanding(matches_, fitter_.shared(), point_, fit_, options_.loss,
                     options_.loss_scale_sigmas, options_.typical_length);
}

void Refiner::Describe(bool done) {
  const bool stopped = done && fitter_.stop()->reason() != StopReason::kNone;
  if (stopped) fitter_.Select(false, &fit_);
  summary_.noise_px = fit_.noise.sigma_px;
  summary_.median_residual_px = MedianResidual(fit_);
  if (!done) return;
  summary_.exceeds_chance = ExceedsChanceAt(Threshold());
  CountCameraPairs();
  if (stopped) {
    summary_.termination = Termination::kStopped;
    summary_.stopped = fitter_.stop()->reason();
  } else {
    SetParallax(options_, matches_, fit_, &summary_);
    if (std::optional<StandingMotion> standing = FindStanding()) {
      DescribeStanding(matches_, point_, *standing, &summary_);
      fit_.pose = standing->pose;
      fit_.inliers.swap(standing->inliers);
      fit_.num_inliers = standing->num_inliers;
    } else {
      if (other_.has_value()) summary_.other_motion = MotionOfBody(*other_, point_);
      DescribeObservability(options_, matches_, point_, fitter_, fit_, &summary_);
    }
  }
  summary_.num_inliers = fit_.num_inliers;
  summary_.inliers.assign(matches_.num_given(), 0);
  for (int k = 0; k < matches_.size(); ++k) {
    summary_.inliers[matches_.original(k)] = fit_.inliers[k];
  }
  summary_.message = stopped ? fitter_.stop()->Message() : TerminationName(summary_.termination);
}

}  // namespace

bool RefineSettings::IsValid(std::string* error) const {
  if (std::string(RefineFormName(form)) == "unknown" ||
      std::string(ResidualName(residual)) == "unknown" ||
      std::string(LossName(loss)) == "unknown") {
    *error = "form, residual or loss is none of its enumeration";
    return false;
  }
  if (!(loss_scale_sigmas > 0) || !std::isfinite(loss_scale_sigmas)) {
    *error = "loss_scale_sigmas must be positive and finite";
    return false;
  }
  if (!(typical_length > 0) || !std::isfinite(typical_length)) {
    *error = "typical_length must be positive and finite";
    return false;
  }
  if (max_rounds < 1 || max_num_iterations < 0) {
    *error = "max_rounds must be at least 1 and max_num_iterations not negative";
    return false;
  }
  if (noise_px.has_value() && !(*noise_px > 0 && std::isfinite(*noise_px))) {
    *error = "noise_px must be positive and finite";
    return false;
  }
  return IsValidTimeLimit(time_limit, error);
}

bool RefineOptions::IsValid(std::string* error) const {
  if (!RefineSettings::IsValid(error)) return false;
  const bool prior_exact = form == RefineForm::kPrior || form == RefineForm::kPriorDepths;
  if (prior_exact && prior_kind == PriorKind::kNone) {
    *error = std::string("the form '") + RefineFormName(form) + "' needs a prior_kind";
    return false;
  }
  if (!(threshold_px >= 0) || !std::isfinite(threshold_px)) {
    *error = "threshold_px must be positive and finite, or 0 for auto";
    return false;
  }
  if (!(num_tries >= 1.0) || !std::isfinite(num_tries)) {
    *error = "num_tries must be at least 1 and finite";
    return false;
  }
  return true;
}

RefineSummary RefineAbout(const RefineOptions& options, const GroupedMatches& matches,
                          const Eigen::Vector3d& origin, const MotionPrior& prior,
                          const std::vector<Pose>& others, Pose* pose) {
  RefineOptions resolved = options;
  const bool gate_follows_noise = options.threshold_px == kAutoThresholdPx;
  resolved.threshold_px = ThresholdPx(options.threshold_px, matches.rig());
  // The rig's centre in the frame of `matches`; the body's origin if |t| of the body is held.
  const Eigen::Vector3d step =
      options.hold_distance ? Eigen::Vector3d(-origin) : RigCentre(matches.rig());
  // For a rig that is already centred, the step is only rounding.
  constexpr double kRounding = 1e-12;
  double size = 0.0;
  for (const RigCamera& camera : matches.rig().cameras) size = std::max(size, camera.s.norm());
  const bool there = step.norm() <= kRounding * (size + origin.norm());
  const Eigen::Vector3d point = there ? origin : Eigen::Vector3d(origin + step);
  Pose result = MotionOfPoint(*pose, point);
  RefineSummary summary =
      there ? Refiner(resolved, gate_follows_noise, matches, point, prior, others).Run(&result)
            : Refiner(resolved, gate_follows_noise, matches.WithOrigin(step), point, prior, others)
                  .Run(&result);
  if (summary.IsSolutionUsable()) *pose = MotionOfBody(result, point);
  return summary;
}

RefineSummary Refine(const RefineOptions& options, const GroupedMatches& matches,
                     const MotionPrior& prior, Pose* pose) {
  return RefineAbout(options, matches, Eigen::Vector3d::Zero(), prior, {}, pose);
}

RefineSummary Refine(const RefineOptions& options, const Rig& rig,
                     const std::vector<Match>& matches, const MotionPrior& prior, Pose* pose) {
  FramePair pair;
  pair.rig = rig;
  pair.matches = matches;
  std::string error;
  if (!pair.IsValid(&error)) {
    RefineSummary summary;
    summary.termination = Termination::kFailure;
    summary.message = error;
    return summary;
  }
  const DistinctSet distinct = KeepDistinct(matches);
  RefineSummary summary = Refine(options, GroupedMatches(rig, distinct.matches), prior, pose);
  if (!summary.inliers.empty()) summary.inliers = distinct.OfAll(summary.inliers);
  return summary;
}

}  // namespace rigel
