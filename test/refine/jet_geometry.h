// Vectors of any scalar, for twins of the library's residuals that Ceres differentiates.
#ifndef RIGEL_TEST_REFINE_JET_GEOMETRY_H_
#define RIGEL_TEST_REFINE_JET_GEOMETRY_H_

#include <Eigen/Core>

namespace rigel {

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

// [v]x, so that Cross(v) * w = v x w.
template <class T>
Matrix3<T> Cross(const Vector3<T>& v) {
  Matrix3<T> m;
  m << T(0), -v.z(), v.y(), v.z(), T(0), -v.x(), -v.y(), v.x(), T(0);
  return m;
}

}  // namespace rigel

#endif  // RIGEL_TEST_REFINE_JET_GEOMETRY_H_
