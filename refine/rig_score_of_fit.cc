#include "rigel/refine/rig_score_of_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "rigel/refine/determined_turns.h"
#include "rigel/refine/least_squares/calibration_equations.h"
#include "rigel/refine/least_squares/fundamental_derivatives.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/noise_information.h"
#include "rigel/refine/least_squares/normal_equations.h"
#include "rigel/refine/least_squares/sampson_kernel.h"

namespace rigel {
namespace {

// The inverse on the directions that have information, for any units. In the others a motion
// changes no residual, so that there is nothing to eliminate.
Matrix6d PseudoInverse(const Matrix6d& information) {
  constexpr double kLeast = 1e-9;
  const Vector6d scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 6, 6> scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(scaled);
  Vector6d inverse = Vector6d::Zero();
  for (int k = 0; k < 6; ++k) {
    if (eigen.eigenvalues()(k) > kLeast) inverse(k) = 1.0 / eigen.eigenvalues()(k);
  }
  const Eigen::Matrix<double, 6, 6> W = scale.asDiagonal() * eigen.eigenvectors();
  return W * inverse.asDiagonal() * W.transpose();
}

// The sums over the inliers of a camera pair, over sigma^2, with the derivatives of F: by the
// motion, and by the turns of the two cameras in their own frames.
struct GroupSums {
  RowMajor3d F;
  Eigen::Matrix<double, 9, 1> gradient;
  Eigen::Matrix<double, 9, 9> curvature, scatter;
  ByMotionMatrix by_motion;
  ByCalibrationMatrix by_calibration;
  Eigen::Matrix<double, 9, 6> by_turns;
};

GroupSums SumGroup(const FittedInliers& fit, const GroupedMatches& matches, size_t g, double sigma,
                   const Pose& pose) {
  const MatchGroup& group = matches.groups()[g];
  const RowMajor3d F = matches.Fundamental(group, pose);
  const double* weights = fit.factors.data() + group.begin;
  SampsonKernelOptions robust;
  robust.loss = fit.loss;
  robust.loss_scale = fit.loss_scale_sigmas * sigma;
  SampsonSums sums, plain;
  SumSampson(robust, matches.Rows(group), weights, F.data(), Rounding2(F), SampsonParts::kAll,
             &sums);
  SumSampson(SampsonKernelOptions(), matches.Rows(group), weights, F.data(), Rounding2(F),
             SampsonParts::kAll, &plain);
  GroupSums result;
  result.F = F;
  const double information = 1.0 / (sigma * sigma);
  result.gradient = information * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(sums.g);
  result.curvature = information * Eigen::Map<const Eigen::Matrix<double, 9, 9>>(sums.H);
  result.scatter = information * Eigen::Map<const Eigen::Matrix<double, 9, 9>>(plain.H);
  result.by_motion = FundamentalByMotion(matches, group, pose, false);
  result.by_calibration = FundamentalByCalibration(matches, group, pose);
  const std::vector<RigCamera>& cameras = matches.rig().cameras;
  result.by_turns << result.by_calibration.leftCols<3>() * cameras[group.camera1].Q,
      result.by_calibration.middleCols<3>(kCameraErrors) * cameras[group.camera2].Q;
  return result;
}

// Rows for the entries of F column by column, from rows for them row by row.
Eigen::MatrixXd ByColumns(const Eigen::MatrixXd& by_rows) {
  Eigen::MatrixXd by_columns(9, by_rows.cols());
  for (int i = 0; i < 9; ++i) by_columns.row(i) = by_rows.row(3 * (i % 3) + i / 3);
  return by_columns;
}

// Where the turns of a camera are among those of the score; -1 for camera 0.
int ColumnOf(int camera) { return camera == 0 ? -1 : 3 * (camera - 1); }

class ScoreOfFit {
 public:
  ScoreOfFit(const FittedInliers& fit, const GroupedMatches& matches, const NoiseModel& noise,
             const Pose& pose)
      : fit_(fit), matches_(matches), noise_(noise), size_(3 * (matches.rig().size() - 1)) {
    const size_t num_groups = matches.groups().size();
    Matrix6d by_motion = Matrix6d::Zero();
    Eigen::MatrixXd by_both = Eigen::MatrixXd::Zero(6, size_);
    Vector6d gradient = Vector6d::Zero();
    for (size_t g = 0; g < num_groups; ++g) {
      sums_.push_back(SumGroup(fit, matches, g, noise.sigma_of[g], pose));
      const GroupSums& s = sums_.back();
      by_motion += s.by_motion.transpose() * s.curvature * s.by_motion;
      by_both += s.by_motion.transpose() * s.curvature * Turns(g);
      gradient += s.by_motion.transpose() * s.gradient;
    }
    covariance_ = PseudoInverse(by_motion);
    elimination_ = covariance_ * by_both;
  }

