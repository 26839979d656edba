#include "rigel/problems/calibration/plane_calibration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "rigel/core/angles.h"
#include "rigel/core/body_axes.h"
#include "rigel/core/metrics.h"
#include "rigel/problems/calibration/robust_fit.h"

namespace rigel {
namespace {

class PlaneFit {
 public:
  PlaneFit(const std::vector<CalibrationMotion>& motions, const Eigen::Vector3d& start)
      : start_(start) {
    for (const CalibrationMotion& m : motions) {
      if (!m.has_rotation) continue;
      rotations_.push_back(LogSO3(m.pose.R));
      if (m.has_direction && m.pose.t.norm() > 0) directions_.push_back(m.pose.t.normalized());
    }
  }

  PlaneCalibration Run() {
    PlaneCalibration result;
    result.translations = static_cast<int>(directions_.size());
    result.rotations = static_cast<int>(rotations_.size());
    if (!start_.allFinite() || !(start_.norm() > 0)) {
      result.message = "the start is no direction: it must be finite and not zero";
      return result;
    }
    result.normal = start_;
    if (result.translations < kMinCalibrationPairs) {
      result.message = "too few motions with a direction of translation: " +
                       std::to_string(result.translations) + ", at least " +
                       std::to_string(kMinCalibrationPairs) + " are needed";
      return result;
    }
    result.driving = Driving();
    if (FitNormal(result)) {
      const double turn = AngleBetween(fit_.normal, start_);
      if (turn > DegToRad(kMaxCalibrationTurnDeg)) {
        result.message = "the motions lie in a plane, but across " + DirectionText(fit_.normal) +
                         ", " + DegreesText(turn) + " from the start " + DirectionText(start_) +
                         TooFarText() + "; is another way down (--down)?";
        return result;
      }
      Take(CalibrationLevel::kFull, fit_, &result);
      return result;
    }
    const Fit full = fit_;
    const double out_of_plane = std::asin(std::min(1.0, std::abs(result.driving.dot(start_))));
    if (out_of_plane > DegToRad(kMaxCalibrationTurnDeg)) {
      result.message = "most translations go along " + DirectionText(result.driving) + ", " +
                       DegreesText(out_of_plane) + " out of the plane across the start " +
                       DirectionText(start_) + TooFarText() + "; is another way down (--down)?";
    } else if (FitTilt(result)) {
      Take(CalibrationLevel::kTilt, fit_, &result);
      result.message =
          "too little turning to tell the roll of the plane, which is that of the start";
    } else {
      result.message =
          "the motions scatter too much about any plane: sd of its normal " +
          SigmasText(fit_.tilt_sigma > 0 ? fit_.tilt_sigma : full.tilt_sigma, full.roll_sigma);
    }
    return result;
  }

 private:
  struct Fit {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double tilt_sigma = -1.0, roll_sigma = -1.0;
  };

  void Take(CalibrationLevel level, const Fit& fit, PlaneCalibration* result) const {
    result->level = level;
    result->normal = fit.normal;
    result->tilt_sigma = fit.tilt_sigma;
    result->roll_sigma = fit.roll_sigma;
    result->translation_spread = translation_spread_;
    result->rotation_spread = rotation_spread_;
  }

  Eigen::Vector3d Driving() const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& d : directions_) sum += d * d.transpose();
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(2);
  }

  // Spreads and weights for the normal n.
  void Weigh(const Eigen::Vector3d& n) {
    std::vector<double> out_of_plane, across;
    for (const Eigen::Vector3d& d : directions_) out_of_plane.push_back(d.dot(n));
    const Eigen::Matrix<double, 3, 2> basis = TangentBasis(n);
    for (const Eigen::Vector3d& w : rotations_) {
      const Eigen::Vector2d a = basis.transpose() * w;
      across.insert(across.end(), {a.x(), a.y()});
    }
    translation_spread_ = RobustSpread(out_of_plane);
    rotation_spread_ = RobustSpread(across);
    direction_weights_.clear();
    rotation_weights_.clear();
    for (const double r : out_of_plane)
      direction_weights_.push_back(CauchyWeight(r, translation_spread_));
    for (size_t k = 0; k < rotations_.size(); ++k) {
      rotation_weights_.push_back(
          CauchyWeight(std::hypot(across[2 * k], across[2 * k + 1]), rotation_spread_));
    }
  }

