#include "rigel/core/metrics.h"

#include <cmath>
#include <limits>

namespace rigel {

double RotationError(const Eigen::Matrix3d& R_gt, const Eigen::Matrix3d& R) {
  return LogSO3(R_gt * R.transpose()).norm();
}

double TranslationDirectionError(const Eigen::Vector3d& t_gt, const Eigen::Vector3d& t) {
  // atan2 of (0, 0) would call a missing direction a perfect one.
  if (t_gt.isZero(0) || t.isZero(0)) return std::numeric_limits<double>::quiet_NaN();
  return AngleBetween(t_gt, t);
}

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double ScaleError(const Eigen::Vector3d& t_gt, const Eigen::Vector3d& t) {
  if (t_gt.isZero(0)) return std::numeric_limits<double>::quiet_NaN();
  return std::abs(t.norm() / t_gt.norm() - 1.0);
}

}  // namespace rigel
