#include "rigel/refine/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "rigel/core/median.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/core/rays.h"
#include "rigel/refine/least_squares/ceres_engine.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/search/inlier_selection.h"

namespace rigel {
namespace {

// Longest |b|, in the largest of the lengths that are known.
constexpr double kMaxLength = 100.0;
// Shortest |b|, in typical lengths.
constexpr double kMinLength = 1e-9;
// A change of a factor, times the weight of the loss, that is worth another fit. At the gate a
// smooth loss has no weight left. Also the relative change of the noise.
constexpr double kFactorChange = 0.1;
constexpr double kNoiseChange = 0.02;
// Noise in pixel units that keeps noise-free problems regular.
constexpr double kMinNoise = 1e-9;
constexpr int kParameters = 6;

double LargestBaseline(const Rig& rig) {
  double largest = 0.0;
  for (const RigCamera& a : rig.cameras) {
    for (const RigCamera& b : rig.cameras) largest = std::max(largest, (a.s - b.s).norm());
  }
  return largest;
}

}  // namespace

Fitter::Fitter(const RefineOptions& options, bool gate_follows_noise, const GroupedMatches& matches,
               const Eigen::Vector3d& point, const MotionPrior& prior)
    : options_(options),
      matches_(matches),
      point_(point),
      prior_(prior),
      pixel_unit_(PixelUnit(matches.rig())),
      engine_(matches),
      stop_(options.time_limit, options.cancel),
      progress_([this](int iteration, double cost) {
        options_.progress({round_, iteration, cost});
      }) {
  noise_options_.threshold_px = options.threshold_px;
  noise_options_.keep_threshold = !gate_follows_noise;
  noise_options_.noise_px = options.noise_px;
  noise_options_.min_noise_px = kMinNoise * pixel_unit_;
  const double distance = prior.distance.value_or(0.0);
  if (options.use_prior) parts_.direction = options.prior_kind;
  parts_.distance = !options.hold_distance;
  if (!options.hold_distance) {
    parts_.typical_length = distance > 0 ? distance : options.typical_length;
  }
  parts_.point = {point.x(), point.y(), point.z()};
  min_length_ = kMinLength * options.typical_length;
  max_length_ =
      kMaxLength * std::max({options.typical_length, distance, LargestBaseline(matches.rig())});
  shared_ = FindSharedPixels(matches);
}

bool Fitter::PriorIsExact() const {
  return options_.form == RefineForm::kPrior || options_.form == RefineForm::kPriorDepths;
}

bool Fitter::HasReference() const {
  return options_.form == RefineForm::kDepths || options_.form == RefineForm::kPriorDepths;
}

bool Fitter::Prepare(std::string* error) {
  return !PriorIsExact() || MakeAlignment(prior_, options_.prior_kind, &alignment_, error);
}

std::vector<double> Fitter::FactorsOfAll(const Fit& fit) const {
  const bool algebraic =
      options_.residual == ResidualKind::kAlgebraic && options_.form != RefineForm::kBundle;
  std::vector<double> factors(matches_.size(), 1.0);
  if (options_.epipole_weights && !algebraic) {
    EpipoleWeights(matches_, fit.pose, fit.noise.sigma_px, &factors);
  }
  return factors;
}

// They are fixed for a round. As a function of the motion they would pull the epipoles to the
// matches.
void Fitter::SetFactors(const std::vector<double>& of_all, Fit* fit) const {
  fit->factors.resize(of_all.size());
  for (size_t k = 0; k < of_all.size(); ++k) fit->factors[k] = fit->inliers[k] ? of_all[k] : 0.0;
}

bool Fitter::Select(bool exclude_implausible, Fit* fit) {
  const std::vector<char> previous = fit->inliers;
  const std::vector<double> previous_factors = fit->factors;
  InlierFit members;
  bool judge = exclude_implausible && !previous.empty();
  if (judge) {
    judge = CovarianceOfBasis(MatchInformation(*fit) + PriorInformation(fit->pose),
                              FreeDirections(fit->pose), &members.covariance);
    members.members = previous;
  }
  const NoiseModel before = fit->noise;
  if (previous.empty() || fit->pose.R != fit->judged.R || fit->pose.t != fit->judged.t) {
    fit->errors.Set(matches_, fit->pose, options_.threshold_px);
    fit->noise = EstimateNoise(noise_options_, matches_, fit->errors, kParameters,
                               previous.empty() ? nullptr : &before);
    fit->judged = fit->pose;
  }
  fit->num_inliers = SelectWithinGate(matches_, fit->errors, fit->noise, &fit->inliers);
  const std::vector<double> factors = FactorsOfAll(*fit);
  if (judge) {
    members.weights = factors;
    for (size_t g = 0; g < matches_.groups().size(); ++g) {
      const MatchGroup& group = matches_.groups()[g];
      for (int k = group.begin; k < group.begin + group.size; ++k) {
        members.weights[k] /= fit->noise.sigma_of[g];
      }
    }
    fit->num_inliers =
        ExcludeImplausible(matches_, fit->pose, fit->errors, fit->noise, members, &fit->inliers);
  }
  fit->num_inliers -= ResolveCompetition(matches_, shared_, fit->errors.squared, &fit->inliers);
  SetFactors(factors, fit);
  if (previous.empty()) return true;
  if (std::abs(fit->noise.sigma_px - before.sigma_px) > kNoiseChange * before.sigma_px) return true;
  for (size_t g = 0; g < matches_.groups().size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      const double change = std::abs(fit->factors[k] - previous_factors[k]);
      if (!(change > kFactorChange)) continue;
      const double z = std::sqrt(fit->errors.squared[k]) / fit->noise.sigma_of[g];
      if (change * LossWeight(options_.loss, options_.loss_scale_sigmas, z) > kFactorChange) {
        return true;
      }
    }
  }
  return false;
}

