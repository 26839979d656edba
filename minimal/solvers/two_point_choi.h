// 2pt-choi: two matches of one camera, planar motion, exact.
//
// In the aligned frame the baseline of the camera is b = (sin p, 0, cos p), the rotation R_y(a),
// and a match says n(a) . b = 0, which with g = p - a is linear in two unit vectors:
//   (Z0, X0) . (cos p, sin p) + (Xs, Xc) . (cos g, sin g) = 0
// in the coefficients of prepared_matches.h. Two matches turn the first vector into the second by
// a 2x2 matrix N. Both have unit length, so u'(N'N - I) u = 0. This is a line in the unknowns
// (cos 2p, sin 2p), and the motions are its intersections with the unit circle.
// Source: Choi, Kim, "Fast and Reliable Minimal Relative Pose Estimation under Planar Motion",
//   Image and Vision Computing 69, 2018, the solver by line and circle intersection.
//
// The solver knows one camera only: R is the body's through the rig's calibration, |t| is not
// determined (has_scale = false) and t is that of a unit baseline of the camera, sign by positive
// depth. A camera anywhere on the body moves parallel to the plane.
// Sampling: both matches must be of one camera, the same at both times; other samples have no
// solution.
// Units: metres, radians. Degenerate: points at the height of the camera (on the horizon) say
//   nothing about a planar motion; no motion; two points of one vertical line.
#ifndef RIGEL_MINIMAL_SOLVERS_TWO_POINT_CHOI_H_
#define RIGEL_MINIMAL_SOLVERS_TWO_POINT_CHOI_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds two indices into `matches`, aligned by kPlanar. Overwrites `solutions`, returns
// their number, 0 to 2.
int Solve2ptChoi(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_TWO_POINT_CHOI_H_
