// 17pt-li: seventeen matches, no prior, linear.
//
// Finds R, t from the generalized epipolar constraint of each match, linear in the entries of
// E = [t]x R and of R (paper eq. b2):
//   x_j'E x_i + x_j'R q_i + q_j'R x_i = 0   for all matches:   A_E e + A_R r = 0.
// Source: Li, Hartley, Kim, "A Linear Approach to Motion Estimation Using Generalized Camera
// Models", CVPR 2008, with its remedy for ambiguous rigs.
//
// Ambiguous rigs. The right null space of (A_E A_R) has one dimension for a rig of many centres.
// With intra-camera matches only (r = I, e = 0) is in it whatever the matches are, and with all
// centres on one line two more such vectors; so the plain null vector is noise there. Li et al.
// minimize |A_E e + A_R r| subject to |e| = 1: r is eliminated (by a QR decomposition that stops at
// the rank of A_R), e is the smallest right singular vector of what is left. The ambiguous
// vectors have e = 0 only if the origin is on the line of the centres. So moments are taken about
// the mean centre of the sample, and t is moved back at the end.
//
// E gives two rotations; each takes t, with its scale and sign, from the linear system
// (R x_i x x_j) . t = -k of all matches. Both are returned, the one that fits better first.
//
// Rigs: two cameras and intra-camera matches only are rank 14 (of 17) and still determine all,
// scale included, for R other than I. A central sample (one centre in all) and pure translation
// seen by intra-camera matches have no scale: has_scale is false. Returns nothing where E is not
// determined: no motion at all; and R = I exactly with two cameras and inter-camera matches only.
//
// Units: t in metres. The ranks do not depend on image noise: a pivot counts as zero only if the
// rig makes it zero up to rounding.
#ifndef RIGEL_MINIMAL_SOLVERS_SEVENTEEN_POINT_LI_H_
#define RIGEL_MINIMAL_SOLVERS_SEVENTEEN_POINT_LI_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds 17 indices into `matches`. Overwrites `solutions`, returns their number, 0 to 2.
int Solve17ptLi(const PreparedMatches& matches, const int* sample, Solutions* solutions);

// Least squares over `sample_size` >= 17 matches; fewer give no solution.
int Solve17ptLi(const PreparedMatches& matches, const int* sample, int sample_size,
                Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_SEVENTEEN_POINT_LI_H_
