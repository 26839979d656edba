#include "rigel/refine/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "rigel/core/alignment.h"
#include "rigel/core/angles.h"
#include "rigel/core/frame_pair.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/median.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/core/rays.h"
#include "rigel/core/rig_centre.h"
#include "rigel/refine/least_squares/ceres_engine.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/least_squares/prior_residuals.h"
#include "rigel/refine/least_squares/small_engine.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/search/chance.h"
#include "rigel/refine/search/group_noise.h"
#include "rigel/refine/search/inlier_selection.h"
#include "rigel/refine/search/scale_search.h"
#include "rigel/refine/search/sign_and_scale.h"

namespace rigel {
namespace {

bool WeighsDistance(const RefineOptions& options, const MotionPrior& prior) {
  return options.use_prior && prior.distance.has_value() && prior.distance_sigma > 0;
}

// True if |t| of the body enters the fit. The fit is then of the body's motion.
bool UsesBodyLength(const RefineOptions& options, const MotionPrior& prior) {
  return options.scale == ScaleMode::kFixed || WeighsDistance(options, prior);
}

// One refinement. Its poses are motions of `point` (body frame), which is the origin of the rig of
// `matches`. The summary is of the body.
class Refiner {
 public:
  Refiner(const RefineOptions& options, const GroupedMatches& matches, const Eigen::Vector3d& point,
          const MotionPrior& prior)
      : options_(options),
        matches_(matches),
        point_(point),
        prior_(prior),
        pixel_unit_(PixelUnit(matches.rig())),
        sign_subset_(matches.EvenSubset(kSignSubset)),
        engine_(matches),
        stop_(options.time_limit, options.cancel),
        progress_([this](int iteration, double cost) {
          options_.progress({summary_.num_rounds + 1, iteration, cost});
        }) {}

  RefineSummary Run(Pose* pose);

 private:
  bool PriorIsExact() const {
    return options_.form == RefineForm::kPrior || options_.form == RefineForm::kPriorDepths;
  }
  bool SelectInliers(const Pose& pose);
  double MedianResidual() const;
  void SetNoise();
  double EstimateNoise();
  void FactorsNearEpipoles(const Pose& pose, std::vector<double>* factors) const;
  bool SetWeights(const Pose& pose);
  bool DescribeFit(const Pose& pose, InlierFit* fit) const;
  bool ReferenceIsStale(const Pose& pose) const;
  Matrix6d WithPrior(Matrix6d information, const Pose& pose) const;
  Matrix6d Information(const Pose& pose) const;
  double ScaleSigma(const Pose& pose) const;
  bool ScaleIsFree(const Pose& pose) const;
  bool SearchesScale(const Pose& pose) const;
  void ChooseForms(const Pose& pose, bool scale_free, RotationForm* rotation,
                   TranslationForm* translation) const;
  void TakeDistance(Pose* pose) const;
  bool HasReference() const {
    return options_.form == RefineForm::kDepths || options_.form == RefineForm::kPriorDepths;
  }
  int ChooseReference(const Pose& pose, RotationForm rotation, TranslationForm translation) const;
  bool Solve(bool scale_free, Pose* pose);
  bool Iterate(Pose* pose);
  void FillUncertainty(const Pose& pose);
  void CountCameraPairs(const Pose& pose);
  bool Fail(Termination termination, const std::string& message);

