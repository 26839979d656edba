// 4pt and 4pt-axis: four matches, known vertical direction or rotation axis, exact.
//
// All real roots of the exact det F(z), z = tan(a/2) (depth_system.h; the paper's
// eq. d5 without its first-order approximation): a sextic, a quintic for intra-camera samples
// whose family contains R = I.
#ifndef RIGEL_MINIMAL_SOLVERS_FOUR_POINT_H_
#define RIGEL_MINIMAL_SOLVERS_FOUR_POINT_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds four indices into `matches`, whose alignment (kVertical or kAxis) says which of
// the two solvers this is. Overwrites `solutions`, returns their number, 0 to 6.
int Solve4pt(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_FOUR_POINT_H_
