#include "rigel/minimal/two_point_choi.h"

#include <algorithm>
#include <cmath>

#include "rigel/minimal/unit_baseline.h"

namespace rigel {

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
  if (!(scale > 1e-14 * det2)) return 0;
  const double discriminant = q * q - p * r;
  // A tangent line survives the rounding of its discriminant.
  if (!(discriminant >= -1e-15 * scale * scale)) return 0;
  const double root = std::sqrt(std::max(discriminant, 0.0));
  const double h = q >= 0 ? -q - root : -q + root;
  const double candidates[2][2] = {{h, p}, {r, h}};

  const PreparedMatch& reference = m0.parallax2 >= m1.parallax2 ? m0 : m1;
  for (const double* u : candidates) {
    const double v[2] = {N[0] * u[0] + N[1] * u[1], N[2] * u[0] + N[3] * u[1]};
    const double norm2 = (u[0] * u[0] + u[1] * u[1]) * (v[0] * v[0] + v[1] * v[1]);
    if (!(norm2 > 0.0) || !std::isfinite(norm2)) continue;
    // a is the angle from (cos g, sin g) to (cos p, sin p).
    const double scale_uv = (det < 0 ? -1.0 : 1.0) / std::sqrt(norm2);
    const double c = (u[0] * v[0] + u[1] * v[1]) * scale_uv;
    const double sine = (u[1] * v[0] - u[0] * v[1]) * scale_uv;
    const double s = exchanged ? -sine : sine;
    const double* b = exchanged ? v : u;
    const Eigen::Vector3d t =
        UnitBaselineTranslation(reference, c, s, Eigen::Vector3d(b[1], 0.0, b[0]));
    Solution& solution = solutions->Append();
    solution.R = matches.alignment().Rotation(c, s);
    solution.t = matches.alignment().ToFrame2(t);
    solution.has_scale = false;
    if (root == 0.0) break;
  }
  return solutions->size();
}

}  // namespace rigel
