#include "rigel/refine/estimate_motion.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#include "rigel/core/body_axes.h"
#include "rigel/minimal/prepared_matches.h"
#include "rigel/minimal/prosac.h"
#include "rigel/refine/sign_and_scale.h"
#include "rigel/refine/small_engine.h"
#include "rigel/refine/solver_choice.h"

namespace rigel {
namespace {

// The solver concept of ransac.h for a frame pair and a solver of the catalogue.
class FramePairSolver {
 public:
  using Model = Solution;
  using Solutions = rigel::Solutions;

  FramePairSolver(const SolverInfo& solver, const GroupedMatches& matches,
                  const Alignment& alignment, const RansacOptions& options)
      : solver_(solver),
        matches_(matches),
        subset_(matches.EvenSubset(kSubset)),
        drawn_subset_(matches.DrawnSubset(kSubset)),
        sign_subset_(matches.EvenSubset(kSignSubset)),
        prepared_(PreparedMatches::OnDemand(matches, alignment)),
        sampler_(matches, solver.sampling, solver.sample_size, options.max_iterations,
                 options.prosac),
        options_(options),
        optimized_(matches.EvenSubset(kOptimized)),
        loose_engine_(subset_),
        engine_(optimized_),
        threshold_px_(options.threshold_px) {
    if (options.score == ScoreKind::kMagsac) {
      loss_ = MagsacTable(options.threshold_px * options.threshold_px);
    }
    for (const MatchGroup& group : matches.groups()) {
      if (group.camera1 != group.camera2) intra_only_ = false;
    }
  }

  int num_data() const { return matches_.size(); }
  int sample_size() const { return solver_.sample_size; }
  bool Draw(Random* random, int* sample) const {
    for (int k = 0; k < kMaxRedraws; ++k) {
      const bool drawn = sampler_.Draw(random, sample);
      if (!drawn || !options_.spread_samples || IsSpread(sample)) return drawn;
    }
    return true;
  }
  int MinimalSolver(const int* sample, Solutions* solutions) const {
    prepared_.Prepare(sample, solver_.sample_size);
    return solver_.solve(prepared_, sample, solutions);
  }
  // Does not look at depths, which only add to the score; the sign of t matters little to it.
  double QuickScore(const Model& model, double bound) const {
    return matches_.Score(model, threshold_px_, bound, nullptr, Loss());
  }
  // The sum over the subset is too far above its expectation for a score of `best`. Terms are
  // between 0 and t^2: of all sets of so many with this mean those of zeros and t^2 alone scatter
  // most, hypergeometrically, and where few are t^2 with a longer tail than a normal one.
  bool BailsOut(const Model& model, double best) const {
    constexpr double kDeviations = 3.0;
    constexpr double kTerms = 2.0;
    const double n = matches_.size(), m = drawn_subset_.size();
    if (n < 2.0 * m) return false;
    const double t2 = threshold_px_ * threshold_px_;
    const double p = std::min(best / (n * t2), 1.0);
    const double sigma = std::sqrt(m * p * (1.0 - p) * (1.0 - m / n));
    const double limit = t2 * (m * p + kDeviations * sigma + kTerms);
    return drawn_subset_.Score(model, threshold_px_, limit, nullptr, Loss()) > limit;
  }
  double Score(const Model& model, double bound, int* inliers) const {
    return matches_.ScoreInFront(model, threshold_px_, bound, inliers, Loss());
  }

  bool Admit(Model* model) const {
    return model->AllFinite() && ResolveSign(sign_subset_, threshold_px_, model);
  }

  bool Similar(const Model& a, const Model& b) const {
    constexpr double kMinTrace = 3.0 - 3.05e-4;  // 1 + 2 cos(1 deg)
    constexpr double kMinCosine = 0.94;          // 20 deg
    return a.R.cwiseProduct(b.R).sum() > kMinTrace &&
           std::abs(a.t.dot(b.t)) > kMinCosine * a.t.norm() * b.t.norm();
  }

  double LooseScore(const Model& model, double bound) const {
    return subset_.Score(model, kLooseFactor * threshold_px_, bound, nullptr);
  }

  // In two steps, at the loose threshold and at the threshold.
  bool OptimizeLoosely(Model* model) const {
    ResolveSignAndMaybeScale(kLooseFactor * threshold_px_, model);
    return OptimizeOn(subset_, &loose_engine_, kLooseFactor * threshold_px_, model) &&
           OptimizeOn(optimized_, &engine_, threshold_px_, model) && Admit(model);
  }

  bool LocalOptimize(Model* model) const {
    Model optimized = *model;
    ResolveSignAndMaybeScale(threshold_px_, &optimized);
    if (!OptimizeOn(optimized_, &engine_, threshold_px_, &optimized) || !Admit(&optimized)) {
      return false;
    }
    *model = optimized;
    return true;
  }

 private:
  // A motion prior that is off by half a degree moves points by a few pixels.
  static constexpr double kLooseFactor = 4.0;
  // So many matches tell a good hypothesis from a bad one loosely.
  static constexpr size_t kSubset = 128;
  // The refinement takes all; until then these are enough.
  static constexpr size_t kOptimized = 300;

  const LossTable* Loss() const { return loss_.has_value() ? &*loss_ : nullptr; }

  // No two matches of a camera pair near one another in the first image.
  bool IsSpread(const int* sample) const {
    const double limit2 = options_.min_sample_distance_px * options_.min_sample_distance_px;
    for (int i = 0; i < solver_.sample_size; ++i) {
      const Match& a = matches_.matches()[sample[i]];
      for (int j = 0; j < i; ++j) {
        const Match& b = matches_.matches()[sample[j]];
        if (a.camera1 == b.camera1 && a.camera2 == b.camera2 &&
            (a.pixel1 - b.pixel1).squaredNorm() < limit2) {
          return false;
        }
      }
    }
    return true;
  }

