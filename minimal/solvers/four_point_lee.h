// 4pt-lee: four matches, known vertical direction, exact.
//
// (t, 1) is a null vector of the 4x4 matrix of the constraints
//   n(z) . t + k(z) = 0,   z = tan(a/2),
// with entries of degree 2 in z; its determinant is a polynomial of degree 8. The factor 1 + z^2
// comes from the substitution, has the two roots +-i, and is divided out. What is left is a sextic,
// all of whose real roots are motions. For intra-camera samples whose family contains R = I the
// zero root is divided out too, which leaves a quintic (direct_sample.h). The translation is
// eliminated as a whole; 4pt has the same solutions from a 3x3 system. Source: Lee, Pollefeys,
// Fraundorfer, "Relative Pose Estimation for a Multi-Camera System with
//   Known Vertical Direction", CVPR 2014, the 8th degree polynomial of its 4-point algorithm.
// Units: metres, radians. Degenerate: a sample without motion or of parallel rays (no solution,
//   or solutions without meaning); central samples and pure translation seen by intra-camera
//   matches (has_scale = false; direct_sample.h).
#ifndef RIGEL_MINIMAL_SOLVERS_FOUR_POINT_LEE_H_
#define RIGEL_MINIMAL_SOLVERS_FOUR_POINT_LEE_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds four indices into `matches`, aligned by kVertical (kAxis serves as well).
// Overwrites `solutions`, returns their number, 0 to 6. The zero motion, a root of every
// intra-camera sample where A1 = A2, is not among them unless it is a double root: then that root
// is pure translation.
int Solve4ptLee(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_FOUR_POINT_LEE_H_
