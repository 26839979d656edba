// 3pt-approx: three matches, planar motion, the rotation to first order (paper section 4.3).
#ifndef RIGEL_MINIMAL_SOLVERS_THREE_POINT_APPROX_H_
#define RIGEL_MINIMAL_SOLVERS_THREE_POINT_APPROX_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// As published but for two things: t . n = 0 is a row of F instead of a division by (x2)_y, and
// the determinant is the quadratic that it is (eq. h11 says quartic, but A and B of eq. h9 are
// linear in the angle); linear for intra-camera samples. `sample` holds three indices into
// `matches`, whose alignment is kPlanar. Overwrites `solutions`, returns their number, 0 to 2.
int Solve3ptApprox(const PreparedMatches& matches, const int* sample, Solutions* solutions);

// The same made exact near zero rotation (polish.h).
int Solve3ptApproxPolished(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_THREE_POINT_APPROX_H_
