#include "rigel/refine/fit_information.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "rigel/refine/least_squares/calibration_equations.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/noise_information.h"
#include "rigel/refine/least_squares/normal_equations.h"
#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {
namespace {

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

// v of a camera pair is that of all with the weight of so many matches.
constexpr double kPooledWeight = 30.0;

// D is a mean of slowly varying terms: so many matches give it to some percent. A third of a
// microsecond each.
constexpr int kNoiseSample = 60;
constexpr int kMinSampled = 15;

// Sums over inliers.
struct LossSums {
  double n = 0.0;
  double squares = 0.0;  // of psi^2
};

double Psi(const FittedInliers& fit, double z) {
  return z * LossWeight(fit.loss, fit.loss_scale_sigmas, z);
}

LossSums SumLoss(const FittedInliers& fit, const MatchGroup& group, const MatchErrors& errors,
                 double sigma) {
  LossSums sums;
  for (int k = group.begin; k < group.begin + group.size; ++k) {
    if (!(fit.factors[k] > 0)) continue;
    const double psi = Psi(fit, std::sqrt(errors.squared[k]) / sigma);
    sums.n += 1.0;
    sums.squares += psi * psi;
  }
  return sums;
}

// Cost and gradient at `pose`, or the cost alone.
MotionNormalEquations CostAt(const FittedInliers& fit, const GroupedMatches& matches,
                             const NoiseModel& noise, const Pose& pose, SampsonParts parts) {
  MotionNormalEquations sum;
  for (size_t g = 0; g < matches.groups().size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    AddRobustEquations(fit.loss, fit.loss_scale_sigmas, noise.sigma_of[g], matches, group,
                       fit.factors.data() + group.begin, pose, parts, &sum);
  }
  return sum;
}

// The curvature of the cost: differences of its gradient. It has the second derivatives of the
// errors and the slope of the loss in it, for outliers too.
Matrix6d CurvatureAt(const FittedInliers& fit, const GroupedMatches& matches,
                     const NoiseModel& noise, const Pose& pose) {
  constexpr double kStep = 1e-6;  // radians, and a fraction of |t|
  const auto gradient_at = [&](const Pose& at) {
    return CostAt(fit, matches, noise, at, SampsonParts::kGradient).gradient;
  };
  const Vector6d gradient = gradient_at(pose);
  Matrix6d curvature;
  for (int k = 0; k < 6; ++k) {
    const double step = k < 3 ? kStep : kStep * pose.t.norm();
    const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(k % 3);
    Pose moved = pose;
    if (k < 3) {
      moved.R = ExpSO3(shift) * pose.R;
    } else {
      moved.t += shift;
    }
    curvature.col(k) = (gradient_at(moved) - gradient) / step;
  }
  return 0.5 * (curvature + curvature.transpose());
}

// One row of the Jacobian times its weight, the factor of the match over sigma.
struct WeightedRow {
  double residual = 0.0;  // over sigma
  Vector6d by_motion = Vector6d::Zero();
  UnalignedMatrix<4> gradient = UnalignedMatrix<4>::Zero();  // by the pixels, without the weight
};

// Rows of inliers, by whole sets of matches that share pixels; zero for other matches. So many rows
// give the scatter to some percent; of more inliers every second set is taken, or every third, ...
class WeightedRows {
 public:
  static constexpr int kSample = 600;

  WeightedRows(const FittedInliers& fit, const GroupedMatches& matches,
               const std::vector<GroupLinearization>& linear, const NoiseModel& noise)
      : set_of_(LinkedSets(fit.shared, matches.size())),
        rows_(matches.size()),
        group_of_(matches.size()) {
    const auto num_inliers =
        matches.size() - std::count(fit.factors.begin(), fit.factors.end(), 0.0);
    const long stride = std::max<long>(1, num_inliers / kSample);
    std::vector<char> is_taken(matches.size(), 0);  // of the first match of a set
    long num_sets = 0, num_rows = 0;
    SampsonRow row;
    for (size_t g = 0; g < matches.groups().size(); ++g) {
      const MatchGroup& group = matches.groups()[g];
      for (int i = 0; i < group.size; ++i) {
        const int k = group.begin + i;
        group_of_[k] = static_cast<int>(g);
        if (set_of_[k] == k) is_taken[k] = num_sets++ % stride == 0 ? 1 : 0;
        if (!is_taken[set_of_[k]] || !(fit.factors[k] > 0)) continue;
        ++num_rows;
        if (!DifferentiateSampsonOnce(linear[g], matches.Point1(k), matches.Point2(k), &row)) {
          continue;
        }
        const double weight = fit.factors[k] / noise.sigma_of[g];
        rows_[k] = {row.residual / noise.sigma_of[g], weight * row.by_motion, row.gradient};
      }
    }
    if (num_rows > 0) of_sample_ = num_inliers / static_cast<double>(num_rows);
  }

