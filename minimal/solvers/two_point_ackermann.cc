#include "rigel/minimal/solvers/two_point_ackermann.h"

#include <cmath>

#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/unit_baseline.h"

namespace rigel {
namespace {

// Below this, relative to the rest, a quantity is rounding.
constexpr double kNegligible = 1e-12;

}  // namespace

int Solve2ptAckermann(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const Alignment& alignment = matches.alignment();
  double fx = alignment.forward.x();
  double fz = alignment.forward.z();
  const double f_norm = std::sqrt(fx * fx + fz * fz);
  if (!(f_norm > 1e-9)) return 0;
  fx /= f_norm;
  fz /= f_norm;

  const PreparedMatch* m[2] = {&matches[sample[0]], &matches[sample[1]]};
  const bool deflated = alignment.contains_identity && m[0]->camera1 == m[0]->camera2 &&
                        m[1]->camera1 == m[1]->camera2;
  double e[2][2], k[2][3];
  double k_size = 0.0;
  for (int r = 0; r < 2; ++r) {
    e[r][0] = fx * (m[r]->X0 + m[r]->Xc) + fz * (m[r]->Z0 + m[r]->Xs);
    e[r][1] = fx * (m[r]->Xs - m[r]->Z0) + fz * (m[r]->X0 - m[r]->Xc);
    const double k0 = m[r]->K0 + m[r]->Kc;
    const double k1 = 2.0 * m[r]->Ks;
    const double k2 = m[r]->K0 - m[r]->Kc;
    k[r][0] = deflated ? k1 : k0;
    k[r][1] = deflated ? k2 : k1;
    k[r][2] = deflated ? 0.0 : k2;
    k_size += std::abs(k[r][0]) + std::abs(k[r][1]) + std::abs(k[r][2]);
  }

  if (!(m[0]->parallax2 + m[1]->parallax2 > kNoParallax2)) return 0;
  double roots[3];
  int num_roots = 0;
  // A camera above the body's origin: k vanishes, and one match would do for the angle.
  const bool k_vanishes = k_size < kNegligible;
  if (k_vanishes) {
    const double slope2 = e[0][1] * e[0][1] + e[1][1] * e[1][1];
    if (slope2 > 0.0) roots[num_roots++] = -(e[0][0] * e[0][1] + e[1][0] * e[1][1]) / slope2;
  } else {
    const double c[4] = {
        e[0][0] * k[1][0] - e[1][0] * k[0][0],
        e[0][0] * k[1][1] + e[0][1] * k[1][0] - e[1][0] * k[0][1] - e[1][1] * k[0][0],
        e[0][0] * k[1][2] + e[0][1] * k[1][1] - e[1][0] * k[0][2] - e[1][1] * k[0][1],
        e[0][1] * k[1][2] - e[1][1] * k[0][2]};
    num_roots = deflated ? RealRoots<2>(c, roots) : RealRoots<3>(c, roots);
  }

  for (int n = 0; n < num_roots; ++n) {
    const double z = roots[n];
    // (tau, 1), or (tau, z) if deflated, is orthogonal to the rows (e, k).
    double tau = 0.0;
    double w = 0.0;
    double best = 0.0;
    for (int r = 0; r < 2; ++r) {
      const double er = e[r][0] + z * e[r][1];
      const double kr = k[r][0] + z * (k[r][1] + z * k[r][2]);
      const double norm2 = er * er + kr * kr;
      if (norm2 > best) {
        best = norm2;
        tau = -kr;
        w = er;
      }
    }
    if (k_vanishes) {
      tau = 1.0;
      w = 0.0;
    }
    if (tau == 0.0 && w == 0.0) continue;
    const double inverse = 1.0 / (1.0 + z * z);
    const double c = (1.0 - z * z) * inverse;
    const double s = 2.0 * z * inverse;
    if (!std::isfinite(c + s + tau + w)) continue;

    // R_y(a/2) f sqrt(1 + z^2).
    const Eigen::Vector3d chord(fx + z * fz, 0.0, fz - z * fx);
    const bool has_scale =
        std::abs(w) > kNegligible * std::abs(tau) && (!deflated || std::abs(z) > 1e-8);
    const PreparedMatch& reference = m[0]->parallax2 >= m[1]->parallax2 ? *m[0] : *m[1];
    const Eigen::Vector3d t = has_scale ? chord * ((deflated ? z : 1.0) * tau * inverse / w)
                                        : UnitBaselineTranslation(reference, c, s, chord);
    Solution& solution = solutions->Append();
    solution.R = alignment.Rotation(c, s);
    solution.t = alignment.ToFrame2(t);
    solution.has_scale = has_scale;
  }
  return solutions->size();
}

}  // namespace rigel
