#include "rigel/problems/calibration/gravity_calibration.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "rigel/core/angles.h"
#include "rigel/problems/calibration/robust_fit.h"

namespace rigel {
namespace {

// Spreads. The axis of a smaller rotation is mostly noise.
constexpr double kMinTurnSpreads = 3.0;

class GravityFit {
 public:
  explicit GravityFit(const std::vector<CalibrationMotion>& motions) {
    for (const CalibrationMotion& m : motions) {
      if (m.has_rotation && m.prior.gravity1 && m.prior.gravity2) all_.push_back(&m);
    }
  }

  GravityCalibration Run() {
    GravityCalibration result;
    if (static_cast<int>(all_.size()) < kMinCalibrationPairs) {
      result.message =
          "too few pairs that state gravity1 and gravity2: " + std::to_string(all_.size()) +
          ", at least " + std::to_string(kMinCalibrationPairs) + " are needed";
      return result;
    }
    if (Fit(3, &result)) return result;
    if (turn_ < 0 && Fit(2, &result)) {
      result.message =
          "the turn about the vertical is not observable: too little rotation about other axes";
      return result;
    }
    if (turn_ >= 0) {
      result.message = "the frame of the stated gravity is turned by " + DegreesText(turn_) +
                       " against the body" + TooFarText() + "; turn the lines into the body first";
    } else if (scatters_) {
      result.message =
          "the stated gravity scatters too much: sd of its tilt " + SigmasText(scatter_, -1.0);
    } else {
      result.message = "too little rotation: " + std::to_string(result.pairs) + " of " +
                       std::to_string(all_.size()) + " pairs turn by more than the noise";
    }
    return result;
  }

 private:
  static Eigen::Vector3d Residual(const CalibrationMotion& m, const Eigen::Matrix3d& C) {
    return m.pose.R * C * *m.prior.gravity1 - C * *m.prior.gravity2;
  }

  // Frees the first `parameters` of two tilts and the turn about the vertical.
  bool Fit(int parameters, GravityCalibration* result) {
    Eigen::Matrix3d C = Eigen::Matrix3d::Identity();
    Eigen::MatrixXd basis;
    Eigen::MatrixXd hessian, covariance;
    double spread = kMinSpread;
    int used = 0;
    for (int k = 0; k < kMaxFitIterations; ++k) {
      std::vector<double> residuals;
      Eigen::Vector3d down = Eigen::Vector3d::Zero();
      for (const CalibrationMotion* m : all_) {
        const Eigen::Vector2d r =
            TangentBasis(C * *m->prior.gravity2).transpose() * Residual(*m, C);
        residuals.insert(residuals.end(), {r.x(), r.y()});
        down += C * *m->prior.gravity2;
      }
      spread = RobustSpread(residuals);
      if (!(down.norm() > 0)) return false;
      down.normalize();
      Eigen::Matrix3d directions;
      directions << TangentBasis(down), down;
      basis = directions.leftCols(parameters);
      hessian = Eigen::MatrixXd::Zero(parameters, parameters);
      Eigen::MatrixXd squares = hessian;
      Eigen::VectorXd gradient = Eigen::VectorXd::Zero(parameters);
      used = 0;
      for (const CalibrationMotion* m : all_) {
        if (LogSO3(m->pose.R).norm() < kMinTurnSpreads * spread) continue;
        ++used;
        const Eigen::Vector3d r = Residual(*m, C);
        const double weight = CauchyWeight(r.norm(), spread) / (spread * spread);
        const Eigen::Matrix3d full =
            Skew(C * *m->prior.gravity2) - m->pose.R * Skew(C * *m->prior.gravity1);
        const Eigen::MatrixXd J = full * basis;
        const Eigen::VectorXd g = weight * J.transpose() * r;
        hessian += weight * J.transpose() * J;
        gradient += g;
        squares += g * g.transpose();
      }
      result->pairs = used;
      if (used < kMinCalibrationPairs) return false;
      // Rotations of pure noise have a curvature, too: a smaller eigenvalue carries no information.
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
      if (!(eigen.eigenvalues()(0) > used)) return false;
      const Eigen::MatrixXd inverse = hessian.inverse();
      const Eigen::VectorXd step = -inverse * gradient;
      covariance = SmallSampleFactor(used, parameters) * inverse * squares * inverse;
      C = ExpSO3(basis * step) * C;
      if (step.norm() < kConvergedRadians) break;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> tilts(
        Eigen::Matrix2d(covariance.topLeftCorner<2, 2>()));
    const double tilt_sigma = std::sqrt(tilts.eigenvalues()(1));
    const double yaw_sigma = parameters == 3 ? std::sqrt(covariance(2, 2)) : -1.0;
    scatters_ = !IsDetermined(tilt_sigma);
    scatter_ = tilt_sigma;
    if (scatters_ || (parameters == 3 && !IsDetermined(yaw_sigma))) return false;
    if (LogSO3(C).norm() > DegToRad(kMaxCalibrationTurnDeg)) {
      turn_ = LogSO3(C).norm();
      return false;
    }
    result->level = parameters == 3 ? CalibrationLevel::kFull : CalibrationLevel::kTilt;
    result->C = C;
    result->tilt_sigma = tilt_sigma;
    result->yaw_sigma = yaw_sigma;
    result->spread = spread;
    return true;
  }

  std::vector<const CalibrationMotion*> all_;
  double turn_ = -1.0;  // of a C that is determined, but too large to be believed
  bool scatters_ = false;
  double scatter_ = -1.0;
};

}  // namespace

GravityCalibration CalibrateGravity(const std::vector<CalibrationMotion>& motions) {
  return GravityFit(motions).Run();
}

}  // namespace rigel
