// The plane that a lens without distortion projects to: rays <-> points m = (u, v).
//
//   kPerspective   m = (x, y) / z                                  z > 0
//   kAngle         m = (x, y) / r * atan2(a r, z) / b              r = |(x, y)|
//                  a = b = 1: the angle to the axis, as in Kannala, Brandt, "A Generic Camera Model
//                  and Calibration Method", PAMI 28(8), 2006. a = 2 tan(w/2), b = w: Devernay,
//                  Faugeras, "Straight Lines Have to be Straight", MVA 13, 2001; the atan2 for rays
//                  beyond 90 degrees is that of Usenko et al.
//   kSphere        m = (x, y) / (z + a |X|)                        a >= 0: xi
//                  Mei, Rives, "Single View Point Omnidirectional Camera Calibration from Planar
//                  Grids", ICRA 2007
//   kDoubleSphere  m = (x, y) / (b d2 + (1 - b) z1)                a: xi, b: alpha
//                  z1 = z + a |X|, d2 = |(x, y, z1)|
//                  Usenko, Demmel, Cremers, "The Double Sphere Camera Model", 3DV 2018, eq. 40-42
//   kEnhanced      m = (x, y) / (a d + (1 - a) z)                  a: alpha, b: beta
//                  d = sqrt(b r^2 + z^2)
//                  Khomutenko, Garcia, Martinet, "An Enhanced Unified Camera Model", RA-L 1(1),
//                  2016
//
// The domain: rays for which |m| grows with the angle to the axis, where it is continuous from
// the axis on. kAngle: up to kWidestAngle. kSphere: z > -min(a, 1/a) |X|. For the other two let w =
// alpha / (1 - alpha) or its inverse, whichever is less: z1 > -w d2 and z > -w d. For xi < 0
// the bound that Usenko et al. state on z / |X| (eq. 43-45) is too wide, by 0.1 degrees at -0.17.
// All bounds but z > 0 are reached to kLeastGrowth, in the sine or cosine that they speak of.
#ifndef RIGEL_CORE_LENS_PLANE_H_
#define RIGEL_CORE_LENS_PLANE_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"

namespace rigel {

struct LensPlane {
  enum class Kind { kPerspective, kAngle, kSphere, kDoubleSphere, kEnhanced };

  Kind kind = Kind::kPerspective;
  double a = 1;
  double b = 1;

  // False outside the domain. X has any length that has a finite square; `J` may be null: d m / d
  // X.
  bool FromRay(const Eigen::Vector3d& X, Eigen::Vector2d* m, Matrix2x3d* J) const;

  // A unit ray of this point. False only where the formula has none: FromRay() says whether the
  // ray is in the domain.
  bool ToRay(const Eigen::Vector2d& m, Eigen::Vector3d* ray) const;
};

}  // namespace rigel

#endif  // RIGEL_CORE_LENS_PLANE_H_
