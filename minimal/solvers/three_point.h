// 3pt: three matches, planar motion, exact.
//
// All real roots of the exact det F(z), z = tan(a/2), with the row of t . n = 0: a quartic, a cubic
// for intra-camera samples (depth_system.h; the paper's eq. h11 without its first-order
// approximation).
#ifndef RIGEL_MINIMAL_SOLVERS_THREE_POINT_H_
#define RIGEL_MINIMAL_SOLVERS_THREE_POINT_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds three indices into `matches`, whose alignment is kPlanar. Overwrites `solutions`,
// returns their number, 0 to 4.
int Solve3pt(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_THREE_POINT_H_
