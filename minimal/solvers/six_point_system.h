// What the six-point solvers share: the linear system for t that a rotation leaves, its solution
// and the motions that must not be returned.
//
// With g = R x_i one match says (n, k) . (t, 1) = 0, n = g x x_j, k = n . (R s_i - s_j); six of
// them M(R) (t, w)' = 0. (t, w) is kept homogeneous, so that motions without scale, w = 0, are
// ordinary.
#ifndef RIGEL_MINIMAL_SOLVERS_SIX_POINT_SYSTEM_H_
#define RIGEL_MINIMAL_SOLVERS_SIX_POINT_SYSTEM_H_

#include <cmath>

#include <Eigen/Core>

#include "rigel/core/rays.h"
#include "rigel/minimal/numerics/elimination.h"
#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

class SixPointSystem {
 public:
  // Keeps references to the six matches. Adds the pure translation to `solutions` if the sample is
  // one seen by intra-camera matches only: it is a multiple root of every polynomial system.
  SixPointSystem(const PreparedMatches& matches, const int* sample, Solutions* solutions);

  // False if no motion can be found: a coordinate is not finite, or nothing moved (rays parallel in
  // all intra-camera matches), or all camera centres are one.
  bool solvable() const { return solvable_; }

  const RayPair& rays(int k) const { return *rays_[k]; }
  bool all_intra() const { return all_intra_; }
  // How often the zero motion solves a system of which it is an isolated solution. All intra-camera
  // matches hold at R = I, t = 0. With two cameras they hold, to first order, also along the
  // rotation about the line through their centres, which moves neither. 0 if some match is
  // inter-camera.
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

// The Newton step of M(r) v = 0, of r and then of the entries of v but the held one, in whose place
// the last entry stands. D (6 x 3) is the derivative of M v by r. Not finite where it is not
// unique.
void SixPointStep(const double (*M)[4], const double (*D)[3], const Eigen::Vector4d& v, int held,
                  double* step);

// Newton's method on M(r) v = 0 for six unknowns: r and v, whose largest entry is held. The problem
// gives evaluate(v, M, D): M (6 x 4) and the derivative D (6 x 3) of M v by r; and update(dr). v is
// a result only: it starts at the null vector of M. True if it converged.
template <class Evaluate, class Update>
bool PolishSixPoint(const Evaluate& evaluate, const Update& update, Eigen::Vector4d* v) {
  // Steps, and the largest one, of r in the solver's unit. Starts near a root keep within both;
  // what does not has left the root that it was to find, or has none.
  constexpr int kMaxIterations = 10;
  constexpr double kMaxStep = 0.5;
  constexpr double kLastStep = 1e-7;  // of r and v; the error left is of the order of its square
  double M[6][4], D[6][3];
  evaluate(Eigen::Vector4d::Zero(), M, D);
  *v = NullVector(M);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    int held = 0;
    for (int c = 1; c < 4; ++c) held = std::abs((*v)[c]) > std::abs((*v)[held]) ? c : held;
    *v *= 1.0 / (*v)[held];
    evaluate(*v, M, D);
    double step[6];
    SixPointStep(M, D, *v, held, step);
    const double turn2 = step[0] * step[0] + step[1] * step[1] + step[2] * step[2];
    const double size2 = turn2 + step[3] * step[3] + step[4] * step[4] + step[5] * step[5];
    // Written so that a NaN ends it.
    if (!(turn2 < kMaxStep * kMaxStep)) return false;
    update(Eigen::Vector3d(-step[0], -step[1], -step[2]));
    for (int c = 0; c < 3; ++c) (*v)[c == held ? 3 : c] -= step[3 + c];
    if (size2 < kLastStep * kLastStep) return true;
  }
  return false;
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_SIX_POINT_SYSTEM_H_