  RigScore Score(const std::vector<double>& psi2_of) const {
    RigScore score;
    score.num_pairs = 1;
    score.gradient.setZero(size_);
    score.information.setZero(size_, size_);
    Eigen::MatrixXd model = Eigen::MatrixXd::Zero(size_, size_);
    for (size_t g = 0; g < sums_.size(); ++g) {
      const Eigen::MatrixXd T = Projected(g);
      score.gradient += T.transpose() * sums_[g].gradient;
      score.information += T.transpose() * sums_[g].curvature * T;
      model += psi2_of[g] * (T.transpose() * sums_[g].scatter * T);
    }
    score.variance = model;
    AddCalibration(&score);
    return score;
  }

  double NumInliers() const {
    return static_cast<double>(
        std::count_if(fit_.factors.begin(), fit_.factors.end(), [](double f) { return f > 0; }));
  }

  // The variance of the gradient as it was measured: the sum of s s' over sets of matches that
  // share pixels, s the sum of their scores. A residual of leverage h has 1 - h of its variance
  // left.
  Eigen::MatrixXd MeasuredVariance() const;

 private:
  // So many rows give it to some percent; of more inliers every second set is taken, or every
  // third, ...
  static constexpr int kSample = 600;
  std::vector<char> TakeSets(const std::vector<int>& set_of) const;
  // The derivatives of F's entries of a camera pair by the turns of the score.
  Eigen::MatrixXd Turns(size_t g) const {
    Eigen::MatrixXd turns = Eigen::MatrixXd::Zero(9, size_);
    const MatchGroup& group = matches_.groups()[g];
    const int column1 = ColumnOf(group.camera1), column2 = ColumnOf(group.camera2);
    if (column1 >= 0) turns.middleCols<3>(column1) += sums_[g].by_turns.leftCols<3>();
    if (column2 >= 0) turns.middleCols<3>(column2) += sums_[g].by_turns.rightCols<3>();
    return turns;
  }
  // The same with the motion that follows them.
  Eigen::MatrixXd Projected(size_t g) const { return Turns(g) - sums_[g].by_motion * elimination_; }

  void AddCalibration(RigScore* score) const;

