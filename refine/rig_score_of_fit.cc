#include "rigel/refine/rig_score_of_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

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
  Eigen::Matrix<double, 9, 9> curvature;
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
  SampsonSums sums;
  SumSampson(robust, matches.Rows(group), weights, F.data(), Rounding2(F), SampsonParts::kAll,
             &sums);
  GroupSums result;
  result.F = F;
  const double information = 1.0 / (sigma * sigma);
  result.gradient = information * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(sums.g);
  result.curvature = information * Eigen::Map<const Eigen::Matrix<double, 9, 9>>(sums.H);
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

// What the rows of a sample of the inliers say.
struct Measured {
  // The variance of the gradient: the sum of s s' over sets of matches that share pixels, s the sum
  // of their scores. A residual of leverage h has 1 - h of its variance left.
  Eigen::MatrixXd variance;
  double slope = 1.0;  // the mean of psi'
};

class ScoreOfFit {
 public:
  ScoreOfFit(const FittedInliers& fit, const GroupedMatches& matches, const NoiseModel& noise,
             const Pose& pose);

  // `psi2_of` as in RigScoreOfFit().
  RigScore Score(const std::vector<double>& psi2_of) const;

 private:
  std::vector<int> SampledSets(int* num_sampled) const;
  Measured Measure() const;
  void AddCalibration(RigScore* score) const;

  const FittedInliers& fit_;
  const GroupedMatches& matches_;
  const NoiseModel& noise_;
  const long size_;
  const double num_inliers_;
  std::vector<GroupSums> sums_;
  // The derivatives of F's entries of each camera pair by the turns, with the motion that follows.
  std::vector<Eigen::MatrixXd> projected_;
  Matrix6d covariance_;  // of the motion
};

ScoreOfFit::ScoreOfFit(const FittedInliers& fit, const GroupedMatches& matches,
                       const NoiseModel& noise, const Pose& pose)
    : fit_(fit),
      matches_(matches),
      noise_(noise),
      size_(3 * (matches.rig().size() - 1)),
      num_inliers_(static_cast<double>(fit.factors.size()) -
                   static_cast<double>(std::count(fit.factors.begin(), fit.factors.end(), 0.0))) {
  Matrix6d by_motion = Matrix6d::Zero();
  Eigen::MatrixXd by_both = Eigen::MatrixXd::Zero(6, size_);
  for (size_t g = 0; g < matches.groups().size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    sums_.push_back(SumGroup(fit, matches, g, noise.sigma_of[g], pose));
    const GroupSums& s = sums_.back();
    const Eigen::Matrix<double, 6, 9> product = s.by_motion.transpose() * s.curvature;
    by_motion += product * s.by_motion;
    const Eigen::Matrix<double, 6, 6> by_turns = product * s.by_turns;
    Eigen::MatrixXd& turns = projected_.emplace_back(Eigen::MatrixXd::Zero(9, size_));
    for (const int side : {0, 1}) {
      const int camera = side == 0 ? group.camera1 : group.camera2;
      if (camera == 0) continue;
      const long column = 3 * (camera - 1);
      turns.middleCols<3>(column) += s.by_turns.middleCols<3>(3 * side);
      by_both.middleCols<3>(column) += by_turns.middleCols<3>(3 * side);
    }
  }
  covariance_ = PseudoInverse(by_motion);
  const Eigen::MatrixXd motion = covariance_ * by_both;
  for (size_t g = 0; g < sums_.size(); ++g) {
    projected_[g].noalias() -= sums_[g].by_motion * motion;
  }
}

RigScore ScoreOfFit::Score(const std::vector<double>& psi2_of) const {
  // The model has the right shape, and the measured variance the right size, for noise that is of
  // another kind: of many matches half is q times the model, half is what was measured. From so
  // many on the latter counts half of that: it makes p too large where the score is large.
  constexpr double kModelWeight = 1000.0;  // matches
  RigScore score;
  score.num_pairs = 1;
  score.gradient.setZero(size_);
  score.information.setZero(size_, size_);
  score.variance.setZero(size_, size_);
  for (size_t g = 0; g < sums_.size(); ++g) {
    const Eigen::MatrixXd& T = projected_[g];
    score.gradient += T.transpose().lazyProduct(sums_[g].gradient);
    const Eigen::MatrixXd weighted = sums_[g].curvature.lazyProduct(T);
    const Eigen::MatrixXd information = T.transpose().lazyProduct(weighted);
    score.information += information;
    score.variance += psi2_of[g] * information;
  }
  const Measured measured = Measure();
  // The curvature is the sum of psi' J'J, the variance that of psi^2 J'J.
  score.variance /= measured.slope;
  const double q = MeanRatio(measured.variance.diagonal(), score.variance.diagonal());
  const double share = num_inliers_ / (num_inliers_ + kModelWeight);
  score.variance *= 1.0 - share + 0.5 * share * q;
  score.variance += 0.5 * share * measured.variance;
  AddCalibration(&score);
  return score;
}

