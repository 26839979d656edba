#include "rigel/refine/search/frame_pair_solver.h"

#include <algorithm>
#include <cmath>

#include "rigel/refine/search/sign_and_scale.h"

namespace rigel {
namespace {

// Matches for the loose score: enough to separate good and bad hypotheses roughly.
constexpr size_t kSubset = 128;
// Matches for local optimization: enough until the refinement, which takes all.
constexpr size_t kOptimized = 300;

}  // namespace

FramePairSolver::FramePairSolver(const SolverInfo& solver, const GroupedMatches& matches,
                                 const Alignment& alignment, const RansacOptions& options)
    : solver_(solver),
      matches_(matches),
      scored_subset_(matches.size() > options.max_scored ? matches.DrawnSubset(options.max_scored)
                                                         : GroupedMatches()),
      scored_(scored_subset_.size() > 0 ? scored_subset_ : matches_),
      subset_(matches.EvenSubset(kSubset)),
      drawn_subset_(scored_.DrawnSubset(kSubset)),
      sign_subset_(matches.EvenSubset(kSignSubset)),
      prepared_(PreparedMatches::OnDemand(matches, alignment)),
      sampler_(matches, solver.sampling, solver.sample_size, options.max_iterations,
               options.prosac),
      options_(options),
      optimized_(matches.EvenSubset(kOptimized)),
      loose_engine_(subset_),
      engine_(optimized_),
      threshold_px_(options.threshold_px) {
  for (const MatchGroup& group : matches.groups()) {
    if (group.camera1 != group.camera2) intra_only_ = false;
  }
}

double FramePairSolver::Work(int num_solutions) const {
  constexpr double kSample = 1.0, kSolution = 0.3, kGroup = 0.05, kMatch = 0.0025;
  return kSample + solver_.nominal_us +
         num_solutions * (kSolution + kGroup * static_cast<double>(scored_.groups().size()) +
                          kMatch * scored_.size());
}

// True if the sum over the subset is too far above its expectation for a total score of `best`. The
// terms are between 0 and t^2. Among all sets of terms with this mean, those of only 0 and t^2
// scatter most. Their sum is hypergeometric; if few terms are t^2, its tail is longer than a normal
// one.
bool FramePairSolver::BailsOut(const Model& model, double best) const {
  constexpr double kDeviations = 3.0;
  constexpr double kTerms = 2.0;
  const double n = scored_.size(), m = drawn_subset_.size();
  if (n < 2.0 * m) return false;
  const double t2 = threshold_px_ * threshold_px_;
  const double p = std::min(best / (n * t2), 1.0);
  const double sigma = std::sqrt(m * p * (1.0 - p) * (1.0 - m / n));
  const double limit = t2 * (m * p + kDeviations * sigma + kTerms);
  return drawn_subset_.Score(model, threshold_px_, limit, nullptr) > limit;
}

bool FramePairSolver::Admit(Model* model) const {
  return model->AllFinite() && ResolveSign(sign_subset_, threshold_px_, model);
}

bool FramePairSolver::Similar(const Model& a, const Model& b) const {
  constexpr double kMinTrace = 3.0 - 3.05e-4;  // 1 + 2 cos(1 deg)
  constexpr double kMinCosine = 0.94;          // 20 deg
  return a.R.cwiseProduct(b.R).sum() > kMinTrace &&
         std::abs(a.t.dot(b.t)) > kMinCosine * a.t.norm() * b.t.norm();
}

bool FramePairSolver::OptimizeLoosely(Model* model) const {
  ResolveSignAndMaybeScale(kLooseFactor * threshold_px_, model);
  return OptimizeOn(subset_, &loose_engine_, kLooseFactor * threshold_px_, model) &&
         OptimizeOn(optimized_, &engine_, threshold_px_, model) && Admit(model);
}

bool FramePairSolver::LocalOptimize(Model* model) const {
  Model optimized = *model;
  ResolveSignAndMaybeScale(threshold_px_, &optimized);
  if (!OptimizeOn(optimized_, &engine_, threshold_px_, &optimized) || !Admit(&optimized)) {
    return false;
  }
  *model = optimized;
  return true;
}

void FramePairSolver::ResolveSignAndMaybeScale(double threshold, Model* model) const {
  if (ScaleIsNoise(*model)) {
    ResolveSignAndScale(sign_subset_, threshold, model);
  } else {
    ResolveSign(sign_subset_, threshold, model);
  }
}

bool FramePairSolver::OptimizeOn(const GroupedMatches& matches, SmallEngine* engine,
                                 double threshold, Model* model) const {
  LeastSquaresOptions options;
  options.loss_scale = threshold;
  options.limits_length = ScaleIsNoise(*model);
  matches.SelectInliers(*model, threshold, &squared_errors_, &inliers_);
  return engine->Minimize(options, inliers_, PriorResiduals(), 1.0, model);
}

}  // namespace rigel
