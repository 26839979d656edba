#include "rigel/refine/least_squares/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "rigel/core/angles.h"
#include "rigel/refine/least_squares/normal_equations.h"

namespace rigel {

namespace {

// Smallest eigenvalue of an information matrix with a unit diagonal. With pixel coordinates of some
// hundred, rounding makes less than this of a zero.
constexpr double kMinEigenvalue = 1e-11;

}  // namespace

Matrix6d SampsonInformation(const GroupedMatches& matches, const std::vector<double>& weights,
                            const Pose& pose) {
  MotionNormalEquations sum;
  for (const MatchGroup& group : matches.groups()) {
    AddNormalEquations(SampsonKernelOptions(), matches, group, matches.Rows(group),
                       weights.data() + group.begin, pose, SampsonParts::kAll, &sum);
  }
  return sum.curvature;
}

void EpipoleWeights(const GroupedMatches& matches, const Pose& pose, double noise_px,
                    std::vector<double>* weights) {
  const double noise2 = kEpipoleSigmas * kEpipoleSigmas * noise_px * noise_px;
  weights->resize(matches.size());
  for (const MatchGroup& group : matches.groups()) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = matches.Fundamental(group, pose);
    GradientWeights(matches.Rows(group), F.data(), noise2, weights->data() + group.begin);
  }
}

bool CovarianceOfBasis(const Matrix6d& information, const MotionBasis& basis,
                       Matrix6d* covariance) {
  const int k = static_cast<int>(basis.cols());
  if (k == 0 || !information.allFinite()) return false;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
  const Square reduced = basis.transpose() * information * basis;
  // Radians and metres differ in size: scale the diagonal to one before the rank is decided.
  const Eigen::VectorXd diagonal = reduced.diagonal();
  if (!(diagonal.minCoeff() > 0)) return false;
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Square scaled = scale.asDiagonal() * reduced * scale.asDiagonal();
  Square root;  // of the inverse: inverse = root' root
  const Eigen::LLT<Square> llt(scaled);
  if (llt.info() == Eigen::Success) {
    root = Square::Identity(k, k);
    llt.matrixL().solveInPlace(root);
  }
  // The trace of the inverse bounds its largest eigenvalue.
  if (llt.info() != Eigen::Success || !(root.squaredNorm() * kMinEigenvalue < 1.0)) {
    const Eigen::SelfAdjointEigenSolver<Square> eigen(scaled);
    if (!(eigen.eigenvalues()(0) > kMinEigenvalue)) return false;
    root = eigen.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal() *
           eigen.eigenvectors().transpose();
  }
  const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, 6, 6> whole_root =
      root * scale.asDiagonal() * basis.transpose();
  *covariance = whole_root.transpose() * whole_root;
  return true;
}

MotionBasis FullBasis(const Pose& pose, bool scale_free) {
  MotionBasis basis;
  if (scale_free) {
    basis.setIdentity(6, 6);
    return basis;
  }
  basis.setZero(6, 5);
  basis.block<3, 3>(0, 0).setIdentity();
  const double norm = pose.t.norm();
  const Eigen::Vector3d direction =
      norm > 0 ? Eigen::Vector3d(pose.t / norm) : Eigen::Vector3d::UnitZ();
  basis.block<3, 2>(3, 3) = TangentBasis(direction);
  return basis;
}

MotionBasis PriorBasis(const Pose& pose, const Alignment& alignment, bool scale_free) {
  const Eigen::Vector3d axis = alignment.AxisInFrame2();
  const double norm = pose.t.norm();
  const Eigen::Vector3d direction =
      norm > 0 ? Eigen::Vector3d(pose.t / norm) : Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3> t_basis;
  if (alignment.kind == PriorKind::kPlanar) {
    if (scale_free) {
      t_basis = TangentBasis(axis);
    } else {
      t_basis = axis.cross(direction);
    }
  } else if (scale_free) {
    t_basis = Eigen::Matrix3d::Identity();
  } else {
    t_basis = TangentBasis(direction);
  }
  MotionBasis basis;
  basis.setZero(6, 1 + t_basis.cols());
  basis.block<3, 1>(0, 0) = axis;
  basis.block(3, 1, 3, t_basis.cols()) = t_basis;
  return basis;
}

