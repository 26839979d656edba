#include "rigel/problems/evaluation/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/core/parallel.h"
#include "rigel/core/rig_centre.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/evaluation/cramer_rao.h"
#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {
namespace {

MotionErrors ErrorsOf(const Pose& truth, const Pose& pose, bool direction_means, bool scale_means) {
  MotionErrors errors;
  errors.rotation = RotationError(truth.R, pose.R);
  if (truth.t.norm() > kMinTrueTranslation && direction_means) {
    const double direction = TranslationDirectionError(truth.t, pose.t);
    if (std::isfinite(direction)) errors.direction = direction;
    const double scale = ScaleError(truth.t, pose.t);
    if (std::isfinite(scale) && scale_means) errors.scale = scale;
  }
  return errors;
}

// The quantile of a chi-square distribution over its degrees of freedom (Wilson and Hilferty 1931),
// at `z` standard deviations of the normal distribution.
double ChiSquareQuantileRatio(double dof, double z) {
  const double v = 2.0 / (9.0 * dof);
  const double root = 1.0 - v + z * std::sqrt(v);
  return root * root * root;
}

// Only of the forms that take nothing as exact: the others' covariance leaves something out.
void FillNees(const Pose& truth, const MotionEstimate& estimate, RefineForm form,
              PairResult* result) {
  const bool complete = form == RefineForm::kFull || form == RefineForm::kBundle;
  if (!complete || !estimate.refine.covariance || !estimate.refine.translation_observable) return;
  // Of the motion that was fitted: its length is what may have been held.
  const Eigen::Vector3d& point = estimate.refine.fitted_point;
  const Pose fitted = MotionOfPoint(estimate.pose, point);
  const Eigen::Vector3d true_b = MotionOfPoint(truth, point).t;
  const MotionBasis basis = FullBasis(fitted, estimate.refine.scale_free);
  Eigen::Matrix<double, 6, 1> error;
  error.head<3>() = LogSO3(truth.R * fitted.R.transpose());
  const double norm = estimate.refine.scale_free ? true_b.norm() : fitted.t.norm();
  error.tail<3>() = norm * true_b.normalized() - fitted.t;
  const Matrix6d from_body = BodyFromPointJacobian(fitted.R, -point);
  const Eigen::MatrixXd covariance =
      basis.transpose() * from_body * *estimate.refine.covariance * from_body.transpose() * basis;
  const Eigen::VectorXd free = basis.transpose() * error;
  const double nees = free.dot(covariance.ldlt().solve(free));
  if (!std::isfinite(nees)) return;
  result->nees = nees;
  result->nees_dof = static_cast<int>(basis.cols());
}

}  // namespace

PairResult ComparePair(const FramePair& pair, const EstimateOptions& options,
                       bool use_stated_noise) {
  PairResult result;
  result.name = pair.name;
  result.sequence = pair.sequence;
  EstimateOptions pair_options = options;
  if (use_stated_noise && pair.noise_px.has_value()) pair_options.refine.noise_px = pair.noise_px;
  const MotionEstimate estimate = EstimateMotion(pair_options, pair);
  result.status = estimate.status;
  result.message = estimate.message;
  result.inlier_ratio = estimate.inlier_ratio;
  result.iterations = estimate.iterations;
  result.doubt = estimate.doubt;
  result.ransac_ms = estimate.ransac_ms;
  result.refine_ms = estimate.refine_ms;
  result.failed = estimate.status != EstimateStatus::kSuccess;
  if (result.failed || !pair.truth.has_value()) return result;
  // Without a refinement nothing is known of what can be observed; the direction stands as it is.
  const bool refined = options.refine_motion;
  const bool direction_means = !refined || estimate.refine.translation_observable;
  const bool scale_means = refined ? estimate.refine.scale_observable
                                   : estimate.raw.has_scale && HasInterCameraMatches(pair);
  result.raw = ErrorsOf(*pair.truth, estimate.raw, direction_means, scale_means);
  if (refined) {
    result.refined = ErrorsOf(*pair.truth, estimate.pose, direction_means, scale_means);
    RefineOptions bound_options(options.refine);
    bound_options.prior_kind = FindSolver(estimate.solver)->prior;
    bound_options.threshold_px = options.ransac.threshold_px;
    if (const auto bound = ComputeCramerRaoBound(bound_options, pair)) {
      result.bound = MotionBound{bound->rotation, {}};
      if (pair.truth->t.norm() > kMinTrueTranslation && std::isfinite(bound->direction)) {
        result.bound->direction = bound->direction;
      }
    }
    FillNees(*pair.truth, estimate, options.refine.form, &result);
  }
  return result;
}

bool ParseMatchUse(std::string_view name, MatchUse* use) {
  if (name == "all") {
    *use = MatchUse::kAll;
  } else if (name == "intra") {
    *use = MatchUse::kIntra;
  } else if (name == "inter") {
    *use = MatchUse::kInter;
  } else {
    return false;
  }
  return true;
}

