#include "rigel/problems/evaluation/cramer_rao.h"

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "rigel/core/alignment.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/linked_matches.h"
#include "rigel/core/rig_centre.h"
#include "rigel/refine/least_squares/noise_information.h"
#include "rigel/refine/least_squares/prior_residuals.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/search/noise_model.h"

namespace rigel {
namespace {

// Of matches, in the perturbation of the rig centre's motion.
struct MatchInformation {
  Matrix6d sum = Matrix6d::Zero();
  Matrix6d noise = Matrix6d::Zero();  // what noise of the pixels adds to `sum` in the mean
};

// By position in the pair's matches: 1 for true inliers.
std::vector<char> TrueInliers(const FramePair& pair) {
  if (!pair.columns.inlier.empty()) return pair.columns.inlier;
  const GroupedMatches matches(pair.rig, pair.matches, pair.columns, pair.Interval());
  std::vector<double> errors;
  std::vector<char> grouped;
  matches.SelectInliers(*pair.truth, kBoundSigmas * *pair.noise_px, &errors, &grouped);
  std::vector<char> inliers(pair.matches.size());
  for (int k = 0; k < matches.size(); ++k) inliers[matches.original(k)] = grouped[k];
  return inliers;
}

std::vector<Match> ExactMatches(const FramePair& pair) {
  std::vector<Match> matches = pair.matches;
  for (size_t k = 0; k < matches.size(); ++k) {
    const auto& [u1, v1, u2, v2] = pair.columns.exact[k];
    matches[k].pixel1 = {u1, v1};
    matches[k].pixel2 = {u2, v2};
  }
  return matches;
}

// Fills the rows of the matches of the mask at `pose`, by their positions in `matches`; takes those
// at an epipole out of the mask.
std::vector<SampsonRow> RowsOf(const FramePair& pair, const Rig& rig,
                               const std::vector<Match>& matches, const Pose& pose,
                               std::vector<char>* mask) {
  const GroupedMatches grouped(rig, matches, pair.columns, pair.Interval());
  const MotionBasis basis = FullBasis(pose, true);
  std::vector<GroupLinearization> linear;
  LinearizeGroups(grouped, ResidualKind::kSampson, pose, &basis, &linear);
  std::vector<SampsonRow> rows(matches.size());
  for (size_t g = 0; g < linear.size(); ++g) {
    const MatchGroup& group = grouped.groups()[g];
    for (int i = group.begin; i < group.begin + group.size; ++i) {
      const int k = grouped.original(i);
      if (!(*mask)[k]) continue;
      (*mask)[k] =
          DifferentiateSampson(linear[g], grouped.Point1(i), grouped.Point2(i), &rows[k]) ? 1 : 0;
    }
  }
  return rows;
}

// The correlation of the errors of the matches `set`, by the pixels they share (as measured).
Eigen::MatrixXd CorrelationOf(const ImagePoints& measured, const std::vector<SampsonRow>& rows,
                              const std::vector<int>& set) {
  const auto n = static_cast<int>(set.size());
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    const UnalignedMatrix<4>& gradient = rows[set[i]].gradient;
    for (int j = 0; j < n; ++j) {
      const UnalignedMatrix<4>& other = rows[set[j]].gradient;
      if (measured.Share(set[i], set[j], false)) S(i, j) += gradient.head<2>().dot(other.head<2>());
      if (measured.Share(set[i], set[j], true)) S(i, j) += gradient.tail<2>().dot(other.tail<2>());
    }
  }
  return S;
}

// Adds what one coordinate of the pixels makes of the information: each pixel once, as it changes
// the rows of all matches that have it.
void AddLinkedNoise(const ImagePoints& measured, const std::vector<SampsonRow>& rows,
                    const std::vector<int>& set, int coordinate, const Eigen::MatrixXd& whiten,
                    Matrix6d* noise) {
  const bool at_time2 = coordinate >= 2;
  const auto n = static_cast<int>(set.size());
  std::vector<char> seen(n, 0);
  for (int i = 0; i < n; ++i) {
    if (seen[i]) continue;
    Eigen::MatrixXd change = Eigen::MatrixXd::Zero(6, n);
    for (int j = i; j < n; ++j) {
      if (!measured.Share(set[i], set[j], at_time2)) continue;
      seen[j] = 1;
      change.col(j) = rows[set[j]].by_motion_and_pixels.col(coordinate);
    }
    const Eigen::MatrixXd white = change * whiten;
    *noise += white * white.transpose();
  }
}

// Adds the matches `set`, which are linked by the pixels they share, with the inverse of the
// correlation of their errors as weight. Where that has no rank, errors follow from others and add
// nothing: those of a repeated match.
void AddLinked(const ImagePoints& measured, const std::vector<SampsonRow>& rows,
               const std::vector<int>& set, double variance, MatchInformation* information) {
  // Of a correlation matrix: far above the rounding of a zero.
  constexpr double kMinEigenvalue = 1e-6;
  const auto n = static_cast<int>(set.size());
  Eigen::MatrixXd J(6, n);
  for (int i = 0; i < n; ++i) J.col(i) = rows[set[i]].by_motion;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(CorrelationOf(measured, rows, set));
  Eigen::VectorXd scale(n);
  for (int i = 0; i < n; ++i) {
    const double value = eigen.eigenvalues()(i);
    scale(i) = value > kMinEigenvalue ? 1.0 / std::sqrt(value) : 0.0;
  }
  const Eigen::MatrixXd whiten = eigen.eigenvectors() * scale.asDiagonal();
  const Eigen::MatrixXd white = J * whiten;
  information->sum += white * white.transpose() / variance;
  for (int coordinate = 0; coordinate < 4; ++coordinate) {
    AddLinkedNoise(measured, rows, set, coordinate, whiten, &information->noise);
  }
}

// Of the true inliers at `truth`, the motion of the rig's centre `centre`. False if too many are
// linked.
bool SumInliers(const FramePair& pair, const Eigen::Vector3d& centre, const Pose& truth,
                MatchInformation* information) {
  const bool exact = !pair.columns.exact.empty();
  const double variance = *pair.noise_px * *pair.noise_px;
  std::vector<char> mask = TrueInliers(pair);
  const std::vector<SampsonRow> rows = RowsOf(
      pair, WithOrigin(pair.rig, centre), exact ? ExactMatches(pair) : pair.matches, truth, &mask);
  const ImagePoints points(pair.matches, pair.columns.landmark);
  for (const std::vector<int>& set : LinkedMatches(points, mask)) {
    if (set.size() > static_cast<size_t>(kMaxLinkedMatches)) return false;
    AddLinked(points, rows, set, variance, information);
  }
  if (exact) information->noise.setZero();
  return true;
}

// Of what the pair states about the body's motion, in the perturbation of that.
Matrix6d StatedInformation(const RefineOptions& options, const FramePair& pair) {
  PriorParts parts;
  if (options.use_prior) parts.direction = options.prior_kind;
  parts.distance = true;
  const PriorResiduals prior(pair.prior, parts, *pair.truth);
  PriorResiduals::Residuals r;
  PriorResiduals::Jacobian J;
  prior.Evaluate(*pair.truth, &r, &J);
  return J.transpose() * J;
}

// True if `noise` is a small share of `information` in each direction of the basis.
bool IsSmall(const Matrix6d& noise, const Matrix6d& information, const MotionBasis& basis) {
  constexpr double kMaxShare = 0.25;  // the square of it, which is left out, is a sixteenth
  const Eigen::MatrixXd whole = basis.transpose() * information * basis;
  const Eigen::MatrixXd rest =
      kMaxShare * whole - Eigen::MatrixXd(basis.transpose() * noise * basis);
  const Eigen::VectorXd scale = whole.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> positive(scale.asDiagonal() * rest * scale.asDiagonal());
  return positive.info() == Eigen::Success;
}

}  // namespace

