#include "rigel/problems/evaluation/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Eigenvalues>

#include "rigel/core/angles.h"
#include "rigel/core/enum_names.h"
#include "rigel/core/metrics.h"
#include "rigel/core/parallel.h"
#include "rigel/core/rig_centre.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/evaluation/cramer_rao.h"

namespace rigel {
namespace {

constexpr EnumName<MatchUse> kMatchUseNames[] = {
    {MatchUse::kAll, "all"}, {MatchUse::kIntra, "intra"}, {MatchUse::kInter, "inter"}};

// The error of the direction of t, if both have one.
std::optional<double> DirectionError(const Pose& truth, const Pose& pose) {
  if (!(truth.t.norm() > kMinTrueTranslation)) return std::nullopt;
  const double direction = TranslationDirectionError(truth.t, pose.t);
  return std::isfinite(direction) ? std::optional<double>(direction) : std::nullopt;
}

MotionErrors ErrorsOf(const Pose& truth, const Pose& pose, bool direction_means, bool scale_means) {
  MotionErrors errors;
  errors.rotation = RotationError(truth.R, pose.R);
  if (truth.t.norm() > kMinTrueTranslation && direction_means) {
    errors.direction = DirectionError(truth, pose);
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

// Of the rig centre's motion, in its perturbation. The error of b is along the great circle of its
// direction and in its log length: an uncertain length is more nearly normal so.
Eigen::Matrix<double, 6, 1> CentreError(const Pose& truth, const Pose& estimate) {
  Eigen::Matrix<double, 6, 1> error;
  error << LogSO3(truth.R * estimate.R.transpose()), truth.t - estimate.t;
  const double norm = estimate.t.norm();
  const double true_norm = truth.t.norm();
  if (norm > 0 && true_norm > 0) {
    const Eigen::Vector3d direction = estimate.t / norm;
    const double angle = TranslationDirectionError(truth.t, estimate.t);
    const Eigen::Vector3d across = truth.t - truth.t.dot(direction) * direction;
    error.tail<3>() = norm * std::log(true_norm / norm) * direction;
    if (across.norm() > 0) error.tail<3>() += norm * angle * across.normalized();
  }
  return error;
}

// The error weighted by the pseudo-inverse of its covariance; degrees of freedom are its rank.
std::optional<NormalizedError> Normalize(const Eigen::VectorXd& error,
                                         const Eigen::MatrixXd& covariance) {
  // Of the mean variance of rotation and of translation, which differ in their units. Rounding
  // makes less than this of a zero.
  constexpr double kMinEigenvalue = 1e-12;
  const Eigen::Index block = std::min<Eigen::Index>(3, error.size());
  Eigen::VectorXd scale(error.size());
  for (Eigen::Index k = 0; k < error.size(); k += block) {
    const double variance = covariance.diagonal().segment(k, block).mean();
    scale.segment(k, block).setConstant(1.0 / std::sqrt(variance));
  }
  if (!scale.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * covariance *
                                                             scale.asDiagonal());
  const Eigen::VectorXd part = eigen.eigenvectors().transpose() * scale.cwiseProduct(error);
  NormalizedError normalized;
  for (int k = 0; k < part.size(); ++k) {
    const double variance = eigen.eigenvalues()(k);
    if (!(variance > kMinEigenvalue)) continue;
    normalized.value += part(k) * part(k) / variance;
    ++normalized.dof;
  }
  if (normalized.dof == 0 || !std::isfinite(normalized.value)) return std::nullopt;
  return normalized;
}

// Only for the forms that take nothing as exact: the covariance of the others is not complete.
void FillNees(const FramePair& pair, const MotionEstimate& estimate, RefineForm form,
              PairResult* result) {
  const bool complete = form == RefineForm::kFull || form == RefineForm::kBundle;
  if (!complete || !estimate.refine.covariance || !estimate.refine.covariance_valid) return;
  const Eigen::Vector3d centre = RigCentre(pair.rig);
  const Pose fitted = MotionOfPoint(estimate.pose, centre);
  const Eigen::Matrix<double, 6, 1> error = CentreError(MotionOfPoint(*pair.truth, centre), fitted);
  const Matrix6d to_centre = BodyFromPointJacobian(fitted.R, -centre);
  const Eigen::Matrix<double, 6, 6> covariance =
      to_centre * *estimate.refine.covariance * to_centre.transpose();
  result->nees_rotation = Normalize(error.head<3>(), covariance.topLeftCorner<3, 3>());
  if (estimate.refine.translation_observable) result->nees = Normalize(error, covariance);
  if (result->refined->rig_direction) {
    const Eigen::Matrix<double, 3, 2> across = TangentBasis(fitted.t.normalized());
    result->nees_rig_direction =
        Normalize(across.transpose() * error.tail<3>(),
                  across.transpose() * covariance.bottomRightCorner<3, 3>() * across);
  }
}

struct ErrorValues {
  std::vector<double> rotation_deg, direction_deg, scale, rig_direction_deg;

  void Add(const std::optional<MotionErrors>& errors) {
    if (!errors) return;
    rotation_deg.push_back(RadToDeg(errors->rotation));
    if (errors->direction) direction_deg.push_back(RadToDeg(*errors->direction));
    if (errors->scale) scale.push_back(*errors->scale);
    if (errors->rig_direction) rig_direction_deg.push_back(RadToDeg(*errors->rig_direction));
  }
};

class NeesSum {
 public:
  void Add(const std::optional<NormalizedError>& error) {
    if (!error) return;
    value_ += error->value;
    dof_ += error->dof;
    ++pairs_;
  }

  // Nothing if it is of no more than half of the `solved` pairs.
  std::optional<NeesStatistics> InMost(size_t solved) const {
    constexpr double kHalfPercent = 2.5758;  // of the normal distribution is beyond
    if (2 * static_cast<size_t>(pairs_) <= solved) return std::nullopt;
    return NeesStatistics{value_ / dof_, dof_ / pairs_, ChiSquareQuantileRatio(dof_, -kHalfPercent),
                          ChiSquareQuantileRatio(dof_, kHalfPercent)};
  }

 private:
  double value_ = 0.0, dof_ = 0.0;
  int pairs_ = 0;
};

// The values of the pairs that a solver solved, for the statistics of a summary.
class SummaryValues {
 public:
  void Add(const PairResult& result) {
    raw_.Add(result.raw);
    refined_.Add(result.refined);
    AddBound(result);
    nees_.Add(result.nees);
    nees_rotation_.Add(result.nees_rotation);
    nees_rig_direction_.Add(result.nees_rig_direction);
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
    summary->refined_rig_direction_deg = in_most(refined_.rig_direction_deg);
    if (summary->raw_direction_deg) {
      summary->direction_pairs = static_cast<int>(raw_.direction_deg.size());
    }
    if (bound_rotation_deg_.size() == solved) {
      summary->bound_rotation_deg = ComputeStatistics(bound_rotation_deg_);
      summary->bound_direction_deg = in_most(bound_direction_deg_);
      summary->bound_rig_direction_deg = in_most(bound_rig_direction_deg_);
    }
    summary->nees = nees_.InMost(solved);
    summary->nees_rotation = nees_rotation_.InMost(solved);
    summary->nees_rig_direction = nees_rig_direction_.InMost(solved);
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
    if (!result.refined) return;
    if (result.bound->direction && result.refined->direction) {
      bound_direction_deg_.push_back(RadToDeg(*result.bound->direction));
    }
    if (result.bound->rig_direction && result.refined->rig_direction) {
      bound_rig_direction_deg_.push_back(RadToDeg(*result.bound->rig_direction));
    }
  }

  ErrorValues raw_, refined_;
  std::vector<double> bound_rotation_deg_, bound_direction_deg_, bound_rig_direction_deg_;
  std::vector<double> inlier_ratio_, iterations_, ransac_ms_, refine_ms_;
  NeesSum nees_, nees_rotation_, nees_rig_direction_;
};

}  // namespace

PairResult ComparePair(const FramePair& pair, const EstimateOptions& options) {
  PairResult result;
  result.name = pair.name;
  result.sequence = pair.sequence;
  const MotionEstimate estimate = EstimateMotion(options, pair);
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
    const Eigen::Vector3d centre = RigCentre(pair.rig);
    const Pose of_centre = MotionOfPoint(*pair.truth, centre);
    if (estimate.refine.RigDirectionKnown()) {
      result.refined->rig_direction =
          DirectionError(of_centre, MotionOfPoint(estimate.pose, centre));
    }
    RefineOptions bound_options(options.refine);
    bound_options.prior_kind = FindSolver(estimate.solver)->prior;
    if (const auto bound = ComputeCramerRaoBound(bound_options, pair)) {
      const auto where_it_means = [](const Pose& motion, double sigma) {
        const bool means = motion.t.norm() > kMinTrueTranslation && std::isfinite(sigma);
        return means ? std::optional<double>(sigma) : std::nullopt;
      };
      result.bound = MotionBound{bound->rotation, where_it_means(*pair.truth, bound->direction),
                                 where_it_means(of_centre, bound->rig_direction)};
    }
    FillNees(pair, estimate, options.refine.form, &result);
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
  pair->columns = pair->columns.Subset(rows);
  pair->matches = std::move(matches);
}

bool HasInterCameraMatches(const FramePair& pair) {
  return std::any_of(pair.matches.begin(), pair.matches.end(),
                     [](const Match& m) { return !m.IsIntra(); });
}

std::vector<PairResult> RunSolver(const std::vector<FramePair>& pairs,
                                  const EstimateOptions& options, int num_threads,
                                  const std::function<void()>& progress) {
  std::vector<PairResult> results(pairs.size());
  ParallelFor(static_cast<int>(pairs.size()), num_threads, [&](int k) {
    results[k] = ComparePair(pairs[k], options);
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
