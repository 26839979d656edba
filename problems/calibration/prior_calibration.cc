#include "rigel/problems/calibration/prior_calibration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "rigel/core/angles.h"
#include "rigel/core/body_axes.h"
#include "rigel/core/enum_names.h"
#include "rigel/core/median.h"
#include "rigel/core/metrics.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

constexpr EnumName<CalibrationLevel> kLevelNames[] = {{CalibrationLevel::kNone, "none"},
                                                      {CalibrationLevel::kTilt, "tilt"},
                                                      {CalibrationLevel::kFull, "full"}};

// Both hold for all three fits. Iterations, as the weights may go to and fro without an end; and
// the step that ends them, far below what motions can tell.
constexpr int kMaxIterations = 50;
constexpr double kConverged = 1e-12;  // radians
// Noise-free motions have residuals of rounding only.
constexpr double kMinSpread = 1e-7;
// A rotation of fewer spreads than this has no axis to speak of.
constexpr double kMinTurnSpreads = 3.0;

// 1-sigma of normally distributed residuals, by their median.
double Spread(std::vector<double> residuals) {
  if (residuals.empty()) return kMinSpread;
  for (double& r : residuals) r = std::abs(r);
  return std::max(1.4826 * MedianInPlace(&residuals), kMinSpread);
}

// Cauchy's, 95 percent efficient on normal residuals.
double Weight(double residual, double spread) {
  const double u = residual / (2.385 * spread);
  return 1.0 / (1.0 + u * u);
}

double SmallSampleFactor(int n, int parameters) {
  return n > parameters ? static_cast<double>(n) / (n - parameters) : 1.0;
}

bool IsSmall(double sigma) { return sigma >= 0 && sigma <= DegToRad(kMaxCalibrationSigmaDeg); }

// "12.3 degrees".
std::string DegreesText(double radians) { return FormatNumber(RadToDeg(radians), 1) + " degrees"; }

std::string TooFar() {
  return ", farther than the " + FormatNumber(kMaxCalibrationTurnDeg, 0) + " that are believed";
}

// "0.2 and 3.4 degrees, at most 1.0 is asked"; what is not determined at all is left out.
std::string SigmasText(double sigma1, double sigma2) {
  std::string text;
  for (const double sigma : {sigma1, sigma2}) {
    if (!std::isfinite(sigma) || sigma < 0) continue;
    text += (text.empty() ? "" : " and ") + FormatNumber(RadToDeg(sigma), 2);
  }
  return (text.empty() ? "unknown" : text + " degrees") + ", at most " +
         FormatNumber(kMaxCalibrationSigmaDeg, 1) + " is asked";
}

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
                         TooFar() + "; is another way down (--down)?";
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
                       DirectionText(start_) + TooFar() + "; is another way down (--down)?";
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
    translation_spread_ = Spread(out_of_plane);
    rotation_spread_ = Spread(across);
    direction_weights_.clear();
    rotation_weights_.clear();
    for (const double r : out_of_plane)
      direction_weights_.push_back(Weight(r, translation_spread_));
    for (size_t k = 0; k < rotations_.size(); ++k) {
      rotation_weights_.push_back(
          Weight(std::hypot(across[2 * k], across[2 * k + 1]), rotation_spread_));
    }
  }

  // Both: sum of (d . n)^2 / st^2 + (|w|^2 - (w . n)^2) / sr^2, whose least n is an eigenvector;
  // the gaps of the eigenvalues are its curvature, in which noise of the rotations cancels. False
  // if that does not determine it.
  bool FitNormal(const PlaneCalibration& result) {
    Eigen::Vector3d n = start_;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    for (int k = 0; k < kMaxIterations; ++k) {
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
      if (moved < kConverged) break;
    }
    fit_ = Fit();
    fit_.normal = n;
    // One gradient a pair would need the pairs in step; those of both kinds are taken as
    // independent.
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
    return IsSmall(fit_.tilt_sigma) && IsSmall(fit_.roll_sigma);
  }

  // Turns the start towards the driving direction only.
  bool FitTilt(const PlaneCalibration& result) {
    const Eigen::Vector3d f = result.driving;
    Eigen::Vector3d n = start_;
    double sigma = -1.0;
    for (int k = 0; k < kMaxIterations; ++k) {
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
      if (std::abs(step) < kConverged) break;
    }
    fit_ = Fit();
    fit_.normal = n;
    fit_.tilt_sigma = sigma;
    return IsSmall(sigma) && AngleBetween(n, start_) <= DegToRad(kMaxCalibrationTurnDeg);
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
                       " against the body" + TooFar() + "; turn the lines into the body first";
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
    for (int k = 0; k < kMaxIterations; ++k) {
      std::vector<double> residuals;
      Eigen::Vector3d down = Eigen::Vector3d::Zero();
      for (const CalibrationMotion* m : all_) {
        const Eigen::Vector2d r =
            TangentBasis(C * *m->prior.gravity2).transpose() * Residual(*m, C);
        residuals.insert(residuals.end(), {r.x(), r.y()});
        down += C * *m->prior.gravity2;
      }
      spread = Spread(residuals);
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
        const double weight = Weight(r.norm(), spread) / (spread * spread);
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
      // Rotations that are noise have slopes, too: what is no larger than theirs tells nothing.
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
      if (!(eigen.eigenvalues()(0) > used)) return false;
      const Eigen::MatrixXd inverse = hessian.inverse();
      const Eigen::VectorXd step = -inverse * gradient;
      covariance = SmallSampleFactor(used, parameters) * inverse * squares * inverse;
      C = ExpSO3(basis * step) * C;
      if (step.norm() < kConverged) break;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> tilts(
        Eigen::Matrix2d(covariance.topLeftCorner<2, 2>()));
    const double tilt_sigma = std::sqrt(tilts.eigenvalues()(1));
    const double yaw_sigma = parameters == 3 ? std::sqrt(covariance(2, 2)) : -1.0;
    scatters_ = !IsSmall(tilt_sigma);
    scatter_ = tilt_sigma;
    if (scatters_ || (parameters == 3 && !IsSmall(yaw_sigma))) return false;
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

const char* CalibrationLevelName(CalibrationLevel level) { return NameOf(kLevelNames, level); }

PlaneCalibration CalibratePlane(const std::vector<CalibrationMotion>& motions,
                                const Eigen::Vector3d& start) {
  return PlaneFit(motions, start).Run();
}

GravityCalibration CalibrateGravity(const std::vector<CalibrationMotion>& motions) {
  return GravityFit(motions).Run();
}

}  // namespace rigel