  // What correlations add to the variance of the score: v (j k' + k j') rho for rows j and k that
  // share a pixel, rho = dr_j/dp . dr_k/dp over that pixel.
  Matrix6d SharedScatter(const std::vector<SharedPixel>& shared,
                         const std::vector<double>& v) const {
    Matrix6d sum = Matrix6d::Zero();
    for (const SharedPixel& pair : shared) {
      const WeightedRow& j = rows_[pair.first];
      const WeightedRow& k = rows_[pair.second];
      const int begin = pair.at_time2 ? 2 : 0;
      const double correlation = j.gradient.segment<2>(begin).dot(k.gradient.segment<2>(begin)) *
                                 std::sqrt(v[group_of_[pair.first]] * v[group_of_[pair.second]]);
      if (correlation != 0.0) {
        sum += (correlation * j.by_motion).lazyProduct(k.by_motion.transpose());
      }
    }
    return of_sample_ * (sum + sum.transpose());
  }

  // The same variance as it was measured: the sum of s s' over sets of matches that share pixels, s
  // the sum of their scores. A residual of leverage h has 1 - h of its variance left.
  Matrix6d MeasuredScatter(const FittedInliers& fit, const Matrix6d& covariance) const {
    constexpr double kMaxLeverage = 0.99;
    std::vector<Vector6d> scores(rows_.size(), Vector6d::Zero());
    for (size_t k = 0; k < rows_.size(); ++k) {
      const Vector6d& row = rows_[k].by_motion;
      if (row.isZero(0.0)) continue;
      const double leverage = std::min(row.dot(covariance.lazyProduct(row)), kMaxLeverage);
      scores[set_of_[k]] += Psi(fit, rows_[k].residual) / std::sqrt(1.0 - leverage) * row;
    }
    Matrix6d sum = Matrix6d::Zero();
    for (const Vector6d& score : scores) {
      if (!score.isZero(0.0)) sum += score.lazyProduct(score.transpose());
    }
    return of_sample_ * sum;
  }

 private:
  std::vector<int> set_of_;
  std::vector<WeightedRow> rows_;
  std::vector<int> group_of_;
  double of_sample_ = 1.0;  // all inliers over those that were taken
};

// The scatter of the model has the right shape, and the measured one the right size, for noise that
// is of another kind: errors that are alike in both cameras, or larger for near points. Half is
// q times the model, where q is the mean ratio of the two, half is what was measured. With few
// matches the model counts more.
Matrix6d Blend(const Matrix6d& model, const Matrix6d& measured, double num_inliers) {
  constexpr double kModelWeight = 300.0;  // matches
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> ldlt(model);
  const Eigen::Matrix<double, 6, 6> ratio = ldlt.solve(Eigen::Matrix<double, 6, 6>(measured));
  const double q = ratio.trace() / 6.0;
  if (!std::isfinite(q) || !(q > 0)) return model;
  const double share = num_inliers / (num_inliers + kModelWeight);
  return (1.0 - share + 0.5 * share * q) * model + 0.5 * share * measured;
}

void AddCalibration(const FittedInliers& fit, const GroupedMatches& matches,
                    const NoiseModel& noise, const Pose& pose, FitInformation* information) {
  const std::vector<RigCamera>& cameras = matches.rig().cameras;
  if (!StatesCalibrationErrors(matches.rig())) return;
  CalibrationDerivatives& by_calibration = information->by_calibration;
  by_calibration.setZero(6, kCameraErrors * matches.rig().size());
  for (size_t g = 0; g < matches.groups().size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    SampsonKernelOptions options;
    options.loss = fit.loss;
    options.loss_scale = fit.loss_scale_sigmas * noise.sigma_of[g];
    AddCalibrationDerivatives(options, matches, group, fit.factors.data() + group.begin, pose,
                              1.0 / (noise.sigma_of[g] * noise.sigma_of[g]), &by_calibration);
  }
  for (size_t k = 0; k < cameras.size(); ++k) {
    const auto X = by_calibration.middleCols<kCameraErrors>(static_cast<long>(k) * kCameraErrors);
    information->calibration += X * CalibrationVariances(cameras[k]).asDiagonal() * X.transpose();
  }
}

}  // namespace

