#include "rigel/problems/io/rotation_check.h"

#include <Eigen/LU>

namespace rigel {

bool IsNearRotation(const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d off = R.transpose() * R - Eigen::Matrix3d::Identity();
  return off.cwiseAbs().maxCoeff() <= kMaxRotationError && R.determinant() > 0;
}

}  // namespace rigel