std::vector<double> Fitter::EngineWeights(const Fit& fit) const {
  std::vector<double> weights = fit.factors;
  for (size_t g = 0; g < matches_.groups().size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    const double relative = fit.noise.sigma_px / fit.noise.sigma_of[g];
    for (int k = group.begin; k < group.begin + group.size; ++k) weights[k] *= relative;
  }
  return weights;
}

PriorResiduals Fitter::PriorAt(const Pose& start) const {
  return PriorResiduals(prior_, parts_, start);
}

Matrix6d Fitter::PriorInformation(const Pose& pose) const {
  PriorResiduals::Residuals r;
  PriorResiduals::Jacobian J;
  PriorAt(pose).Evaluate(pose, &r, &J);
  return J.transpose() * J;
}

Matrix6d Fitter::MatchInformation(const Fit& fit) const {
  return SampsonInformation(matches_, EngineWeights(fit), fit.pose) /
         (fit.noise.sigma_px * fit.noise.sigma_px);
}

MotionBasis Fitter::FreeDirections(const Pose& pose) const {
  return PriorIsExact() ? PriorBasis(pose, alignment_, !HoldsLength())
                        : FullBasis(pose, !HoldsLength());
}

TranslationForm Fitter::Translation() const {
  TranslationForm form;
  form.planar = PriorIsExact() && options_.prior_kind == PriorKind::kPlanar;
  form.depths = HasReference();
  form.holds_length = HoldsLength();
  return form;
}

