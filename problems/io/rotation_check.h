// Whether a matrix of a file is a rotation but for the few digits of the file.
#ifndef RIGEL_PROBLEMS_IO_ROTATION_CHECK_H_
#define RIGEL_PROBLEMS_IO_ROTATION_CHECK_H_

#include <Eigen/Core>

namespace rigel {

// True if no element of R'R - I is above kMaxRotationError, and the determinant is positive.
bool IsNearRotation(const Eigen::Matrix3d& R);

// Of an element of R'R - I, and of |q| - 1: files of few digits have errors of 1e-4.
inline constexpr double kMaxRotationError = 1e-3;

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_ROTATION_CHECK_H_