void ScoreOfFit::AddCalibration(RigScore* score) const {
  const std::vector<RigCamera>& cameras = matches_.rig().cameras;
  if (!StatesCalibrationErrors(matches_.rig())) return;
  Eigen::MatrixXd& X = score->by_calibration;
  X.setZero(size_, kCameraErrors * matches_.rig().size());
  for (size_t g = 0; g < sums_.size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    const Eigen::MatrixXd of_pair =
        projected_[g].transpose() * sums_[g].curvature * sums_[g].by_calibration;
    X.middleCols<kCameraErrors>(kCameraErrors * group.camera1) += of_pair.leftCols<kCameraErrors>();
    X.middleCols<kCameraErrors>(kCameraErrors * group.camera2) +=
        of_pair.rightCols<kCameraErrors>();
  }
  for (size_t k = 0; k < cameras.size(); ++k) {
    const long begin = static_cast<long>(k) * kCameraErrors;
    X.middleCols<kCameraErrors>(begin) *= CalibrationVariances(cameras[k]).cwiseSqrt().asDiagonal();
  }
}

// Of each match the number of its set in the sample; -1: not there. So many rows give the variance
// to a tenth; of more inliers every second set is taken, or every third, ...
std::vector<int> ScoreOfFit::SampledSets(int* num_sampled) const {
  constexpr int kSample = 100;
  const long stride = std::max<long>(1, static_cast<long>(num_inliers_) / kSample);
  std::vector<int> sets = LinkedSets(fit_.shared, matches_.size());
  long num_sets = 0;
  *num_sampled = 0;
  for (size_t k = 0; k < sets.size(); ++k) {
    const size_t first = sets[k];
    if (first == k) {
      sets[k] = num_sets++ % stride == 0 ? (*num_sampled)++ : -1;
    } else {
      sets[k] = sets[first];
    }
  }
  return sets;
}

Measured ScoreOfFit::Measure() const {
  constexpr double kMaxLeverage = 0.99;
  constexpr double kStep = 1e-4;  // sigmas
  const auto psi = [this](double z) {
    return z * LossWeight(fit_.loss, fit_.loss_scale_sigmas, z);
  };
  int num_sets = 0;
  const std::vector<int> set_of = SampledSets(&num_sets);
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(size_, num_sets);
  UnalignedMatrix<9> by_F;
  double residual = 0.0, slope = 0.0;
  int num_rows = 0;
  for (size_t g = 0; g < sums_.size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    GroupLinearization linear;
    linear.F = sums_[g].F;
    linear.rounding2 = Rounding2(linear.F);
    const Eigen::MatrixXd to_score = ByColumns(projected_[g]).transpose();
    const Eigen::Matrix<double, 6, 9> to_motion = ByColumns(sums_[g].by_motion).transpose();
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      if (set_of[k] < 0 || !(fit_.factors[k] > 0) ||
          !DifferentiateByFundamental(linear, matches_.Point1(k), matches_.Point2(k), &residual,
                                      &by_F)) {
        continue;
      }
      const double weight = fit_.factors[k] / noise_.sigma_of[g];
      const double z = weight * residual;
      const Vector6d by_motion = weight * to_motion.lazyProduct(by_F);
      const double leverage =
          std::min(by_motion.dot(covariance_.lazyProduct(by_motion)), kMaxLeverage);
      scores.col(set_of[k]) +=
          psi(z) * weight / std::sqrt(1.0 - leverage) * to_score.lazyProduct(by_F);
      slope += (psi(z + kStep) - psi(z - kStep)) / (2.0 * kStep);
      ++num_rows;
    }
  }
  Measured measured;
  measured.variance = scores * scores.transpose();
  if (num_rows > 0) {
    measured.variance *= num_inliers_ / num_rows;
    if (slope > 0) measured.slope = slope / num_rows;
  }
  return measured;
}

}  // namespace

RigScore RigScoreOfFit(const FittedInliers& fit, const GroupedMatches& matches,
                       const NoiseModel& noise, const std::vector<double>& psi2_of,
                       const Pose& pose) {
  if (matches.rig().size() < 2) return {};
  RigScore result = ScoreOfFit(fit, matches, noise, pose).Score(psi2_of);
  return result.gradient.allFinite() && result.variance.allFinite() ? result : RigScore();
}

double MeanRatio(const Eigen::VectorXd& measured, const Eigen::VectorXd& model) {
  double sum = 0.0;
  int count = 0;
  for (long k = 0; k < model.size(); ++k) {
    if (!(model(k) > 0)) continue;
    sum += measured(k) / model(k);
    ++count;
  }
  return count > 0 && std::isfinite(sum) ? sum / count : 1.0;
}

}  // namespace rigel