std::optional<CramerRaoBound> ComputeCramerRaoBound(const RefineOptions& options,
                                                    const FramePair& pair) {
  std::string error;
  if (!pair.truth.has_value() || !pair.noise_px.has_value() || !pair.IsValid(&error)) {
    return std::nullopt;
  }
  const bool prior_exact =
      options.form == RefineForm::kPrior || options.form == RefineForm::kPriorDepths;
  Alignment alignment;
  if (prior_exact && !MakeAlignment(pair.prior, options.prior_kind, &alignment, &error)) {
    return std::nullopt;
  }
  const auto free_directions = [&](const Pose& pose, bool length_free) {
    return prior_exact ? PriorBasis(pose, alignment, length_free) : FullBasis(pose, length_free);
  };

  const Eigen::Vector3d centre = RigCentre(pair.rig);
  const Pose truth = MotionOfPoint(*pair.truth, centre);
  const Matrix6d to_body = BodyFromPointJacobian(truth.R, centre);
  MatchInformation of_matches;
  if (!SumInliers(pair, centre, truth, &of_matches)) return std::nullopt;
  Matrix6d information =
      of_matches.sum + to_body.transpose() * StatedInformation(options, pair) * to_body;
  const Matrix6d without_length = information - of_matches.noise;
  MotionBasis basis;
  if (options.hold_distance) {
    // |t| is that of the body.
    basis = BodyFromPointJacobian(truth.R, -centre) * free_directions(*pair.truth, false);
  } else {
    basis = free_directions(truth, true);
    const double length = truth.t.norm();
    if (length > 0) {
      const Eigen::Vector3d log_length = truth.t / (length * length * kLengthSigma);
      information.block<3, 3>(3, 3) += log_length * log_length.transpose();
    }
  }
  if (!IsSmall(of_matches.noise, information, basis)) return std::nullopt;
  Matrix6d covariance;
  if (!CovarianceOfBasis(information - of_matches.noise, basis, &covariance)) return std::nullopt;

  CramerRaoBound bound;
  bound.relative_scale = RelativeScaleSigma(without_length, truth);
  bound.rig_direction = DirectionSigma(covariance, truth.t);
  bound.covariance = to_body * covariance * to_body.transpose();
  bound.rotation = RotationSigma(bound.covariance);
  bound.direction = DirectionSigma(bound.covariance, pair.truth->t);
  return bound;
}

}  // namespace rigel