void SelectMatches(MatchUse use, FramePair* pair) {
  if (use == MatchUse::kAll) return;
  const bool intra = use == MatchUse::kIntra;
  const auto end = std::remove_if(pair->matches.begin(), pair->matches.end(),
                                  [intra](const Match& m) { return m.IsIntra() != intra; });
  pair->matches.erase(end, pair->matches.end());
}

bool HasInterCameraMatches(const FramePair& pair) {
  return std::any_of(pair.matches.begin(), pair.matches.end(),
                     [](const Match& m) { return !m.IsIntra(); });
}

std::vector<PairResult> RunSolver(const std::vector<FramePair>& pairs,
                                  const EstimateOptions& options, int num_threads,
                                  const std::function<void()>& progress, bool use_stated_noise) {
  std::vector<PairResult> results(pairs.size());
  ParallelFor(static_cast<int>(pairs.size()), num_threads, [&](int k) {
    results[k] = ComparePair(pairs[k], options, use_stated_noise);
    if (progress) progress();
  });
  return results;
}

SolverSummary Summarize(const std::string& solver, const std::string& sequence,
                        const std::vector<PairResult>& results) {
  SolverSummary summary;
  summary.solver = solver;
  summary.sequence = sequence;
  std::vector<double> rotation[2], direction[2], scale[2];
  std::vector<double> bound_rotation, bound_direction;
  std::vector<double> inlier_ratio, iterations, ransac_ms, refine_ms;
  double nees = 0.0, nees_dof = 0.0;
  int nees_pairs = 0;
  for (const PairResult& result : results) {
    ++summary.pairs;
    if (result.failed) {
      ++summary.failures;
      continue;
    }
    const std::optional<MotionErrors>* errors[2] = {&result.raw, &result.refined};
    for (int k = 0; k < 2; ++k) {
      if (!errors[k]->has_value()) continue;
      const MotionErrors& e = **errors[k];
      rotation[k].push_back(RadToDeg(e.rotation));
      if (e.direction) direction[k].push_back(RadToDeg(*e.direction));
      if (e.scale) scale[k].push_back(*e.scale);
    }
    if (result.bound) {
      bound_rotation.push_back(RadToDeg(result.bound->rotation));
      // Of the pairs whose errors it is held against.
      if (result.bound->direction && result.refined && result.refined->direction) {
        bound_direction.push_back(RadToDeg(*result.bound->direction));
      }
    }
    if (result.nees) {
      nees += *result.nees;
      nees_dof += result.nees_dof;
      ++nees_pairs;
    }
    inlier_ratio.push_back(result.inlier_ratio);
    iterations.push_back(result.iterations);
    if (result.ransac_ms) ransac_ms.push_back(*result.ransac_ms);
    if (result.refine_ms) refine_ms.push_back(*result.refine_ms);
  }
  const size_t solved = static_cast<size_t>(summary.pairs - summary.failures);
  // A statistic over less than half of the pairs would speak of a selection.
  const auto in_most = [&](const std::vector<double>& values) {
    return 2 * values.size() > solved ? ComputeStatistics(values) : std::nullopt;
  };
  summary.raw_rotation_deg = ComputeStatistics(rotation[0]);
  summary.raw_direction_deg = in_most(direction[0]);
  summary.raw_scale = in_most(scale[0]);
  summary.refined_rotation_deg = ComputeStatistics(rotation[1]);
  summary.refined_direction_deg = in_most(direction[1]);
  summary.refined_scale = in_most(scale[1]);
  if (summary.raw_direction_deg) summary.direction_pairs = static_cast<int>(direction[0].size());
  if (bound_rotation.size() == solved) {
    summary.bound_rotation_deg = ComputeStatistics(bound_rotation);
    summary.bound_direction_deg = in_most(bound_direction);
  }
  if (2 * static_cast<size_t>(nees_pairs) > solved) {
    constexpr double kHalfPercent = 2.5758;  // of the normal distribution is beyond
    summary.nees_ratio = nees / nees_dof;
    summary.nees_dof = nees_dof / nees_pairs;
    summary.nees_low = ChiSquareQuantileRatio(nees_dof, -kHalfPercent);
    summary.nees_high = ChiSquareQuantileRatio(nees_dof, kHalfPercent);
  }
  summary.inlier_ratio = ComputeStatistics(inlier_ratio);
  summary.iterations = ComputeStatistics(iterations);
  if (ransac_ms.size() == solved) summary.ransac_ms = ComputeStatistics(ransac_ms);
  if (refine_ms.size() == solved) summary.refine_ms = ComputeStatistics(refine_ms);
  return summary;
}

std::vector<SolverSummary> SummarizeAll(const std::vector<SolverResults>& solvers,
                                        bool by_sequence) {
  std::vector<SolverSummary> summaries;
  for (const SolverResults& results : solvers) {
    summaries.push_back(Summarize(results.solver, "all", results.pairs));
    if (!by_sequence) continue;
    std::map<std::string, std::vector<PairResult>> sequences;
    for (const PairResult& r : results.pairs) {
      if (!r.sequence.empty()) sequences[r.sequence].push_back(r);
    }
    for (const auto& [sequence, group] : sequences) {
      summaries.push_back(Summarize(results.solver, sequence, group));
    }
  }
  return summaries;
}

}  // namespace rigel
