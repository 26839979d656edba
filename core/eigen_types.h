// Eigen types that are laid out alike in every program.
//
// Eigen aligns a matrix of fixed size to 16, 32 or 64 bytes, and with it every struct that holds
// one. Which of these depends on flags and macros (-mavx, -march=..., EIGEN_MAX_ALIGN_BYTES). With
// other flags than the library's, a program would look for the members in other places. So
// structs and functions that both of them see have these types, or Eigen::Vector3d and Matrix3d,
// which Eigen never aligns. They turn into Eigen's own types and back by plain assignment.
#ifndef RIGEL_CORE_EIGEN_TYPES_H_
#define RIGEL_CORE_EIGEN_TYPES_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rigel {

template <int kRows, int kColumns = 1>
using UnalignedMatrix = Eigen::Matrix<double, kRows, kColumns, Eigen::DontAlign>;

using Pixel = UnalignedMatrix<2>;  // (u, v)
using Matrix2x3d = UnalignedMatrix<2, 3>;
using Matrix3x2d = UnalignedMatrix<3, 2>;
using Vector6d = UnalignedMatrix<6>;
using Matrix6d = UnalignedMatrix<6, 6>;
using UnalignedQuaternion = Eigen::Quaternion<double, Eigen::DontAlign>;

// Of a public struct with Eigen members: that none of them is aligned. The compiler of the program
// checks it where the header is included, with the program's flags.
template <class T>
inline constexpr bool kSameLayoutEverywhere = alignof(T) <= alignof(double);

static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) &&
                  kSameLayoutEverywhere<Eigen::Vector3d>,
              "Eigen::Vector3d is three plain numbers");
static_assert(sizeof(Eigen::Matrix3d) == 9 * sizeof(double) &&
                  kSameLayoutEverywhere<Eigen::Matrix3d>,
              "Eigen::Matrix3d is nine plain numbers");
static_assert(sizeof(Pixel) == 2 * sizeof(double) && kSameLayoutEverywhere<Pixel>,
              "a pixel is two plain numbers");
static_assert(sizeof(Matrix6d) == 36 * sizeof(double) && kSameLayoutEverywhere<Matrix6d>,
              "a covariance is 36 plain numbers");

}  // namespace rigel

#endif  // RIGEL_CORE_EIGEN_TYPES_H_
