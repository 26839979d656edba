// 4pt-liu: four matches, known vertical direction, the rotation to first order.
//
// With sin a = a and cos a = 1 the constraints n(a) . t + k(a) = 0 are a 4x4 matrix affine in the
// angle times (t, 1). Its determinant is a quartic in a. For intra-camera samples whose family
// contains R = I the zero root is divided out, which leaves a cubic (direct_sample.h). Half a root
// is taken as tan(a / 2), the same to first order, R is the exact rotation, and t the translation
// of least residual of the four constraints with that R. Source: Liu, Li, Dai, Pan, "Robust and
// Efficient Relative Pose with a Multi-camera System for
//   Autonomous Vehicle in Highly Dynamic Environments", 2017, its 4-point algorithm.
// Units: metres, radians. Accuracy: biased by the linearization, less than the depth form since
//   nothing is multiplied by depths. Degenerate: as 4pt-lee.
#ifndef RIGEL_MINIMAL_SOLVERS_FOUR_POINT_LIU_H_
#define RIGEL_MINIMAL_SOLVERS_FOUR_POINT_LIU_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds four indices into `matches`, aligned by kVertical. Overwrites `solutions`,
// returns their number, 0 to 4.
int Solve4ptLiu(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_FOUR_POINT_LIU_H_
