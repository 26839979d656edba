// Four matches as constraints on the translation itself, without a reference match: what 4pt-lee,
// 4pt-liu, 4pt-sweeney and the polished solvers of four matches share.
//
// Each match says n(a) . t + k(a) = 0 (prepared_matches.h), so (t, 1) is a null vector of a 4x4
// matrix whose determinant is a polynomial in the angle. In the frame half way, with
// z = tan(a/2) and t = (u_x + z u_z, (1 + z^2) u_y, u_z - z u_x), the row is
//   x = (X0 + Xc) + z (Xs - Z0)      y = (1 - z^2) Yc + 2 z Ys
//   z = (Z0 + Xs) + z (X0 - Xc)      k = (K0 + Kc) + 2 z Ks + z^2 (K0 - Kc)
// times (u, w), w = 1 / (1 + z^2) where u is scaled such that t is the translation. Two structures
// are taken out of it:
//
// Deflation. If all matches are intra-camera and R = I is in the family, k vanishes at a = 0: the
// zero motion R = I, t = 0 satisfies the sample whatever the matches are. k is divided by z and
// the unknowns become (u, w'), w' = z w. A root that remains at 0 is true pure translation, with a
// direction and no scale (compare depth_system.h).
//
// A rotation by exactly 180 degrees has no z.
//
// Central samples. If all camera centres coincide, or differ along Y only (SameArm), the baseline
// b = R s_i + t - s_j satisfies n . b = 0 and |b| is not determined: (t, 1) = (s_j - R s_i, 1)
// would be a null vector at any angle. The unknowns become (b, w), one match is left out and w = 0
// takes its row.
#ifndef RIGEL_MINIMAL_SOLVERS_DIRECT_SAMPLE_H_
#define RIGEL_MINIMAL_SOLVERS_DIRECT_SAMPLE_H_

#include <Eigen/Core>

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

class DirectSample {
 public:
  // `sample` holds four indices into `matches`, which must outlive this object.
  DirectSample(const PreparedMatches& matches, const int* sample);
  DirectSample(const DirectSample&) = delete;
  DirectSample& operator=(const DirectSample&) = delete;

  bool deflated() const { return deflated_; }

  // False if no match moves, or one is not finite: nothing can be said of translation.
  bool has_parallax() const { return has_parallax_; }

  // Coefficients of the determinant, ascending in z = tan(a/2): degree 6, or 5 if deflated. The
  // structure of the columns x and z takes 1 + z^2 out of the degree 8 that the frames of the
  // matches themselves have (Sweeney et al. 2014). `first_order`: those of the first-order form of
  // deflated samples, a cubic, with y and k to first order in z. Its roots are a tenth as biased as
  // those of the depth form, because nothing is multiplied by depths of tens of metres.
  void Determinant(double c[7], double first_order[4]) const;

  // Adds the motion with z = tan(a/2): R exact from the angle, t from the null vector. Adds
  // nothing if that does not exist.
  void AddSolution(double z, Solutions* solutions) const;

  // Columns of the matrix, one entry a match: coefficients of 1, z and, of k, z^2; y has -y0 there.
  // k of a deflated sample is divided by z, and k2 = 0.
  Eigen::Array4d x0, x1, y0, y1, z0, z1, k0, k1, k2;

 private:
  const PreparedMatches* matches_;
  int sample_[4];  // in the order of the rows
  bool has_parallax_;
  bool deflated_;
  bool central_;
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_DIRECT_SAMPLE_H_