// The reference match of the depth forms, -1 if there is none. Its rays are taken as exact, so it
// should have much parallax and little noise. Candidates are the inliers of largest parallax among
// those with an error below the median. The one whose exact rays give the best score is taken.
int Fitter::ChooseReference(const Fit& fit, RotationForm rotation) const {
  constexpr size_t kMaxCandidates = 16;
  constexpr double kMinParallax = 1e-6;
  const double limit = std::max(MedianResidual(fit), kMinNoise * pixel_unit_);
  std::vector<std::pair<double, int>> candidates;  // parallax, match
  for (int k = 0; k < matches_.size(); ++k) {
    if (!fit.inliers[k] || fit.errors.squared[k] > limit * limit) continue;
    const RayPair& rays = matches_.rays(k);
    const double parallax = (fit.pose.R * rays.ray1.x).cross(rays.ray2.x).norm();
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
    if (!parameterization.Set(rotation, Translation(), fit.pose, alignment_, rays)) continue;
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

bool Fitter::ReferenceIsStale(const Fit& fit) const {
  if (!HasReference()) return false;
  const RotationForm rotation = PriorIsExact() ? RotationForm::kAngle : RotationForm::kFree;
  return ChooseReference(fit, rotation) != reference_match_;
}

bool Fitter::FitOnce(bool last, Fit* fit, RefineSummary* summary) {
  const auto fail = [summary](const std::string& message) {
    summary->termination = Termination::kDegenerate;
    summary->message = message;
    return false;
  };
  round_ = summary->num_rounds + 1;
  const RotationForm rotation = PriorIsExact() ? RotationForm::kAngle : RotationForm::kFree;
  RayPair reference;
  if (HasReference()) {
    reference_match_ = ChooseReference(*fit, rotation);
    if (reference_match_ < 0) return fail("no match has the parallax that a reference needs");
    reference = matches_.rays(reference_match_);
  }
  // No length has no direction either; any will do.
  if (!(fit->pose.t.norm() > 0)) fit->pose.t = min_length_ * Eigen::Vector3d::UnitZ();
  MotionParameterization parameterization;
  if (!parameterization.Set(rotation, Translation(), fit->pose, alignment_, reference)) {
    return fail("the start has no place in the parameterization");
  }
  const int size = parameterization.size();
  const PriorResiduals prior = PriorAt(fit->pose);
  // The length can come from the prior. The reference of the depth forms adds no equation.
  const int needed = size + (HasReference() ? 1 : 0) - (HoldsLength() ? 0 : 1);
  if (fit->num_inliers < needed) {
    return fail(std::to_string(fit->num_inliers) + " inliers for " + std::to_string(size) +
                " free parameters");
  }
  const bool small = options_.engine == RefineEngine::kAuto &&
                     options_.residual == ResidualKind::kSampson &&
                     options_.form != RefineForm::kBundle;
  std::array<double, 6> parameters = {0, 0, 0, 0, 0, 0};
  const double sigma = fit->noise.sigma_px;
  LeastSquaresOptions engine_options;
  engine_options.loss = options_.loss;
  engine_options.loss_scale = options_.loss_scale_sigmas * sigma;
  engine_options.max_num_iterations = options_.max_num_iterations;
  engine_options.stop = &stop_;
  engine_options.progress = options_.progress ? &progress_ : nullptr;
  // The last step is some 1e-5 standard deviations long; while the selection changes a twentieth.
  engine_options.tolerance = last ? 1e-12 : 1e-6;
  engine_options.residual = options_.residual;
  engine_options.bundle = options_.form == RefineForm::kBundle;
  const std::vector<double> weights = EngineWeights(*fit);
  const LeastSquaresSummary result =
      small ? engine_.Solve(engine_options, parameterization, weights, prior, sigma,
                            parameters.data())
            : SolveWithCeres(engine_options, matches_, parameterization, weights, prior, sigma,
                             fit->pose, parameters.data());
  Pose refined;
  parameterization.Evaluate(parameters.data(), &refined, nullptr);
  if (!result.usable || !refined.AllFinite() || !std::isfinite(result.final_cost)) {
    return fail("the least-squares solver found no usable solution");
  }
  if (summary->initial_cost < 0) summary->initial_cost = result.initial_cost;
  summary->final_cost = result.final_cost;
  summary->num_iterations += result.num_iterations;
  summary->termination = result.converged ? Termination::kConverged : Termination::kIterationLimit;
  ++summary->num_rounds;
  // The weak prior keeps |b| near the typical length, unless the information is false.
  const double length = refined.t.norm();
  if (!HoldsLength() && length > max_length_) refined.t *= max_length_ / length;
  // A rig that stands still ends at no length, and then has no direction to go on from.
  if (!HoldsLength() && !(length > min_length_)) refined.t = min_length_ * fit->pose.t.normalized();
  fit->pose = refined;
  return true;
}

double MedianResidual(const Fit& fit) {
  // One entry more, so that the loop can write each match and overwrite those that are no inliers.
  std::vector<double> errors(fit.num_inliers + 1);
  size_t n = 0;
  for (size_t k = 0; k < fit.inliers.size(); ++k) {
    errors[n] = fit.errors.squared[k];
    n += fit.inliers[k] != 0 ? 1 : 0;
  }
  errors.resize(n);
  return errors.empty() ? -1.0 : std::sqrt(MedianInPlace(&errors));
}

double SignedMedianResidual(const GroupedMatches& matches, const MatchGroup& group,
                            const Fit& fit) {
  constexpr int kSample = 200;  // rows: they give the median to a tenth of the noise
  const int stride = std::max(1, group.size / kSample);
  const Eigen::Matrix3d F = matches.Fundamental(group, fit.pose);
  std::vector<double> errors;
  for (int k = group.begin; k < group.begin + group.size; k += stride) {
    if (!fit.inliers[k]) continue;
    const double C = matches.Point2(k).p.dot(F * matches.Point1(k).p);
    errors.push_back(std::copysign(std::sqrt(fit.errors.squared[k]), C));
  }
  return errors.empty() ? 0.0 : MedianInPlace(&errors);
}

}  // namespace rigel
