// 5pt+1: six matches, no prior, exact: five of one pair of cameras give the rotation and the
// direction of that pair's baseline, the sixth the scale.
//
// With the rays in the body frames the essential matrix of the pair (i, j) is E = [b]x R with the
// body's own R and b = R s_i + t - s_j (five_point_essential.h). E splits into two rotations and b
// up to sign. Of the four motions, the one that has most of the five points in front of both
// cameras is taken, and none if those are fewer than three. Newton steps on the five constraints
// remove the polynomial's rounding. The sixth match is linear in the length of b.
// Source: Horn, "Recovering Baseline and Orientation from Essential Matrix", 1990, the factors of
//   E; the five-plus-one scheme of generalized cameras for the scale.
//
// Sampling: sample[0..4] must be of one ordered pair (i, j), i = j or not: other samples have no
// solution. sample[5] should be of another pair.
// Units: metres. Degenerate: no motion or pure rotation (the cubics are dependent: no solution);
//   sample[5] of the pair of the five, or of the same centres, or blind to the scale (intra-camera
//   matches at pure translation), or a scale that would put the five behind their cameras:
//   has_scale = false, and t for a unit baseline of the five.
#ifndef RIGEL_MINIMAL_SOLVERS_FIVE_POINT_PLUS_ONE_H_
#define RIGEL_MINIMAL_SOLVERS_FIVE_POINT_PLUS_ONE_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds six indices into `matches`; their alignment is not used. Overwrites `solutions`,
// returns their number, 0 to 10.
int Solve5ptPlusOne(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_FIVE_POINT_PLUS_ONE_H_
