#include "rigel/refine/between_factor.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "rigel/core/rig_centre.h"

namespace rigel {
namespace {

// An eigenvalue below this share of the largest is zero up to rounding.
constexpr double kRankTolerance = 1e-12;

Matrix6d Symmetric(const Matrix6d& m) { return 0.5 * (m + m.transpose()); }

// `inverse` is the inverse of `jacobian`.
BetweenFactor Convert(const Pose& f2_from_f1, const Matrix6d& jacobian, const Matrix6d& inverse,
                      const Matrix6d& covariance, const Matrix6d& information) {
  BetweenFactor factor;
  factor.measurement = f2_from_f1.Inverse();
  factor.covariance = Symmetric(jacobian * covariance * jacobian.transpose());
  factor.information = Symmetric(inverse.transpose() * information * inverse);
  return factor;
}

// Written out term by term, so that zeros stay exactly zero.
Matrix6d InverseGtsamJacobian(const Pose& f2_from_f1) {
  Matrix6d inverse = -Matrix6d::Identity();
  inverse.block<3, 3>(3, 0) = Skew(f2_from_f1.t);
  return inverse;
}

Matrix6d InverseG2oJacobian(const Pose& f2_from_f1) {
  const Matrix6d gtsam = InverseGtsamJacobian(f2_from_f1);
  Matrix6d inverse;
  inverse.leftCols<3>() = gtsam.rightCols<3>();
  inverse.rightCols<3>() = 2.0 * gtsam.leftCols<3>();
  return inverse;
}

BetweenFactor ToGtsam(const Pose& f2_from_f1, const Matrix6d& covariance,
                      const Matrix6d& information) {
  return Convert(f2_from_f1, GtsamJacobian(f2_from_f1), InverseGtsamJacobian(f2_from_f1),
                 covariance, information);
}

BetweenFactor ToG2o(const Pose& f2_from_f1, const Matrix6d& covariance,
                    const Matrix6d& information) {
  return Convert(f2_from_f1, G2oJacobian(f2_from_f1), InverseG2oJacobian(f2_from_f1), covariance,
                 information);
}

// The marginal information without the translation along `t`: exactly zero in that direction.
Matrix6d InformationWithout(const Eigen::Vector3d& t, const Matrix6d& covariance) {
  const double norm = t.norm();
  if (!(norm > 0)) return PseudoInformation(covariance);
  Eigen::Matrix<double, 6, 1> along = Eigen::Matrix<double, 6, 1>::Zero();
  along.tail<3>() = t / norm;
  const Matrix6d others = Matrix6d::Identity() - along * along.transpose();
  return Symmetric(others * PseudoInformation(others * covariance * others) * others);
}

}  // namespace

Matrix6d GtsamJacobian(const Pose& f2_from_f1) {
  // T M' = (Exp(-d), t - Exp(-d) (t + e)) for M' = (Exp(d) R, t + e)^-1.
  Matrix6d jacobian = -Matrix6d::Identity();
  jacobian.block<3, 3>(3, 0) = -Skew(f2_from_f1.t);
  return jacobian;
}

Matrix6d G2oJacobian(const Pose& f2_from_f1) {
  const Matrix6d gtsam = GtsamJacobian(f2_from_f1);
  Matrix6d jacobian;
  jacobian.topRows<3>() = gtsam.bottomRows<3>();
  jacobian.bottomRows<3>() = 0.5 * gtsam.topRows<3>();
  return jacobian;
}

Matrix6d PseudoInformation(const Matrix6d& covariance) {
  if (!covariance.allFinite()) return Matrix6d::Zero();
  Eigen::Matrix<double, 6, 1> scale = Eigen::Matrix<double, 6, 1>::Ones();
  for (const int block : {0, 3}) {
    const double trace = covariance.block<3, 3>(block, block).trace();
    if (trace > 0) scale.segment<3>(block).setConstant(1.0 / std::sqrt(trace));
  }
  const Matrix6d scaled = scale.asDiagonal() * Symmetric(covariance) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(scaled);
  const double smallest = kRankTolerance * eigen.eigenvalues()(5);
  Matrix6d inverse = Matrix6d::Zero();
  for (int k = 0; k < 6; ++k) {
    const double variance = eigen.eigenvalues()(k);
    if (!(variance > smallest)) continue;
    const auto direction = eigen.eigenvectors().col(k);
    inverse += direction * direction.transpose() / variance;
  }
  const Matrix6d information = scale.asDiagonal() * inverse * scale.asDiagonal();
  return information.allFinite() ? information : Matrix6d(Matrix6d::Zero());
}

Matrix6d CovarianceOfEdge(const RefineSummary& summary) {
  if (!summary.covariance) return Matrix6d::Zero();
  return summary.calibration_covariance
             ? Matrix6d(*summary.covariance - *summary.calibration_covariance)
             : *summary.covariance;
}

Matrix6d InformationMatrix(const RefineSummary& summary, const Pose& f2_from_f1) {
  if (!summary.IsSolutionUsable() || !summary.covariance || !summary.rotation_observable) {
    return Matrix6d::Zero();
  }
  const Matrix6d of_body = CovarianceOfEdge(summary);
  if (summary.stands) return PseudoInformation(of_body);
  if (!summary.RigDirectionKnown()) {
    Matrix6d covariance = of_body;
    covariance.bottomRows<3>().setZero();
    covariance.rightCols<3>().setZero();
    return PseudoInformation(covariance);
  }
  if (summary.length_held) return InformationWithout(f2_from_f1.t, of_body);
  // Of the rig's own motion: where nothing says its length, that has no information.
  const Eigen::Vector3d& point = summary.rig_center;
  const Matrix6d from_body = BodyFromPointJacobian(f2_from_f1.R, -point);
  const Matrix6d of_rig = summary.rig_covariance && !summary.calibration_covariance
                              ? *summary.rig_covariance
                              : Matrix6d(from_body * of_body * from_body.transpose());
  const Matrix6d information = summary.length_sigma <= kMaxLengthSigma
                                   ? PseudoInformation(of_rig)
                                   : InformationWithout(MotionOfPoint(f2_from_f1, point).t, of_rig);
  return Symmetric(from_body.transpose() * information * from_body);
}

BetweenFactor GtsamBetweenFactor(const Pose& f2_from_f1, const Matrix6d& covariance) {
  return ToGtsam(f2_from_f1, covariance, PseudoInformation(covariance));
}

BetweenFactor G2oEdge(const Pose& f2_from_f1, const Matrix6d& covariance) {
  return ToG2o(f2_from_f1, covariance, PseudoInformation(covariance));
}

BetweenFactor GtsamBetweenFactor(const Pose& f2_from_f1, const RefineSummary& summary) {
  return ToGtsam(f2_from_f1, CovarianceOfEdge(summary), InformationMatrix(summary, f2_from_f1));
}

BetweenFactor G2oEdge(const Pose& f2_from_f1, const RefineSummary& summary) {
  return ToG2o(f2_from_f1, CovarianceOfEdge(summary), InformationMatrix(summary, f2_from_f1));
}

void SetUndeterminedLength(double length, Pose* f2_from_f1, RefineSummary* summary) {
  const Eigen::Vector3d& point = summary->rig_center;
  const double before = MotionOfPoint(*f2_from_f1, point).t.norm();
  if (!(before > 0)) return;
  *f2_from_f1 = WithBodyLength(*f2_from_f1, point, length);
  summary->rig_covariance.reset();
  if (!summary->covariance) return;
  const double ratio = MotionOfPoint(*f2_from_f1, point).t.norm() / before;
  Matrix6d scale = Matrix6d::Identity();
  scale.diagonal().tail<3>().setConstant(ratio);
  const Matrix6d jacobian = BodyFromPointJacobian(f2_from_f1->R, point) * scale *
                            BodyFromPointJacobian(f2_from_f1->R, -point);
  *summary->covariance = jacobian * *summary->covariance * jacobian.transpose();
  if (!summary->calibration_covariance) return;
  *summary->calibration_covariance =
      jacobian * *summary->calibration_covariance * jacobian.transpose();
  for (UnalignedMatrix<6, 7>& gain : summary->calibration_gain) gain = (jacobian * gain).eval();
}

Matrix6d SqrtInformation(const Matrix6d& information) {
  // Scale first: radians and metres differ in size, and small eigenvalues would be lost.
  Eigen::Matrix<double, 6, 1> scale;
  for (int k = 0; k < 6; ++k) scale(k) = information(k, k) > 0 ? std::sqrt(information(k, k)) : 1.0;
  const Matrix6d scaled = scale.cwiseInverse().asDiagonal() * Symmetric(information) *
                          scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(scaled);
  const Matrix6d root = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
                        eigen.eigenvectors().transpose() * scale.asDiagonal();
  const Eigen::HouseholderQR<Matrix6d> qr(root);
  return qr.matrixQR().triangularView<Eigen::Upper>();
}

}  // namespace rigel
