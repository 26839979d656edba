// 6pt-ventura: six matches, no prior, the rotation to first order.
//
// With R = I + [r]x one match says (n(r), k(r)) . (t, 1) = 0, entries of degree 1 in r (paper eq.
// b2: n = R x_i x x_j, k = x_j'R q_i + q_j'R x_i). Six of them have a solution where the 6 x 4
// matrix M(r) has rank 3: its fifteen 4 x 4 minors, quartics in r, vanish. They have 20 common
// roots. Source: Ventura, Arth, Lepetit, "An Efficient Minimal Solution for Multi-Camera Motion",
// ICCV 2015. The paper expands a polynomial of degree 20 in one unknown. Here the quartics are
// solved for the fifteen monomials of degree 4 in terms of the twenty lower ones. That gives the
// multiplication by one unknown as a 20 x 20 matrix. Its characteristic polynomial is the paper's
// polynomial.
//
// Each root is polished by Newton's method on M(r) (t, w)' = 0; R is rebuilt as the exact rotation
// ExpSO3(r). Both stay biased by the linearization. At 1 degree of rotation, without noise, the
// best solution of inter-camera samples is off by 0.010 degrees in rotation and 0.15 in direction.
// For intra-camera samples of two cameras it is 0.026 and 0.25 degrees. These are medians with
// random axes; at 10 degrees they are 100 times as large.
//
// Intra-camera samples: r = 0, t = 0 is a root whatever the matches are, a double one if the
// centres are on one line. It is never returned; roots near it get a Newton step on the matrix,
// because the polynomial's coefficients do not tell them apart. Pure translation of such a sample
// is a multiple root there; it is tested for directly and returned without scale.
//
// Units: r in radians, t in metres. Degenerate, returns nothing: one centre in all; no motion seen
// by intra-camera matches.
#ifndef RIGEL_MINIMAL_SOLVERS_SIX_POINT_VENTURA_H_
#define RIGEL_MINIMAL_SOLVERS_SIX_POINT_VENTURA_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds six indices into `matches`. Overwrites `solutions`, returns their number, 0 to 20.
int Solve6ptVentura(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_SIX_POINT_VENTURA_H_
