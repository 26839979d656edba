// The same constraints on the translation itself, without a reference match: the first-order form
// of Liu, Li, Dai and Pan (2017), whose roots start the polished solvers.
//
// With t' = R_y(-a/2) t (the frame half way) and z = tan(a/2), one match says
//   (n_x, n_y, n_z, k) . (t', 1) = 0,
//   n_x = (X0 + Xc) + z (Xs - Z0)           n_y = (1 - z^2) Yc + 2 z Ys   (over 1 + z^2)
//   n_z = (Z0 + Xs) + z (X0 - Xc)           k   = (K0 + Kc) + 2 z Ks + z^2 (K0 - Kc)  (likewise)
// in the coefficients of prepared_matches.h, and det over four matches vanishes. Its first-order
// bias is a tenth of the depth form's, because nothing is multiplied by depths of tens of metres.
#ifndef RIGEL_MINIMAL_DIRECT_SYSTEM_H_
#define RIGEL_MINIMAL_DIRECT_SYSTEM_H_

#include "rigel/minimal/prepared_matches.h"

namespace rigel {

// Coefficients c[0..3], ascending in z, of the first-order determinant of four intra-camera
// matches whose family contains R = I: there k vanishes at z = 0 and is divided by z, which takes
// the root of the zero motion out (depth_system.h). `sample` holds four indices.
void DirectDeterminantIntra(const PreparedMatches& matches, const int* sample, double* c);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_DIRECT_SYSTEM_H_