  // Such matches and a minimal sample hardly determine |t|.
  bool ScaleIsNoise(const Model& model) const { return intra_only_ || !model.has_scale; }

  void ResolveSignAndMaybeScale(double threshold, Model* model) const {
    if (ScaleIsNoise(*model)) {
      ResolveSignAndScale(sign_subset_, threshold, model);
    } else {
      ResolveSign(sign_subset_, threshold, model);
    }
  }

  bool OptimizeOn(const GroupedMatches& matches, SmallEngine* engine, double threshold,
                  Model* model) const {
    SmallEngineOptions options;
    options.loss_scale = threshold;
    options.inverse_scale = ScaleIsNoise(*model);
    matches.SelectInliers(*model, threshold, &squared_errors_, &inliers_);
    return engine->Minimize(options, inliers_, model);
  }

  const SolverInfo& solver_;
  const GroupedMatches& matches_;
  GroupedMatches subset_;
  GroupedMatches drawn_subset_;
  GroupedMatches sign_subset_;
  mutable PreparedMatches prepared_;
  mutable ProsacSampler sampler_;
  const RansacOptions& options_;
  std::optional<LossTable> loss_;
  GroupedMatches optimized_;
  mutable SmallEngine loose_engine_;
  mutable SmallEngine engine_;
  double threshold_px_;
  mutable std::vector<double> squared_errors_;
  mutable std::vector<char> inliers_;
  bool intra_only_ = true;
};

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

// Ackermann motion has a front: that of the rig where the prior states none.
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

const char* EstimateStatusName(EstimateStatus status) {
  switch (status) {
    case EstimateStatus::kNotRun:
      return "not run";
    case EstimateStatus::kSuccess:
      return "ok";
    case EstimateStatus::kInvalidInput:
      return "invalid input";
    case EstimateStatus::kTooFewMatches:
      return "too few matches";
    case EstimateStatus::kNoSolution:
      return "no solution";
    case EstimateStatus::kNotRefined:
      return "not refined";
  }
  return "unknown";
}

bool EstimateOptions::IsValid(std::string* error) const {
  if (!IsSolverName(solver)) {
    *error = "there is no solver '" + solver + "'; expected one of " + SolverNamesWithAuto();
    return false;
  }
  RefineOptions refined = refine;
  // "auto" may find a prior of any kind.
  refined.prior_kind = solver == kAutoSolver ? PriorKind::kVertical : FindSolver(solver)->prior;
  return ransac.IsValid(error) && (!refine_motion || refined.IsValid(error));
}

MotionEstimate EstimateMotion(const EstimateOptions& options, const FramePair& pair) {
  std::string error;
  if (!options.IsValid(&error) || !pair.IsValid(&error)) {
    return Refused(EstimateStatus::kInvalidInput, error);
  }
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
  const int num_matches = static_cast<int>(pair.matches.size());

  MotionEstimate estimate;
  const auto ransac_start = std::chrono::steady_clock::now();
  const GroupedMatches matches(pair.rig, pair.matches);
  RansacResult<Solution> ransac;
  const SolverInfo* solver = nullptr;
  for (const SolverInfo* candidate : solvers) {
    Alignment alignment;
    if (!MakeAlignment(WithForward(pair), candidate->prior, &alignment, &error)) {
      return Refused(EstimateStatus::kInvalidInput, options.solver + ": " + error);
    }
    if (num_matches < candidate->sample_size) {
      if (solver != nullptr) break;
      return Refused(EstimateStatus::kTooFewMatches, std::to_string(num_matches) + " matches, " +
                                                         candidate->name + " needs " +
                                                         std::to_string(candidate->sample_size));
    }
    const FramePairSolver problem(*candidate, matches, alignment, options.ransac);
    Solutions solutions;
    const RansacResult<Solution> result = Ransac(problem, options.ransac, &solutions);
    estimate.iterations += result.iterations;
    estimate.hypotheses += result.hypotheses;
    if (solver == nullptr || (result.found && !(ransac.found && ransac.score <= result.score))) {
      ransac = result;
      solver = candidate;
    }
    if (result.found && candidate != solvers.back() &&
        !IsDoubtful(pair.prior, *candidate, result.best, matches, options.ransac.threshold_px)) {
      break;
    }
  }
  estimate.ransac_ms = MillisecondsSince(ransac_start);
  estimate.solver = solver->name;
  if (!ransac.found) {
    estimate.status = EstimateStatus::kNoSolution;
    estimate.message = "no sample of the matches determines a motion";
    return estimate;
  }
  estimate.raw = ransac.best_minimal;
  estimate.pose = ransac.best;
  estimate.num_inliers = ransac.num_inliers;
  estimate.inlier_ratio = ransac.num_inliers / static_cast<double>(matches.size());
  estimate.status = EstimateStatus::kSuccess;
  estimate.message = "ok";
  if (!options.refine_motion) return estimate;

  const auto refine_start = std::chrono::steady_clock::now();
  RefineOptions refine = options.refine;
  refine.prior_kind = solver->prior;
  refine.threshold_px = options.ransac.threshold_px;
  estimate.refine = Refine(refine, matches, pair.prior, &estimate.pose);
  estimate.refine_ms = MillisecondsSince(refine_start);
  if (!estimate.refine.IsSolutionUsable()) {
    estimate.status = EstimateStatus::kNotRefined;
    estimate.message = "not refined: " + estimate.refine.message;
    estimate.pose = ransac.best;
    return estimate;
  }
  estimate.num_inliers = estimate.refine.num_inliers;
  estimate.inlier_ratio = estimate.num_inliers / static_cast<double>(matches.size());
  return estimate;
}

}  // namespace rigel
