// 4pt-approx and 4pt-axis-approx: four matches, known vertical direction or rotation axis, the
// rotation to first order (paper sections 4.1 and 4.2).
//
// The axis solver is the vertical solver on other alignments: R = A'R_y(a)A is the Rodrigues
// rotation about n for A n = Y, so one function serves both; the alignment of the prepared
// matches says which.
#ifndef RIGEL_MINIMAL_SOLVERS_FOUR_POINT_APPROX_H_
#define RIGEL_MINIMAL_SOLVERS_FOUR_POINT_APPROX_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// As published: roots of the cubic det F(a) (eq. d5; quadratic for intra-camera samples), biased
// by the linearization. `sample` holds four indices into `matches`. Overwrites `solutions`,
// returns their number, 0 to 3; zero is normal. Degenerate samples: depth_system.h.
int Solve4ptApprox(const PreparedMatches& matches, const int* sample, Solutions* solutions);

// The same made exact near zero rotation: Newton steps on the exact determinant of the constraints
// on t itself (direct_sample.h), which has the roots of det F. For intra-camera samples whose
// family contains R = I they start at the roots of its first-order form. For others (matches
// between cameras, tilted body frames, a single camera) they start at the roots of its cubic Taylor
// polynomial. What does not converge is dropped.
int Solve4ptApproxPolished(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_FOUR_POINT_APPROX_H_
