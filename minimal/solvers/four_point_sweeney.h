// 4pt-sweeney: four matches, known rotation axis, exact.
//
// With the rotation as the quaternion (1, z n), z = tan(a/2), the constraints on the translation
// are a quadratic eigenvalue problem
//   (z^2 M + z C + K) (t, 1) = 0
// of 4x4 matrices. Two of its eight eigenvalues are +-i whatever the matches are. In the frame
// half way (t' = R_y(-a/2) t) the columns of t'_x and t'_z are linear in z, those of t'_y and 1
// quadratic. There the +-i are gone. The other six eigenvalues are the roots of the characteristic
// polynomial, a sextic, or a quintic for intra-camera samples. Only real eigenvalues are wanted,
// and the roots take a fraction of the time of an 8x8 eigensolver.
// Source: Sweeney, Flynn, Turk, "Solving for Relative Pose with a Partially Known Rotation is a
//   Quadratic Eigenvalue Problem", 3DV 2014, the generalized-camera problem.
// Units: metres, radians. Degenerate: a sample without motion or of parallel rays (no solution,
//   or solutions without meaning); central samples and pure translation seen by intra-camera
//   matches (has_scale = false; direct_sample.h).
#ifndef RIGEL_MINIMAL_SOLVERS_FOUR_POINT_SWEENEY_H_
#define RIGEL_MINIMAL_SOLVERS_FOUR_POINT_SWEENEY_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds four indices into `matches`, aligned by kAxis (kVertical serves as well).
// Overwrites `solutions`, returns their number, 0 to 6. The eigenvalue of the zero motion is
// divided out of intra-camera samples.
int Solve4ptSweeney(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_FOUR_POINT_SWEENEY_H_
