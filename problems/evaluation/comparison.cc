#include "rigel/problems/evaluation/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>

#include "rigel/core/angles.h"
#include "rigel/core/enum_names.h"
#include "rigel/core/metrics.h"
#include "rigel/core/parallel.h"
#include "rigel/core/rig_centre.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/evaluation/cramer_rao.h"
#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {
namespace {

constexpr EnumName<MatchUse> kMatchUseNames[] = {
    {MatchUse::kAll, "all"}, {MatchUse::kIntra, "intra"}, {MatchUse::kInter, "inter"}};

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

// Only for the forms that take nothing as exact: the covariance of the others is not complete.
void FillNees(const Pose& truth, const MotionEstimate& estimate, RefineForm form,
              PairResult* result) {
  const bool complete = form == RefineForm::kFull || form == RefineForm::kBundle;
  if (!complete || !estimate.refine.covariance || !estimate.refine.translation_observable) return;
  // For the motion of the fitted point: its length may have been held fixed.
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

struct ErrorValues {
  std::vector<double> rotation_deg, direction_deg, scale;

  void Add(const std::optional<MotionErrors>& errors) {
    if (!errors) return;
    rotation_deg.push_back(RadToDeg(errors->rotation));
    if (errors->direction) direction_deg.push_back(RadToDeg(*errors->direction));
    if (errors->scale) scale.push_back(*errors->scale);
  }
};

// The values of the pairs that a solver solved, for the statistics of a summary.
class SummaryValues {
 public:
  void Add(const PairResult& result) {
    raw_.Add(result.raw);
    refined_.Add(result.refined);
    AddBound(result);
    if (result.nees) {
      nees_ += *result.nees;
      nees_dof_ += result.nees_dof;
      ++nees_pairs_;
    }
    inlier_ratio_.push_back(result.inlier_ratio);
    iterations_.push_back(result.iterations);
    if (result.ransac_ms) ransac_ms_.push_back(*result.ransac_ms);
    if (result.refine_ms) refine_ms_.push_back(*result.refine_ms);
  }

  // `solved` pairs were added.
  void Fill(size_t solved, SolverSummary* summary) const {
    // A statistic over less than half of the pairs would describe a selection.
    const auto in_most = [&](const std::vector<double>& values) {
      return 2 * values.size() > solved ? ComputeStatistics(values) : std::nullopt;
    };
    summary->raw_rotation_deg = ComputeStatistics(raw_.rotation_deg);
    summary->raw_direction_deg = in_most(raw_.direction_deg);
    summary->raw_scale = in_most(raw_.scale);
    summary->refined_rotation_deg = ComputeStatistics(refined_.rotation_deg);
    summary->refined_direction_deg = in_most(refined_.direction_deg);
    summary->refined_scale = in_most(refined_.scale);
    if (summary->raw_direction_deg) {
      summary->direction_pairs = static_cast<int>(raw_.direction_deg.size());
    }
    if (bound_rotation_deg_.size() == solved) {
      summary->bound_rotation_deg = ComputeStatistics(bound_rotation_deg_);
      summary->bound_direction_deg = in_most(bound_direction_deg_);
    }
    if (2 * static_cast<size_t>(nees_pairs_) > solved) FillNeesRatio(summary);
    summary->inlier_ratio = ComputeStatistics(inlier_ratio_);
    summary->iterations = ComputeStatistics(iterations_);
    if (ransac_ms_.size() == solved) summary->ransac_ms = ComputeStatistics(ransac_ms_);
    if (refine_ms_.size() == solved) summary->refine_ms = ComputeStatistics(refine_ms_);
  }

 private:
  void AddBound(const PairResult& result) {
    if (!result.bound) return;
    bound_rotation_deg_.push_back(RadToDeg(result.bound->rotation));
    // Only of pairs that have a direction error to compare it with.
    if (result.bound->direction && result.refined && result.refined->direction) {
      bound_direction_deg_.push_back(RadToDeg(*result.bound->direction));
    }
  }

  void FillNeesRatio(SolverSummary* summary) const {
    constexpr double kHalfPercent = 2.5758;  // of the normal distribution is beyond
    summary->nees_ratio = nees_ / nees_dof_;
    summary->nees_dof = nees_dof_ / nees_pairs_;
    summary->nees_low = ChiSquareQuantileRatio(nees_dof_, -kHalfPercent);
    summary->nees_high = ChiSquareQuantileRatio(nees_dof_, kHalfPercent);
  }

  ErrorValues raw_, refined_;
  std::vector<double> bound_rotation_deg_, bound_direction_deg_;
  std::vector<double> inlier_ratio_, iterations_, ransac_ms_, refine_ms_;
  double nees_ = 0.0, nees_dof_ = 0.0;
  int nees_pairs_ = 0;
};

}  // namespace

EstimateOptions WithStatedNoise(EstimateOptions options, const FramePair& pair) {
  if (pair.noise_px) options.refine.noise_px = pair.noise_px;
  return options;
}

PairResult ComparePair(const FramePair& pair, const EstimateOptions& options,
                       bool use_stated_noise) {
  PairResult result;
  result.name = pair.name;
  result.sequence = pair.sequence;
  const MotionEstimate estimate =
      EstimateMotion(use_stated_noise ? WithStatedNoise(options, pair) : options, pair);
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
  return FindValue(kMatchUseNames, name, use);
}

void SelectMatches(MatchUse use, FramePair* pair) {
  if (use == MatchUse::kAll) return;
  const bool intra = use == MatchUse::kIntra;
  std::vector<size_t> rows;
  std::vector<Match> matches;
  for (size_t k = 0; k < pair->matches.size(); ++k) {
    if (pair->matches[k].IsIntra() != intra) continue;
    rows.push_back(k);
    matches.push_back(pair->matches[k]);
  }
  pair->matches = std::move(matches);
  pair->columns = pair->columns.Subset(rows);
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
  SummaryValues values;
  for (const PairResult& result : results) {
    ++summary.pairs;
    if (result.failed) {
      ++summary.failures;
    } else {
      values.Add(result);
    }
  }
  values.Fill(static_cast<size_t>(summary.pairs - summary.failures), &summary);
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
