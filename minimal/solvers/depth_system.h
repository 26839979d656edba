// The depth system F(a) (d1, d2, w)' = 0 that the three solvers of the paper share with their
// polished and exact forms. It is homogeneous: w is a common factor, and the depths are d1 / w and
// d2 / w. Below they are written for w = 1. Rows and columns of F are counted from 0.
//
// One match of the sample is the reference. Its point is at s_i + d1 x1 in f1 and at s_j + d2 x2
// in f2 (distances from the camera centres; the paper's l1, l2 of eq. a5 count from the feet of
// the perpendiculars, which shifts the unknowns by constants and leaves det F alone), so
//   t = (s_j + d2 x2) - R (s_i + d1 x1),
// and every other match gives one row of F, affine in (1, cos a, sin a) (paper eqs. b4, d4). With
// planar motion the row of t . n = 0 is [-(x1)_y, (x2)_y, (s_j)_y - (s_i)_y]; nothing is
// divided by (x2)_y, which is 0 on the horizon.
//
// Each row is a polynomial in one variable z:
//   first order  z = a, cos a = 1, sin a = a: entries of degree 1 (paper eq. d1_1)
//   exact        z = tan(a/2), the row multiplied by 1 + z^2: entries of degree 2
//
// Deflation. If all matches of the sample are intra-camera and the prior allows R = I, the zero
// motion R = I, t = 0 satisfies the sample whatever the matches are: column 2 vanishes at a = 0.
// It is divided by z, and the unknowns become (d1, d2, w'), w' = z w. One factor of det F goes;
// a root that remains at 0 is true pure translation, with a direction and no scale.
//
// Central samples. If all camera centres of the sample coincide, or differ along Y only (SameArm),
// column 2 vanishes altogether: |t| is not determined, one match is not needed, and the determinant
// is that of two rows.
#ifndef RIGEL_MINIMAL_SOLVERS_DEPTH_SYSTEM_H_
#define RIGEL_MINIMAL_SOLVERS_DEPTH_SYSTEM_H_

#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

enum class RotationModel { kFirstOrder, kExact };

// `Degree` of the entries: 1 for kFirstOrder, 2 for kExact.
template <RotationModel kModel>
class DepthSystem {
 public:
  static constexpr int kEntryDegree = kModel == RotationModel::kExact ? 2 : 1;
  static constexpr int kMaxDegree = 3 * kEntryDegree;

  // Known vertical direction or rotation axis: `sample` holds four indices.
  void SetFourPoint(const PreparedMatches& matches, const int* sample);

  // Planar motion: `sample` holds three indices.
  void SetPlanar(const PreparedMatches& matches, const int* sample);

  // Coefficients of det F, ascending, kMaxDegree + 1 of them. Returns the degree that the sample's
  // structure leaves (four-point first order 3, deflated 2; exact 6, 5; planar first order 2, 1;
  // exact 4, 3; central samples less). 0: no solution can be found, all is zero or not finite.
  int Determinant(double* coefficients) const;

  // Adds the motion of the root z of det F; R is rebuilt as an exact rotation from the angle.
  // Adds nothing if the null vector does not exist.
  void AddSolution(const PreparedMatches& matches, double z, Solutions* solutions) const;

 private:
  void SetReference(const PreparedMatches& matches, const int* sample, int sample_size);
  void SetRow(const PreparedMatch& match, int row);
  int LastColumnDegree() const { return deflated_ ? kEntryDegree - 1 : kEntryDegree; }
  // Coefficients of f(i,0) f(j,1) - f(i,1) f(j,0) of rows i and j.
  void Minor(int i, int j, double* m) const;
  // Adds the last column's entry of row r times the minor of rows i and j.
  void AddCofactor(int r, int i, int j, double* coefficients) const;
  // False if the rays of all matches coincide up to rounding.
  bool Moves() const;
  void NullVector(double z, double v[3]) const;

  // Entry (row, column) is sum_k f_[k][row][column] z^k; column 2 is divided by z if deflated_.
  double f_[kEntryDegree + 1][3][3];
  const PreparedMatch* reference_ = nullptr;
  bool has_parallax_ = false;
  bool deflated_ = false;
  bool central_ = false;
  bool planar_ = false;
};

extern template class DepthSystem<RotationModel::kFirstOrder>;
extern template class DepthSystem<RotationModel::kExact>;

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_DEPTH_SYSTEM_H_
