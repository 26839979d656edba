// The essential matrices of five matches of one camera pair.
//
// Five matches x2' E x1 = 0 leave E = x X + y Y + z Z + W. det E = 0 and 2 E E'E - tr(E E') E = 0
// are ten cubics in (x, y, z). Gauss elimination of them leaves a 3x3 matrix B(z) with
// B(z) (x, y, 1) = 0. det B is a polynomial of degree 10, whose real roots are found.
// Source: Nister, "An Efficient Solution to the Five-Point Relative Pose Problem", PAMI 26, 2004.
#ifndef RIGEL_MINIMAL_SOLVERS_FIVE_POINT_ESSENTIAL_H_
#define RIGEL_MINIMAL_SOLVERS_FIVE_POINT_ESSENTIAL_H_

#include <Eigen/Core>

namespace rigel {

inline constexpr int kMaxEssentialMatrices = 10;  // the degree of det B

// `x1` and `x2` hold five unit vectors each. Fills in E, which has room for kMaxEssentialMatrices,
// each of Frobenius norm sqrt(2); returns their number. 0 if the cubics are dependent, as without a
// motion or for a pure rotation. Rounding of the polynomial leaves errors, mostly below 1e-7.
int FivePointEssentialMatrices(const Eigen::Vector3d* x1, const Eigen::Vector3d* x2,
                               Eigen::Matrix3d* E);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_FIVE_POINT_ESSENTIAL_H_
