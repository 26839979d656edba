#include "rigel/minimal/solvers/two_point_choi.h"

#include <algorithm>
#include <cmath>

#include "rigel/minimal/solvers/baseline.h"

namespace rigel {
namespace {

// Relative to the squared determinant: below it p, q and r are what rounding left of zeros.
constexpr double kNoMotion = 1e-14;
// Relative to the terms of the discriminant: a few roundings.
constexpr double kDiscriminantRounding = 1e-15;

}  // namespace

int Solve2ptChoi(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const PreparedMatch& m0 = matches[sample[0]];
  const PreparedMatch& m1 = matches[sample[1]];
  if (m0.camera1 != m0.camera2 || m1.camera1 != m0.camera1 || m1.camera2 != m0.camera1) return 0;

  // A u + B v = 0 for the unit vectors u and v; B is inverted, or A if that is further from
  // singular, with the two vectors exchanged.
  double A[4] = {m0.Z0, m0.X0, m1.Z0, m1.X0};
  double B[4] = {m0.Xs, m0.Xc, m1.Xs, m1.Xc};
  double det = B[0] * B[3] - B[1] * B[2];
  const double det_A = A[0] * A[3] - A[1] * A[2];
  const bool exchanged = std::abs(det_A) > std::abs(det);
  if (exchanged) {
    std::swap_ranges(A, A + 4, B);
    det = det_A;
  }
  // det v = N u.
  const double N[4] = {B[1] * A[2] - B[3] * A[0], B[1] * A[3] - B[3] * A[1],
                       B[2] * A[0] - B[0] * A[2], B[2] * A[1] - B[0] * A[3]};
  const double det2 = det * det;
  const double p = N[0] * N[0] + N[2] * N[2] - det2;
  const double q = N[0] * N[1] + N[2] * N[3];
  const double r = N[1] * N[1] + N[3] * N[3] - det2;
  // p u0^2 + 2 q u0 u1 + r u1^2 = 0. All three vanish if nothing moves.
  const double scale = std::abs(p) + std::abs(q) + std::abs(r);
  if (!(scale > kNoMotion * det2)) return 0;
  const double discriminant = q * q - p * r;
  // A tangent line survives the rounding of its discriminant.
  if (!(discriminant >= -kDiscriminantRounding * scale * scale)) return 0;
  const double root = std::sqrt(std::max(discriminant, 0.0));
  const double h = q >= 0 ? -q - root : -q + root;

  // Both solutions at once, side by side: u = (-q - root, p) and (r, -q - root), or with + root.
  const Eigen::Array2d u0(h, r), u1(p, h);
  const Eigen::Array2d v0 = N[0] * u0 + N[1] * u1;
  const Eigen::Array2d v1 = N[2] * u0 + N[3] * u1;
  const Eigen::Array2d u_inverse = 1.0 / (u0 * u0 + u1 * u1).sqrt();
  const Eigen::Array2d v_inverse = (det < 0 ? -1.0 : 1.0) / (v0 * v0 + v1 * v1).sqrt();
  // a is the angle from (cos g, sin g) to (cos p, sin p).
  const Eigen::Array2d inverse = u_inverse * v_inverse;
  const Eigen::Array2d c = (u0 * v0 + u1 * v1) * inverse;
  const Eigen::Array2d s = (u1 * v0 - u0 * v1) * (exchanged ? -inverse : inverse);
  const Eigen::Array2d bz = exchanged ? v0 * v_inverse : u0 * u_inverse;
  const Eigen::Array2d bx = exchanged ? v1 * v_inverse : u1 * u_inverse;

  const PreparedMatch& reference = m0.parallax2 >= m1.parallax2 ? m0 : m1;
  const int count = root == 0.0 ? 1 : 2;
  for (int k = 0; k < count; ++k) {
    if (inverse[k] == 0.0 || !std::isfinite(inverse[k])) continue;
    const Eigen::Vector3d t =
        UnitBaselineTranslation(reference, c[k], s[k], Eigen::Vector3d(bx[k], 0.0, bz[k]), 1.0);
    Solution& solution = solutions->Append();
    solution.R = matches.alignment().Rotation(c[k], s[k]);
    solution.t = matches.alignment().ToFrame2(t);
    solution.has_scale = false;
  }
  return solutions->size();
}

}  // namespace rigel