  const RefineOptions& options_;
  const GroupedMatches& matches_;
  const Eigen::Vector3d point_;
  const MotionPrior& prior_;
  const double pixel_unit_;
  const GroupedMatches sign_subset_;
  SmallEngine engine_;
  Stop stop_;
  const std::function<void(int, double)> progress_;  // options_.progress of the round
  Alignment alignment_;
  std::vector<double> squared_errors_;
  std::vector<char> mask_, previous_mask_;  // grouped order
  std::vector<double> noise_weights_;       // by the noise of the camera pair
  std::vector<double> match_weights_;       // the same; 0: no inlier
  std::vector<double> weights_;             // see SetWeights()
  int num_inliers_ = 0;
  std::optional<Pose> selected_at_;  // the pose of the last selection
  bool excludes_chance_ = false;     // inlier_selection.h; at a minimum only
  double noise_px_ = 1.0;
  bool scale_free_ = true;
  struct ScaleQuestion {
    Pose pose;
    std::vector<double> weights;
    double noise_px = -1.0;
    double sigma = 0.0;
  };
  mutable ScaleQuestion last_scale_;  // see ScaleSigma()
  int reference_match_ = -1;          // of the depth forms, grouped order
  RefineSummary summary_;
};

bool Refiner::Fail(Termination termination, const std::string& message) {
  summary_.termination = termination;
  summary_.message = message;
  return false;
}

// True if the selection changed. It is called more than once for the same motion.
bool Refiner::SelectInliers(const Pose& pose) {
  if (selected_at_ && selected_at_->R == pose.R && selected_at_->t == pose.t) return false;
  selected_at_ = pose;
  previous_mask_ = mask_;
  const double gate =
      std::max(options_.threshold_px, kGateSigmas * options_.noise_px.value_or(0.0));
  num_inliers_ = excludes_chance_ ? SelectPlausibleInliers(
                                        matches_, pose, gate,
                                        [&](InlierFit* fit) { return DescribeFit(pose, fit); },
                                        &squared_errors_, &mask_)
                                  : matches_.SelectInliers(pose, gate, &squared_errors_, &mask_);
  return mask_ != previous_mask_;
}

double Refiner::MedianResidual() const {
  // One entry more, so that the loop can write each match and overwrite those that are no inliers.
  std::vector<double> errors(num_inliers_ + 1);
  size_t n = 0;
  for (size_t k = 0; k < mask_.size(); ++k) {
    errors[n] = squared_errors_[k];
    n += mask_[k] != 0 ? 1 : 0;
  }
  errors.resize(n);
  return errors.empty() ? -1.0 : std::sqrt(MedianInPlace(&errors));
}

// Sets the noise level and the weights of the camera pairs. A given noise level holds for all
// pairs.
void Refiner::SetNoise() {
  noise_weights_.assign(mask_.size(), 1.0);
  // The floor keeps noise-free problems regular.
  noise_px_ = std::max(options_.noise_px.has_value() ? *options_.noise_px : EstimateNoise(),
                       1e-9 * pixel_unit_);
  match_weights_.resize(mask_.size());
  for (size_t k = 0; k < mask_.size(); ++k) match_weights_[k] = mask_[k] * noise_weights_[k];
  summary_.noise_px = noise_px_;
}

// Sets the weights of the matches by the noise of their camera pairs. Returns the noise of all.
double Refiner::EstimateNoise() {
  const double median = MedianResidual();
  // With as many matches as parameters the residuals are zero for any noise. With little redundancy
  // the threshold, which is meant to be three sigma, is the better estimate.
  constexpr int kParameters = 6;
  constexpr int kMinRedundancy = 10;
  const int redundancy = num_inliers_ - kParameters;
  const std::vector<double> by_group = GroupNoiseWeights(matches_, squared_errors_, mask_, median);
  for (size_t g = 0; g < by_group.size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    for (int k = group.begin; k < group.begin + group.size; ++k) noise_weights_[k] = by_group[g];
  }
  const double noise = 1.4826 * median;
  if (redundancy < kMinRedundancy) return std::max(noise, options_.threshold_px / 3.0);
  return noise * std::sqrt(num_inliers_ / static_cast<double>(redundancy));
}

Matrix6d Refiner::Information(const Pose& pose) const {
  return WithPrior(SampsonInformation(matches_, match_weights_, pose) / (noise_px_ * noise_px_),
                   pose);
}

Matrix6d Refiner::WithPrior(Matrix6d information, const Pose& pose) const {
  if (options_.use_prior) {
    const PriorResiduals prior(prior_, options_.prior_kind, pose);
    PriorResiduals::Residuals r;
    PriorResiduals::Jacobian J;
    prior.Evaluate(pose, &r, &J);
    information += J.transpose() * J;
  }
  return information;
}

// Keeps the last result, since it is called more than once for the same motion and selection.
double Refiner::ScaleSigma(const Pose& pose) const {
  ScaleQuestion& last = last_scale_;
  if (pose.R != last.pose.R || pose.t != last.pose.t || noise_px_ != last.noise_px ||
      match_weights_ != last.weights) {
    last = {pose, match_weights_, noise_px_, RelativeScaleSigma(Information(pose), pose)};
  }
  return last.sigma;
}

bool Refiner::ScaleIsFree(const Pose& pose) const {
  switch (options_.scale) {
    case ScaleMode::kFree:
      return true;
    case ScaleMode::kFixed:
      return false;
    case ScaleMode::kAuto:
      break;
  }
  return ScaleSigma(pose) <= kScaleObservableRatio;
}

// At the false minima of intra-camera matches the scale seems well determined. So the kind of the
// matches decides, and not the information there.
bool Refiner::SearchesScale(const Pose& pose) const {
  if (options_.scale != ScaleMode::kAuto || WeighsDistance(options_, prior_)) return false;
  const bool all_intra =
      std::all_of(matches_.groups().begin(), matches_.groups().end(),
                  [](const MatchGroup& group) { return group.camera1 == group.camera2; });
  return all_intra || !ScaleIsFree(pose);
}

void Refiner::ChooseForms(const Pose& pose, bool scale_free, RotationForm* rotation,
                          TranslationForm* translation) const {
  const bool prior_exact = PriorIsExact();
  const bool planar = prior_exact && options_.prior_kind == PriorKind::kPlanar;
  *rotation = prior_exact ? RotationForm::kAngle : RotationForm::kFree;
  // At t = 0 there is no length to hold.
  const bool free = scale_free || !(pose.t.norm() > 0);
  if (HasReference()) {
    const bool on_sphere = options_.scale == ScaleMode::kFixed;
    if (free) {
      *translation = planar ? TranslationForm::kPlanarDepths : TranslationForm::kDepths;
    } else if (planar) {
      *translation =
          on_sphere ? TranslationForm::kPlanarDepthsOnSphere : TranslationForm::kPlanarDepth;
    } else {
      *translation = on_sphere ? TranslationForm::kDepthsOnSphere : TranslationForm::kDepth;
    }
  } else {
    *translation = planar ? (free ? TranslationForm::kPlane : TranslationForm::kCircle)
                          : (free ? TranslationForm::kFree : TranslationForm::kSphere);
  }
}

// Sets |t| of the body to the prior's distance. With a distance of zero there is no direction to
// refine, so the start's |t| is kept. The direction of the rig's own motion stays, since the
// matches determine it for any |t| of the start.
void Refiner::TakeDistance(Pose* pose) const {
  if (!(prior_.distance.value_or(0.0) > 0)) return;
  *pose = WithBodyLength(*pose, RigCentre(matches_.rig()), *prior_.distance);
}

// The reference match of the depth forms, -1 if there is none. Its rays are taken as exact, so it
// should have much parallax and little noise. Candidates are the inliers of largest parallax among
// those with an error below the median. The one whose exact rays give the best score is taken.
int Refiner::ChooseReference(const Pose& pose, RotationForm rotation,
                             TranslationForm translation) const {
  constexpr size_t kMaxCandidates = 16;
  constexpr double kMinParallax = 1e-6;
  const double limit = std::max(MedianResidual(), 1e-9 * pixel_unit_);
  std::vector<std::pair<double, int>> candidates;  // parallax, match
  for (int k = 0; k < matches_.size(); ++k) {
    if (!mask_[k] || squared_errors_[k] > limit * limit) continue;
    const RayPair& rays = matches_.rays(k);
    const double parallax = (pose.R * rays.ray1.x).cross(rays.ray2.x).norm();
    if (parallax > kMinParallax) candidates.emplace_back(parallax, k);
  }
  const size_t count = std::min(candidates.size(), kMaxCandidates);
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<long>(count),
                    candidates.end(), std::greater<>());
  double best = std::numeric_limits<double>::infinity();
  const std::array<double, 6> start = {0, 0, 0, 0, 0, 0};
  int found = -1;
  for (size_t i = 0; i < count; ++i) {
    const RayPair& rays = matches_.rays(candidates[i].second);
    MotionParameterization parameterization;
    if (!parameterization.Set(rotation, translation, pose, alignment_, rays)) continue;
    Pose projected;
    parameterization.Evaluate(start.data(), &projected, nullptr);
    const double score = matches_.Score(projected, options_.threshold_px, best, nullptr);
    if (score < best) {
      best = score;
      found = candidates[i].second;
    }
  }
  return found;
}

bool Refiner::Solve(bool scale_free, Pose* pose) {
  RotationForm rotation;
  TranslationForm translation;
  ChooseForms(*pose, scale_free, &rotation, &translation);
  RayPair reference;
  const bool depths = HasReference();
  reference_match_ = depths ? ChooseReference(*pose, rotation, translation) : -1;
  if (depths && reference_match_ < 0) {
    return Fail(Termination::kDegenerate, "no match has the parallax that a reference needs");
  }
  if (depths) reference = matches_.rays(reference_match_);
  MotionParameterization parameterization;
  if (!parameterization.Set(rotation, translation, *pose, alignment_, reference)) {
    return Fail(Termination::kDegenerate, "the start has no place in the parameterization");
  }
  const int size = parameterization.size();
  // The reference of the depth forms is exact: it adds no equation.
  if (num_inliers_ - (depths ? 1 : 0) < size) {
    return Fail(Termination::kDegenerate, std::to_string(num_inliers_) + " inliers for " +
                                              std::to_string(size) + " free parameters");
  }

  const PriorResiduals prior =
      options_.use_prior ? PriorResiduals(prior_, options_.prior_kind, *pose) : PriorResiduals();
  const bool small = options_.engine == RefineEngine::kAuto &&
                     options_.residual == ResidualKind::kSampson &&
                     options_.form != RefineForm::kBundle;
  std::array<double, 6> parameters = {0, 0, 0, 0, 0, 0};
  LeastSquaresOptions engine_options;
  engine_options.loss = options_.loss;
  engine_options.loss_scale = options_.loss_scale_sigmas * noise_px_;
  engine_options.max_num_iterations = options_.max_num_iterations;
  engine_options.stop = &stop_;
  engine_options.progress = options_.progress ? &progress_ : nullptr;
  // The last step is some 1e-5 standard deviations long.
  engine_options.tolerance = 1e-12;
  engine_options.residual = options_.residual;
  engine_options.bundle = options_.form == RefineForm::kBundle;
  const LeastSquaresSummary result =
      small ? engine_.Solve(engine_options, parameterization, weights_, prior, noise_px_,
                            parameters.data())
            : SolveWithCeres(engine_options, matches_, parameterization, weights_, prior, noise_px_,
                             *pose, parameters.data());
  Pose refined;
  parameterization.Evaluate(parameters.data(), &refined, nullptr);
  if (!result.usable || !refined.AllFinite() || !std::isfinite(result.final_cost)) {
    return Fail(Termination::kDegenerate, "the least-squares solver found no usable solution");
  }
  if (summary_.initial_cost < 0) summary_.initial_cost = result.initial_cost;
  summary_.final_cost = result.final_cost;
  summary_.num_iterations += result.num_iterations;
  summary_.termination = result.converged ? Termination::kConverged : Termination::kIterationLimit;
  *pose = refined;
  return true;
}

// EpipoleWeights, or 1 where they are not asked for.
void Refiner::FactorsNearEpipoles(const Pose& pose, std::vector<double>* factors) const {
  const bool algebraic =
      options_.residual == ResidualKind::kAlgebraic && options_.form != RefineForm::kBundle;
  if (!options_.epipole_weights || algebraic) {
    factors->assign(mask_.size(), 1.0);
  } else {
    EpipoleWeights(matches_, pose, noise_px_, factors);
  }
}

// Sets the weights of the inliers: these factors times the weights by the noise of the camera
// pairs. They are fixed for a round. As a function of the motion they would pull the epipoles to
// the matches. True if a weight changed by more than a tenth.
bool Refiner::SetWeights(const Pose& pose) {
  const std::vector<double> previous = weights_;
  FactorsNearEpipoles(pose, &weights_);
  for (size_t k = 0; k < weights_.size(); ++k) weights_[k] *= match_weights_[k];
  bool changed = previous.size() != weights_.size();
  for (size_t k = 0; k < weights_.size() && !changed; ++k) {
    changed = mask_[k] && std::abs(weights_[k] - previous[k]) > 0.1;
  }
  return changed;
}

// The fit that led to `pose`.
bool Refiner::DescribeFit(const Pose& pose, InlierFit* fit) const {
  const MotionBasis basis =
      PriorIsExact() ? PriorBasis(pose, alignment_, scale_free_) : FullBasis(pose, scale_free_);
  const Matrix6d information =
      WithPrior(SampsonInformation(matches_, weights_, pose) / (noise_px_ * noise_px_), pose);
  if (!CovarianceOfBasis(information, basis, &fit->covariance)) return false;
  fit->noise_px = noise_px_;
  FactorsNearEpipoles(pose, &fit->weights);
  fit->members.resize(weights_.size());
  for (size_t k = 0; k < weights_.size(); ++k) {
    fit->members[k] = weights_[k] > 0.0;
    fit->weights[k] *= noise_weights_[k];
  }
  return true;
}

// True if another reference would be chosen at `pose`. A reference that was chosen at a poor start
// is a poor one: its rays, taken as exact, hold the motion there.
bool Refiner::ReferenceIsStale(const Pose& pose) const {
  if (!HasReference()) return false;
  RotationForm rotation;
  TranslationForm translation;
  ChooseForms(pose, scale_free_, &rotation, &translation);
  return ChooseReference(pose, rotation, translation) != reference_match_;
}

// Selection of inliers and least squares in turn until the selection stays.
bool Refiner::Iterate(Pose* pose) {
  SelectInliers(*pose);
  SetNoise();
  SetWeights(*pose);
  for (int round = 0; round < options_.max_rounds; ++round) {
    scale_free_ = ScaleIsFree(*pose);
    if (!Solve(scale_free_, pose)) return false;
    ++summary_.num_rounds;
    if (stop_.Asked()) break;
    const bool reselected = SelectInliers(*pose);
    SetNoise();
    const bool reweighted = SetWeights(*pose);
    if (!reselected && !reweighted && !ReferenceIsStale(*pose)) break;
  }
  return true;
}

void Refiner::FillUncertainty(const Pose& pose) {
  const Matrix6d information =
      options_.epipole_weights
          ? WithPrior(ReliableInformation(matches_, match_weights_, pose, noise_px_), pose)
          : Information(pose);
  summary_.scale_free = scale_free_;
  summary_.relative_scale_sigma = ScaleSigma(pose);
  summary_.fitted_point = point_;
  const Pose body = MotionOfBody(pose, point_);
  const Matrix6d to_body = BodyFromPointJacobian(pose.R, point_);
  const auto set_covariance = [&](const MotionBasis& basis) {
    Matrix6d covariance;
    if (!CovarianceOfBasis(information, basis, &covariance)) return;
    summary_.rotation_sigma = RotationSigma(covariance);
    summary_.rig_direction_sigma = DirectionSigma(covariance, pose.t);
    summary_.covariance = Matrix6d(to_body * covariance * to_body.transpose());
    summary_.direction_sigma = DirectionSigma(*summary_.covariance, body.t);
  };
  set_covariance(PriorIsExact() ? PriorBasis(pose, alignment_, scale_free_)
                                : FullBasis(pose, scale_free_));
  summary_.parallax_px = ParallaxPercentilePx(matches_, mask_, pose);
  // A given noise level is trusted. An estimated one may be too small, because of a fit to the
  // noise.
  summary_.parallax_limit_px =
      kParallaxSigmas * (options_.noise_px.has_value()
                             ? noise_px_
                             : std::max(noise_px_, kMinMatchNoisePx * pixel_unit_));
  summary_.rig_translation_observable =
      summary_.covariance.has_value() &&
      RadToDeg(summary_.rig_direction_sigma) <= kDirectionObservableDeg &&
      (std::isfinite(summary_.parallax_px) ? summary_.parallax_px > summary_.parallax_limit_px
                                           : summary_.relative_scale_sigma * kParallaxSigmas < 1.0);
  summary_.translation_observable = summary_.rig_translation_observable &&
                                    RadToDeg(summary_.direction_sigma) <= kDirectionObservableDeg;
  if (!summary_.rig_translation_observable && !PriorIsExact()) {
    set_covariance(FullBasis(pose, true));
  }
  if (summary_.covariance) {
    summary_.weakest_direction = WeakestDirection(*summary_.covariance, body.t);
  }
  summary_.rotation_observable = summary_.covariance.has_value() &&
                                 RadToDeg(summary_.rotation_sigma) <= kRotationObservableDeg;
  if (!summary_.exceeds_chance) {
    summary_.rotation_observable = false;
    summary_.rig_translation_observable = false;
    summary_.translation_observable = false;
  }
  // With kAuto the scale was left free because it is observable, so that decision is used again.
  summary_.scale_observable =
      summary_.translation_observable &&
      (options_.scale == ScaleMode::kAuto ? scale_free_
                                          : summary_.relative_scale_sigma <= kScaleObservableRatio);
}

void Refiner::CountCameraPairs(const Pose& pose) {
  summary_.camera_pairs.clear();
  for (const MatchGroup& group : matches_.groups()) {
    CameraPairFit fit;
    fit.camera1 = group.camera1;
    fit.camera2 = group.camera2;
    fit.rows = group.size;
    for (int k = group.begin; k < group.begin + group.size; ++k) fit.inliers += mask_[k];
    const std::vector<RigCamera>& cameras = matches_.rig().cameras;
    const Eigen::Vector3d b = pose.R * cameras[group.camera1].s + pose.t - cameras[group.camera2].s;
    const double norm = b.norm();
    if (norm > 0) fit.baseline = {b.x() / norm, b.y() / norm, b.z() / norm};
    summary_.camera_pairs.push_back(fit);
  }
}

RefineSummary Refiner::Run(Pose* pose) {
  std::string error;
  if (!options_.IsValid(&error)) {
    Fail(Termination::kFailure, error);
    return summary_;
  }
  if (PriorIsExact() && !MakeAlignment(prior_, options_.prior_kind, &alignment_, &error)) {
    Fail(Termination::kFailure, error);
    return summary_;
  }
  if (!pose->AllFinite()) {
    Fail(Termination::kFailure, "the start is not finite");
    return summary_;
  }
  constexpr double kMaxRotationDefect = 1e-6;
  if (!((pose->R.transpose() * pose->R - Eigen::Matrix3d::Identity()).norm() <
        kMaxRotationDefect) ||
      !(pose->R.determinant() > 0)) {
    Fail(Termination::kFailure, "the start's R is not a rotation");
    return summary_;
  }
  if (options_.use_prior && !prior_.IsValid(&error)) {
    Fail(Termination::kFailure, error);
    return summary_;
  }
  summary_.num_rounds = 0;
  summary_.num_iterations = 0;
  Pose result = *pose;
  ResolveSign(sign_subset_, options_.threshold_px, &result);
  // Before the fit: matches that hardly determine |t| would not move it far enough.
  if (UsesBodyLength(options_, prior_)) TakeDistance(&result);
  SelectInliers(result);
  SetNoise();
  if (SearchesScale(result)) {
    ResolveSignAndScale(sign_subset_, options_.threshold_px, &result);
  }
  bool done = true;
  const auto go_on = [&] { return done && !stop_.Asked(); };
  if (go_on()) done = Iterate(&result);
  if (go_on() && SearchesScale(result) && !ScaleIsFree(result) &&
      SearchScale(matches_, options_.threshold_px, noise_px_, &result)) {
    done = Iterate(&result);
  }
  // With another sign or scale, t is not at a minimum: refine again from there.
  if (go_on()) {
    const Eigen::Vector3d t = result.t;
    const bool possible = ResolveSign(sign_subset_, options_.threshold_px, &result);
    if (!possible && SearchesScale(result)) {
      ResolveSignAndScale(sign_subset_, options_.threshold_px, &result);
    }
    if (result.t != t) done = Iterate(&result);
  }
  // At the minimum, exclude inliers that fit by chance.
  if (go_on()) {
    excludes_chance_ = true;
    selected_at_.reset();
    if (SelectInliers(result)) done = Iterate(&result);
  }
  // Whether the scale is free must be decided at the final motion.
  if (go_on() && ScaleIsFree(result) != scale_free_) done = Iterate(&result);
  const bool stopped = done && stop_.reason() != StopReason::kNone;
  if (stopped) SelectInliers(result);
  summary_.median_residual_px = MedianResidual();
  if (!done) return summary_;

  summary_.exceeds_chance =
      ExceedsChance(matches_, result, num_inliers_, options_.threshold_px, options_.num_tries);
  CountCameraPairs(result);
  if (stopped) {
    summary_.termination = Termination::kStopped;
    summary_.stopped = stop_.reason();
  } else {
    FillUncertainty(result);
  }
  summary_.num_inliers = num_inliers_;
  summary_.inliers.assign(mask_.size(), 0);
  for (int k = 0; k < matches_.size(); ++k) summary_.inliers[matches_.original(k)] = mask_[k];
  summary_.message = stopped ? stop_.Message() : TerminationName(summary_.termination);
  *pose = result;
  return summary_;
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

Eigen::Vector3d FittedPoint(const RefineOptions& options, const MotionPrior& prior,
                            const Rig& rig) {
  return UsesBodyLength(options, prior) ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : RigCentre(rig);
}

RefineSummary RefineAbout(const RefineOptions& options, const GroupedMatches& matches,
                          const Eigen::Vector3d& origin, const MotionPrior& prior, Pose* pose) {
  RefineOptions resolved = options;
  resolved.threshold_px = ThresholdPx(options.threshold_px, matches.rig());
  // The rig's centre in the frame of `matches`, or the body's origin.
  const Eigen::Vector3d step =
      UsesBodyLength(options, prior) ? Eigen::Vector3d(-origin) : RigCentre(matches.rig());
  // For a rig that is already centred, the step is only rounding.
  constexpr double kRounding = 1e-12;
  double size = 0.0;
  for (const RigCamera& camera : matches.rig().cameras) size = std::max(size, camera.s.norm());
  const bool there = step.norm() <= kRounding * (size + origin.norm());
  const Eigen::Vector3d point = there ? origin : Eigen::Vector3d(origin + step);
  Pose result = MotionOfPoint(*pose, point);
  RefineSummary summary =
      there ? Refiner(resolved, matches, point, prior).Run(&result)
            : Refiner(resolved, matches.WithOrigin(step), point, prior).Run(&result);
  if (summary.IsSolutionUsable()) *pose = MotionOfBody(result, point);
  return summary;
}

RefineSummary Refine(const RefineOptions& options, const GroupedMatches& matches,
                     const MotionPrior& prior, Pose* pose) {
  return RefineAbout(options, matches, Eigen::Vector3d::Zero(), prior, pose);
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
  return Refine(options, GroupedMatches(rig, matches), prior, pose);
}

}  // namespace rigel
