// 6pt-stewenius: six matches, no prior, exact.
//
// With the depths d1, d2 of a reference match eliminated, t = (s_j + d2 x2) - R (s_i + d1 x1),
// every other match gives one row of F(R) (d1, d2, 1)' = 0 (paper eq. b4, from the camera centres),
// entries of degree 2 in r for R the rotation of the quaternion (1, r). All 3 x 3 minors of the
// rows vanish: fifteen different sextics in r, one for each four of the six matches. They have 64
// common roots. Source: Stewenius, Nister, Oskarsson, Astrom, "Solutions to Minimal Generalized
// Relative Pose Problems", OMNIVIS 2005. The elimination here is not theirs,
// and there is no generated code. The products of the sextics up to degree 7, and one relation of
// degree 8, give multiplication by one unknown as a 64 x 64 matrix (polynomial_system.h).
//
// Matches with the same two camera centres. For three of them R must let a baseline exist: a 2 x 2
// minor, a quartic, vanishes. Without it the sextics have solutions with the baseline of these
// matches zero. If all matches have one of two pairs of centres, these are a whole line: both
// baselines are zero, and the rotation about the line of the centres is free. Any sample of
// intra-camera matches of a two-camera rig is such a case, and any of inter-camera matches.
// (Solvers that are built for 64 isolated solutions fail there.) With the quartics there are
//   three of one pair of centres 56 solutions, 3 + 3: 48, four of one: 40, five of one: 20.
// All are isolated. So intra-camera matches of a two-camera rig determine the motion and its scale,
// in exact arithmetic. How well they do depends on the noise (core/epipolar.h: scale is weak at
// small rotations).
//
// R = I, t = 0 solves any intra-camera sample and is never returned. Pure translation of such a
// sample is a multiple root; it is tested for directly and returned without scale.
//
// r counts from the rotation that aligns the rays best, as all solutions of small parallax are near
// it. Every solution is polished by Newton's method on the six constraints; starts that do not
// converge are dropped. Rotations near a half turn from the alignment are found less reliably.
//
// Units: t in metres. Degenerate, returns nothing or misses: one centre in all; no motion seen by
// intra-camera matches; intra-camera samples of three or more cameras on one line without three
// matches of one camera. The last have the line of zero baselines again. The truth is found in 85
// percent of such samples at 10 degrees, in 14 percent at 1 degree.
// Needs 0.25 MB of stack.
#ifndef RIGEL_MINIMAL_SOLVERS_SIX_POINT_STEWENIUS_H_
#define RIGEL_MINIMAL_SOLVERS_SIX_POINT_STEWENIUS_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds six indices into `matches`. Overwrites `solutions`, returns their number, 0 to 64.
int Solve6ptStewenius(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_SIX_POINT_STEWENIUS_H_
