// What the six-point solvers share: the linear system for t that a rotation leaves, its solution
// and the motions that must not be returned.
//
// With g = R x_i one match says (n, k) . (t, 1) = 0, n = g x x_j, k = n . (R s_i - s_j); six of
// them M(R) (t, w)' = 0. (t, w) is kept homogeneous, so that motions without scale, w = 0, are
// ordinary.
#ifndef RIGEL_MINIMAL_SIX_POINT_SYSTEM_H_
#define RIGEL_MINIMAL_SIX_POINT_SYSTEM_H_

#include <Eigen/Core>
#include <Eigen/LU>

#include "rigel/core/rays.h"
#include "rigel/minimal/prepared_matches.h"
#include "rigel/minimal/solutions.h"

namespace rigel {

class SixPointSystem {
 public:
  using Matrix64 = Eigen::Matrix<double, 6, 4>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  // Keeps references to the six matches. Adds the pure translation to `solutions` if the sample is
  // one seen by intra-camera matches only: it is a multiple root of every polynomial system.
  SixPointSystem(const PreparedMatches& matches, const int* sample, Solutions* solutions);

  // False if no motion can be found: a coordinate is not finite, or nothing moved (rays parallel in
  // all intra-camera matches), or all camera centres are one.
  bool solvable() const { return solvable_; }

  const RayPair& rays(int k) const { return *rays_[k]; }
  bool all_intra() const { return all_intra_; }
  // How often the zero motion solves a system of which it is an isolated solution: all intra-camera
  // matches hold at R = I, t = 0; with two cameras also, to first order, along the rotation about
  // the line through their centres, which moves neither. 0 if some match is inter-camera.
  int zero_motion_multiplicity() const { return !all_intra_ ? 0 : two_centres_ ? 2 : 1; }
  bool SameCentres(int i, int j) const {
    return rays(i).ray1.s == rays(j).ray1.s && rays(i).ray2.s == rays(j).ray2.s;
  }

  // Adds (R, t/w), unless it is a solution already, not finite, or the motion that brings all
  // camera centres of all matches together: no match can contradict that one.
  void Add(const Eigen::Matrix3d& R, const Eigen::Vector4d& v);

 private:
  const RayPair* rays_[6];
  Solutions* solutions_;
  double spread_ = 0.0;  // of the centres, metres
  bool all_intra_ = true;
  bool two_centres_ = true;  // or fewer, of intra-camera matches
  bool solvable_ = true;
  bool pure_translation_ = false;
};

// A basis of the body frame whose first axis is no likely rotation axis, so that solutions differ
// in their first coordinate.
Eigen::Matrix3d SixPointBasis();

// The null vector of the best rank 3 approximation of M.
Eigen::Vector4d NullVector(const SixPointSystem::Matrix64& M);

// Newton's method on M(r) v = 0 for six unknowns: r and v, whose largest entry is held. The problem
// gives evaluate(v, &M, &D): M and the derivative D (6 x 3) of M v by r; and update(dr). v is a
// result only: it starts at the null vector of M. True if it converged.
template <class Evaluate, class Update>
bool PolishSixPoint(const Evaluate& evaluate, const Update& update, Eigen::Vector4d* v) {
  constexpr int kMaxIterations = 10;
  constexpr double kMaxStep = 0.5;
  constexpr double kConverged = 1e-7;  // what is left is of the order of the step squared
  SixPointSystem::Matrix64 M;
  Eigen::Matrix<double, 6, 3> D;
  evaluate(Eigen::Vector4d::Zero(), &M, &D);
  *v = NullVector(M);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    int held = 0;
    v->cwiseAbs().maxCoeff(&held);
    *v /= (*v)[held];
    evaluate(*v, &M, &D);
    SixPointSystem::Matrix6 J;
    J.leftCols<3>() = D;
    for (int c = 0, column = 3; c < 4; ++c) {
      if (c != held) J.col(column++) = M.col(c);
    }
    const SixPointSystem::Vector6 step = J.partialPivLu().solve(M * *v);
    const double size = step.norm();
    // Written so that a NaN ends it.
    if (!(step.head<3>().squaredNorm() < kMaxStep * kMaxStep)) return false;
    update(-step.head<3>());
    for (int c = 0, row = 3; c < 4; ++c) {
      if (c != held) (*v)[c] -= step[row++];
    }
    if (size < kConverged) return true;
  }
  return false;
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SIX_POINT_SYSTEM_H_