FitInformation InformationOfFit(const FittedInliers& fit, const GroupedMatches& matches,
                                const MatchErrors& errors, const NoiseModel& noise,
                                const Pose& pose) {
  const size_t num_groups = matches.groups().size();
  std::vector<LossSums> sums(num_groups);
  LossSums all;
  for (size_t g = 0; g < num_groups; ++g) {
    sums[g] = SumLoss(fit, matches.groups()[g], errors, noise.sigma_of[g]);
    all.n += sums[g].n;
    all.squares += sums[g].squares;
  }
  // Residuals of a fit are smaller than the noise: n - p instead of n.
  const double redundancy = std::max(all.n - fit.num_parameters, 1.0);
  const double v_all = all.squares / redundancy;
  const MotionBasis basis = FullBasis(pose, true);
  std::vector<GroupLinearization> linear;
  LinearizeGroups(matches, ResidualKind::kSampson, pose, &basis, &linear);
  FitInformation information;
  std::vector<double> v_of(num_groups, 1.0);
  for (size_t g = 0; g < num_groups; ++g) {
    if (!(sums[g].n > 0)) continue;
    const MatchGroup& group = matches.groups()[g];
    const double* factors = fit.factors.data() + group.begin;
    if (!fit.noise_is_given) {
      v_of[g] = (sums[g].squares * all.n / redundancy + kPooledWeight * v_all) /
                (sums[g].n + kPooledWeight);
    }
    MotionNormalEquations equations;
    AddNormalEquations(SampsonKernelOptions(), matches, group, matches.Rows(group), factors, pose,
                       SampsonParts::kAll, &equations);
    const Matrix6d H = equations.curvature / (noise.sigma_of[g] * noise.sigma_of[g]);
    information.observed += H;
    information.scatter += v_of[g] * H;
    information.noise +=
        NoiseInformation(linear[g], matches, group, factors,
                         std::max(kMinSampled, kNoiseSample * group.size / matches.size()));
  }
  // With a given noise and no shared pixel the scatter is known.
  if (!fit.noise_is_given || !fit.shared.empty()) {
    const WeightedRows rows(fit, matches, linear, noise);
    information.scatter += rows.SharedScatter(fit.shared, v_of);
    Matrix6d covariance;
    if (!fit.noise_is_given && CovarianceOfBasis(information.observed, basis, &covariance)) {
      information.scatter =
          Blend(information.scatter, rows.MeasuredScatter(fit, covariance), all.n);
    }
  }
  information.curvature = fit.is_minimum && !fit.noise_is_given
                              ? CurvatureAt(fit, matches, noise, pose)
                              : Matrix6d(information.observed - information.noise);
  AddCalibration(fit, matches, noise, pose, &information);
  information.psi2_of = v_of;
  return information;
}

namespace {

// Eigenvalues of `part` against `whole` within the basis, ascending. False if `whole` is singular
// there.
bool CompareWithin(const MotionBasis& basis, const Matrix6d& part, const Matrix6d& whole,
                   Eigen::GeneralizedSelfAdjointEigenSolver<Square>* eigen) {
  Matrix6d unused;
  if (!CovarianceOfBasis(whole, basis, &unused)) return false;
  eigen->compute(basis.transpose() * part * basis, basis.transpose() * whole * basis);
  return eigen->info() == Eigen::Success && eigen->eigenvalues().allFinite();
}

}  // namespace

bool InverseCurvature(const FitInformation& information, const Matrix6d& prior,
                      const MotionBasis& basis, double min_share, Matrix6d* inverse) {
  // W'(observed) W = I and W' S W = diag(shares).
  Eigen::GeneralizedSelfAdjointEigenSolver<Square> eigen;
  if (!CompareWithin(basis, information.curvature + prior, information.observed + prior, &eigen)) {
    return false;
  }
  const Square W = basis * eigen.eigenvectors();
  const Square shares =
      eigen.eigenvalues().cwiseMax(min_share).cwiseMin(1.0).cwiseInverse().asDiagonal();
  *inverse = W * shares * W.transpose();
  return inverse->allFinite();
}

FitCovariance CovarianceOfFit(const FitInformation& information, const Matrix6d& prior,
                              const Matrix6d& inverse) {
  return {inverse * (information.scatter + prior) * inverse,
          inverse * information.calibration * inverse};
}

CostRise RiseOfCost(const FittedInliers& fit, const GroupedMatches& matches,
                    const NoiseModel& noise, const Pose& pose, const Matrix6d& S) {
  constexpr int kDirections = 2;
  constexpr double kSigmas = 3.0;
  constexpr double kLeast = 0.1;  // a valley is taken as no wider than this says
  CostRise result;
  const MotionBasis basis = FullBasis(pose, false);
  const double length = pose.t.norm();
  // A turn by an angle and a motion by that share of |t| count alike.
  Vector6d unit;
  unit << 1, 1, 1, length, length, length;
  const Square B = unit.cwiseInverse().asDiagonal() * basis;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Square> eigen(
      Square(basis.transpose() * S * basis), Square(B.transpose() * B));
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()(0) > 0)) return result;
  const auto cost_at = [&](const Pose& at) {
    return CostAt(fit, matches, noise, at, SampsonParts::kCost).cost;
  };
  const double here = cost_at(pose);
  for (int k = 0; k < kDirections; ++k) {
    const Vector6d sd = basis * eigen.eigenvectors().col(k) / std::sqrt(eigen.eigenvalues()(k));
    double rise = 1.0;
    for (const double step : {kSigmas, -kSigmas}) {
      const Pose moved = {ExpSO3(step * sd.head<3>()) * pose.R, pose.t + step * sd.tail<3>()};
      rise = std::min(rise, (cost_at(moved) - here) / (0.5 * step * step));
    }
    result.least = std::min(result.least, rise);
    result.widening += (1.0 / std::max(rise, kLeast) - 1.0) * sd * sd.transpose();
  }
  return result;
}

double TrueInformation(const FitInformation& information, const Matrix6d& prior,
                       const MotionBasis& basis) {
  Eigen::GeneralizedSelfAdjointEigenSolver<Square> eigen;
  const Matrix6d whole = information.observed + prior;
  return CompareWithin(basis, whole - information.noise, whole, &eigen) ? eigen.eigenvalues()(0)
                                                                        : 0.0;
}

}  // namespace rigel