double RelativeScaleSigma(const Matrix6d& information, const Pose& pose) {
  const double norm = pose.t.norm();
  if (!(norm > 0)) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d direction = pose.t / norm;
  Matrix6d covariance;
  if (!CovarianceOfBasis(information, FullBasis(pose, true), &covariance)) {
    return std::numeric_limits<double>::infinity();
  }
  return std::sqrt(direction.dot(covariance.block<3, 3>(3, 3) * direction)) / norm;
}

double RotationSigma(const Matrix6d& covariance) {
  return std::sqrt(covariance.block<3, 3>(0, 0).trace());
}

double DirectionSigma(const Matrix6d& covariance, const Eigen::Vector3d& t) {
  const double norm = t.norm();
  if (!(norm > 0)) return std::numeric_limits<double>::infinity();
  const Eigen::Matrix<double, 3, 2> across = TangentBasis(t / norm);
  return std::sqrt((across.transpose() * covariance.block<3, 3>(3, 3) * across).trace()) / norm;
}

std::string WeakestDirection(const Matrix6d& covariance, const Eigen::Vector3d& t) {
  const double norm = t.norm();
  if (!(norm > 0) || !covariance.allFinite()) return "";
  Eigen::Matrix<double, 6, 1> unit;
  unit << 1, 1, 1, norm, norm, norm;
  const Matrix6d relative = unit.cwiseInverse().asDiagonal() * covariance *
                            unit.cwiseInverse().asDiagonal().toDenseMatrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(relative);
  Eigen::Matrix<double, 6, 1> weakest =
      unit.cwiseProduct(eigen.eigenvectors().col(5)) * std::sqrt(eigen.eigenvalues()(5));
  // The sign is arbitrary: the largest component of t is made positive.
  int largest = 3;
  for (int k = 4; k < 6; ++k) {
    if (std::abs(weakest(k)) > std::abs(weakest(largest))) largest = k;
  }
  if (weakest(largest) < 0) weakest = -weakest;
  const Eigen::Vector3d turn = weakest.head<3>();
  const Eigen::Vector3d shift = weakest.tail<3>();
  const auto axis = [](const Eigen::Vector3d& v) {
    const Eigen::Vector3d u = v.norm() > 0 ? Eigen::Vector3d(v.normalized()) : v;
    char text[64];
    // No "-0.0".
    std::snprintf(text, sizeof(text), "(%.1f, %.1f, %.1f)", std::round(10 * u.x()) / 10 + 0.0,
                  std::round(10 * u.y()) / 10 + 0.0, std::round(10 * u.z()) / 10 + 0.0);
    return std::string(text);
  };
  char text[192];
  std::snprintf(text, sizeof(text), "turn by %.3g deg about %s with t by %.3g m along %s",
                RadToDeg(turn.norm()), axis(turn).c_str(), shift.norm(), axis(shift).c_str());
  return text;
}

namespace {

// Appends the squares of `factor` times the parallax in pixels, of the group's matches in the mask.
void AppendSquaredParallaxPx(const GroupedMatches& matches, const MatchGroup& group,
                             const std::vector<char>& mask, const Pose& pose, double factor,
                             std::vector<double>* squares) {
  const Pixel scale = matches.rig().cameras[group.camera2].intrinsics.PixelsPerRadian();
  const double pixels = factor * 0.5 * (scale.x() + scale.y());
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = pose.R;
  size_t end = squares->size();
  squares->resize(end + group.size);
  double* sin2 = squares->data() + end;
  SquaredParallax(matches.Directions(group), R.data(), group.size, sin2);
  for (int k = 0; k < group.size; ++k) {
    (*squares)[end] = pixels * pixels * sin2[k];
    end += mask[group.begin + k] != 0 ? 1 : 0;
  }
  squares->resize(end);
}

}  // namespace

double ParallaxPercentilePx(const GroupedMatches& matches, const std::vector<char>& mask,
                            const Pose& pose) {
  std::vector<double> squares;
  for (const MatchGroup& group : matches.groups()) {
    if (group.camera1 != group.camera2) continue;
    const Eigen::Vector3d& s = matches.rig().cameras[group.camera1].s;
    const double arm = (pose.R * s - s).norm();
    const double share = pose.t.norm() > 0 ? pose.t.norm() / (pose.t.norm() + arm) : 0.0;
    AppendSquaredParallaxPx(matches, group, mask, pose, share, &squares);
  }
  if (squares.empty()) return std::numeric_limits<double>::infinity();
  const auto nth = squares.begin() + static_cast<long>(squares.size() * 4 / 5);
  std::nth_element(squares.begin(), nth, squares.end());
  return std::sqrt(*nth);
}

}  // namespace rigel