  // Minimizes the sum of (d . n)^2 / st^2 + (|w|^2 - (w . n)^2) / sr^2 over directions d and
  // rotation vectors w. The minimum is an eigenvector. The gaps of the eigenvalues are its
  // curvature, in which the noise of the rotations cancels. False if the normal is not determined.
  bool FitNormal(const PlaneCalibration& result) {
    Eigen::Vector3d n = start_;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    for (int k = 0; k < kMaxFitIterations; ++k) {
      Weigh(n);
      Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
      for (size_t i = 0; i < directions_.size(); ++i) {
        M += DirectionWeight(i) * directions_[i] * directions_[i].transpose();
      }
      for (size_t i = 0; i < rotations_.size(); ++i) {
        M -= RotationWeight(i) * rotations_[i] * rotations_[i].transpose();
      }
      eigen.compute(M);
      Eigen::Vector3d next = eigen.eigenvectors().col(0);
      if (next.dot(start_) < 0) next = -next;
      const double moved = AngleBetween(n, next);
      n = next;
      if (moved < kConvergedRadians) break;
    }
    fit_ = Fit();
    fit_.normal = n;
    // Translations and rotations are taken as independent, although both come from the same pairs.
    Eigen::Matrix3d gradients = Eigen::Matrix3d::Zero();
    for (size_t i = 0; i < directions_.size(); ++i) {
      const Eigen::Vector3d g = DirectionWeight(i) * directions_[i].dot(n) * directions_[i];
      gradients += g * g.transpose();
    }
    for (size_t i = 0; i < rotations_.size(); ++i) {
      const Eigen::Vector3d g = RotationWeight(i) * rotations_[i].dot(n) * rotations_[i];
      gradients += g * g.transpose();
    }
    // Of n moved along the other eigenvectors.
    const double gap1 = eigen.eigenvalues()(1) - eigen.eigenvalues()(0);
    const double gap2 = eigen.eigenvalues()(2) - eigen.eigenvalues()(0);
    if (!(gap1 > 0)) return false;
    const Eigen::Matrix<double, 3, 2> others = eigen.eigenvectors().rightCols<2>();
    const Eigen::Vector2d inverse(1.0 / gap1, 1.0 / gap2);
    const Eigen::Matrix2d covariance =
        SmallSampleFactor(result.translations, 2) *
        (inverse.asDiagonal() * others.transpose() * gradients * others * inverse.asDiagonal());
    const Eigen::Matrix3d of_normal = others * covariance * others.transpose();
    const Eigen::Vector3d tilt = (result.driving - n * n.dot(result.driving)).normalized();
    const Eigen::Vector3d roll = n.cross(tilt);
    fit_.tilt_sigma = std::sqrt(tilt.dot(of_normal * tilt));
    fit_.roll_sigma = std::sqrt(roll.dot(of_normal * roll));
    return IsDetermined(fit_.tilt_sigma) && IsDetermined(fit_.roll_sigma);
  }

  // Estimates only the tilt of the start towards the driving direction.
  bool FitTilt(const PlaneCalibration& result) {
    const Eigen::Vector3d f = result.driving;
    Eigen::Vector3d n = start_;
    double sigma = -1.0;
    for (int k = 0; k < kMaxFitIterations; ++k) {
      Weigh(n);
      const Eigen::Vector3d along = (f - n * n.dot(f)).normalized();
      double gradient = 0.0, curvature = 0.0, squares = 0.0;
      for (size_t i = 0; i < directions_.size(); ++i) {
        const double slope = directions_[i].dot(along);
        const double g = DirectionWeight(i) * directions_[i].dot(n) * slope;
        gradient += g;
        squares += g * g;
        curvature += DirectionWeight(i) * slope * slope;
      }
      const double step = -gradient / curvature;
      n = (n + step * along).normalized();
      sigma = std::sqrt(SmallSampleFactor(result.translations, 1) * squares) / curvature;
      if (std::abs(step) < kConvergedRadians) break;
    }
    fit_ = Fit();
    fit_.normal = n;
    fit_.tilt_sigma = sigma;
    return IsDetermined(sigma) && AngleBetween(n, start_) <= DegToRad(kMaxCalibrationTurnDeg);
  }

  double DirectionWeight(size_t i) const {
    return direction_weights_[i] / (translation_spread_ * translation_spread_);
  }
  double RotationWeight(size_t i) const {
    return rotation_weights_[i] / (rotation_spread_ * rotation_spread_);
  }

  const Eigen::Vector3d start_;
  Fit fit_;                                  // of the last fit
  std::vector<Eigen::Vector3d> directions_;  // of translations
  std::vector<Eigen::Vector3d> rotations_;   // rotation vectors
  double translation_spread_ = 1.0, rotation_spread_ = 1.0;
  std::vector<double> direction_weights_, rotation_weights_;
};

}  // namespace

PlaneCalibration CalibratePlane(const std::vector<CalibrationMotion>& motions,
                                const Eigen::Vector3d& start) {
  return PlaneFit(motions, start).Run();
}

}  // namespace rigel
