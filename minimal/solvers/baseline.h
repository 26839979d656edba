// The aligned translation from the baseline b = R s_i + t - s_j of a match: from b itself, or from
// its direction where the sample does not determine |t|.
#ifndef RIGEL_MINIMAL_SOLVERS_BASELINE_H_
#define RIGEL_MINIMAL_SOLVERS_BASELINE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rigel/minimal/solvers/prepared_matches.h"

namespace rigel {

// 1/m, of w of the homogeneous baseline (direction, w) relative to the direction. A smaller one is
// rounding, and the length of t is not determined.
inline constexpr double kNoScale = 1e-12;

// t = b + s_j - R s_i for R = R_y(a), c = cos a, s = sin a. It takes the components of b: if they
// were stored one at a time, a load of the whole vector would have to wait for these stores.
inline Eigen::Vector3d TranslationOfBaseline(const PreparedMatch& reference, double c, double s,
                                             double bx, double by, double bz) {
  const double* s1 = reference.s1;
  const double* s2 = reference.s2;
  return {bx + s2[0] - (c * s1[0] + s * s1[2]), by + s2[1] - s1[1],
          bz + s2[2] - (c * s1[2] - s * s1[0])};
}

// The aligned translation for which the baseline of `reference` is a unit vector along `direction`
// or against it, whichever has the match in front of its cameras. R = R_y(a), c = cos a, s = sin a.
// `direction` is not zero; `inverse_norm` is one over its length.
inline Eigen::Vector3d UnitBaselineTranslation(const PreparedMatch& reference, double c, double s,
                                               const Eigen::Vector3d& direction,
                                               double inverse_norm) {
  const double* x1 = reference.x1;
  const double* x2 = reference.x2;
  const Eigen::Vector3d g(c * x1[0] + s * x1[2], x1[1], c * x1[2] - s * x1[0]);
  const Eigen::Vector3d f(x2[0], x2[1], x2[2]);
  // b = d2 f - d1 g, so (f + g) x b . (g x f) = (d1 + d2) |g x f|^2.
  const double depths = (f + g).cross(direction).dot(g.cross(f));
  const double scale = depths >= 0 ? inverse_norm : -inverse_norm;
  return TranslationOfBaseline(reference, c, s, scale * direction.x(), scale * direction.y(),
                               scale * direction.z());
}

inline Eigen::Vector3d UnitBaselineTranslation(const PreparedMatch& reference, double c, double s,
                                               const Eigen::Vector3d& direction) {
  return UnitBaselineTranslation(reference, c, s, direction, 1.0 / direction.norm());
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_BASELINE_H_
