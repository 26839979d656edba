// 2pt-ackermann: two matches, planar motion along a circular arc, exact.
//
// A vehicle steered by its front wheels turns about a point on the line of its rear axle. If the
// body's origin is on that axle, a turn by a moves the origin along the chord that lies half way
// between the two headings. With f the prior's forward direction within the plane (its sign is no
// matter; where none is stated EstimateMotion() takes that of body_axes.h), under X_2 = R X_1 + t,
//   R = R_y(a),   t = -rho R_y(a/2) f      (aligned; rho > 0 forwards, metres along the chord)
// so t' = R_y(-a/2) t = -rho f does not turn, and with z = tan(a/2) a match says
//   tau e(z) + k(z) = 0,   tau = -rho sqrt(1 + z^2),
//   e = (f_x, f_z) . (n_x, n_z) of degree 1, k of degree 2 (direct_sample.h).
// Two matches: e1 k2 - e2 k1 = 0, a cubic in z, and tau from the better conditioned row; the sign
// of rho comes out with it. For intra-camera samples k is divided by z (depth_system.h): a
// quadratic, whose root 0 is driving straight ahead, without scale.
// Source: Lee, Fraundorfer, Pollefeys, "Motion Estimation for Self-Driving Cars with a Generalized
//   Camera", CVPR 2013, the 2-point algorithm under the Ackermann model.
// Units: metres, radians. Degenerate: no forward direction, or one along the plane's normal, rays
//   that do not move (no solution); straight ahead seen by intra-camera matches, or a camera above
//   the body's origin (has_scale = false).
#ifndef RIGEL_MINIMAL_SOLVERS_TWO_POINT_ACKERMANN_H_
#define RIGEL_MINIMAL_SOLVERS_TWO_POINT_ACKERMANN_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds two indices into `matches`, aligned by kPlanar. Overwrites `solutions`, returns
// their number, 0 to 3.
int Solve2ptAckermann(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_TWO_POINT_ACKERMANN_H_