  const FittedInliers& fit_;
  const GroupedMatches& matches_;
  const NoiseModel& noise_;
  const long size_;
  std::vector<GroupSums> sums_;
  Matrix6d covariance_;          // of the motion
  Eigen::MatrixXd elimination_;  // how the motion follows the turns, with the other sign
};

void ScoreOfFit::AddCalibration(RigScore* score) const {
  const std::vector<RigCamera>& cameras = matches_.rig().cameras;
  if (!StatesCalibrationErrors(matches_.rig())) return;
  Eigen::MatrixXd& X = score->by_calibration;
  X.setZero(size_, kCameraErrors * matches_.rig().size());
  for (size_t g = 0; g < sums_.size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    const Eigen::MatrixXd of_pair =
        Projected(g).transpose() * sums_[g].curvature * sums_[g].by_calibration;
    X.middleCols<kCameraErrors>(kCameraErrors * group.camera1) += of_pair.leftCols<kCameraErrors>();
    X.middleCols<kCameraErrors>(kCameraErrors * group.camera2) +=
        of_pair.rightCols<kCameraErrors>();
  }
  for (size_t k = 0; k < cameras.size(); ++k) {
    const long begin = static_cast<long>(k) * kCameraErrors;
    X.middleCols<kCameraErrors>(begin) *= CalibrationVariances(cameras[k]).cwiseSqrt().asDiagonal();
  }
}

std::vector<char> ScoreOfFit::TakeSets(const std::vector<int>& set_of) const {
  const long stride = std::max<long>(1, static_cast<long>(NumInliers()) / kSample);
  std::vector<char> is_taken(set_of.size(), 0);
  long num_sets = 0;
  for (size_t k = 0; k < set_of.size(); ++k) {
    const size_t first = set_of[k];
    if (first == k) is_taken[k] = num_sets++ % stride == 0 ? 1 : 0;
    is_taken[k] = is_taken[first];
  }
  return is_taken;
}

Eigen::MatrixXd ScoreOfFit::MeasuredVariance() const {
  constexpr double kMaxLeverage = 0.99;
  const std::vector<int> set_of = LinkedSets(fit_.shared, matches_.size());
  const std::vector<char> is_taken = TakeSets(set_of);
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(size_, matches_.size());
  UnalignedMatrix<9> by_F;
  double residual = 0.0;
  int num_rows = 0;
  for (size_t g = 0; g < sums_.size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    GroupLinearization linear;
    linear.F = sums_[g].F;
    linear.rounding2 = Rounding2(linear.F);
    const Eigen::MatrixXd to_score = ByColumns(Projected(g)).transpose();
    const Eigen::Matrix<double, 6, 9> to_motion = ByColumns(sums_[g].by_motion).transpose();
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      if (!is_taken[k] || !(fit_.factors[k] > 0)) continue;
      ++num_rows;
      if (!DifferentiateByFundamental(linear, matches_.Point1(k), matches_.Point2(k), &residual,
                                      &by_F)) {
        continue;
      }
      const double weight = fit_.factors[k] / noise_.sigma_of[g];
      const Vector6d by_motion = weight * to_motion.lazyProduct(by_F);
      const double leverage =
          std::min(by_motion.dot(covariance_.lazyProduct(by_motion)), kMaxLeverage);
      const double z = weight * residual;
      const double psi = z * LossWeight(fit_.loss, fit_.loss_scale_sigmas, z);
      scores.col(set_of[k]) +=
          psi * weight / std::sqrt(1.0 - leverage) * to_score.lazyProduct(by_F);
    }
  }
  return NumInliers() / std::max(num_rows, 1) * (scores * scores.transpose());
}

}  // namespace

RigScore RigScoreOfFit(const FittedInliers& fit, const GroupedMatches& matches,
                       const NoiseModel& noise, const std::vector<double>& psi2_of,
                       const Pose& pose) {
  if (matches.rig().size() < 2) return {};
  const ScoreOfFit score(fit, matches, noise, pose);
  // The model has the right shape, and the measured variance the right size, for noise that is of
  // another kind: of many matches half is q times the model, half is what was measured. From so
  // many on the latter counts half of that: it makes p too large where the score is large.
  constexpr double kModelWeight = 1000.0;  // matches
  RigScore result = score.Score(psi2_of);
  const Eigen::MatrixXd measured = score.MeasuredVariance();
  const double q = MeanRatio(DeterminedTurns(result.information), measured, result.variance);
  const double num_inliers = score.NumInliers();
  const double share = num_inliers / (num_inliers + kModelWeight);
  result.variance = (1.0 - share + 0.5 * share * q) * result.variance + 0.5 * share * measured;
  return result.gradient.allFinite() && result.variance.allFinite() ? result : RigScore();
}

}  // namespace rigel
