// What the solvers need of each match, computed once a frame pair and not once a sample.
//
// With p = A1 x_i, r = A2 x_j the aligned rays and R = R_y(a), c = cos a, s = sin a, one match
// says n(a) . t + k(a) = 0 for the aligned translation t, where
//   n = R p x r,   R'n = p x R'r,   k = r'R q_i + q_j'R p   (moments q about the body's origin)
// are affine in (1, c, s):
//   n   = (X0 + c Xc + s Xs,  c Yc + s Ys,  Z0 + c Xs - s Xc)
//   R'n = (Xc + c X0 - s Z0,  c Yc + s Ys,  Xs + c Z0 + s X0)
//   k   = K0 + c Kc + s Ks.
#ifndef RIGEL_MINIMAL_SOLVERS_PREPARED_MATCHES_H_
#define RIGEL_MINIMAL_SOLVERS_PREPARED_MATCHES_H_

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/alignment.h"
#include "rigel/core/match.h"
#include "rigel/core/rays.h"
#include "rigel/core/rig.h"

namespace rigel {

class GroupedMatches;

// Squared sine of the angle between the aligned rays of a match. Below this the match does not
// move, but for rounding. If no match of a sample moves, it does not determine the translation, and
// solvers return no solution.
inline constexpr double kNoParallax2 = 1e-18;

// Below this tan(a/2) or angle a, radians, a root of a deflated sample (depth_system.h) is the pure
// translation, whose length is not determined: half the digits of a double, as the root is double.
inline constexpr double kNoTurn = 1e-8;

// The coefficients of n and k.
struct ConstraintRow {
  double X0, Xc, Xs, Yc, Ys, Z0;
  double K0, Kc, Ks;
};

struct PreparedMatch : ConstraintRow {
  double x1[3], x2[3];  // p and r: aligned unit directions
  double s1[3], s2[3];  // aligned camera centres, metres
  double parallax2;     // |p x r|^2, squared sine of the angle between the aligned rays
  int camera1, camera2;
};

// True if s2 - R_y(a) s1 of the two matches is the same at every angle: their camera centres are
// equal at both times, but for a height along Y. If this holds for all matches, |t| is not
// determined.
inline bool SameArm(const PreparedMatch& a, const PreparedMatch& b) {
  constexpr double kSame = 1e-12;  // metres: below it is rounding
  // Most differ in the first coordinate.
  if (!(std::abs(a.s1[0] - b.s1[0]) + std::abs(a.s2[0] - b.s2[0]) < kSame)) return false;
  return std::abs(a.s1[2] - b.s1[2]) + std::abs(a.s2[2] - b.s2[2]) +
             std::abs((a.s2[1] - a.s1[1]) - (b.s2[1] - b.s1[1])) <
         kSame;
}

class PreparedMatches {
 public:
  PreparedMatches() = default;
  PreparedMatches(const Rig& rig, const std::vector<Match>& matches, const Alignment& alignment);

  // Internal. The matches in grouped order, for RANSAC, which may draw only few of them. Match k
  // may be read only after Prepare() was called with it. A match that is never drawn takes hardly
  // any memory. `matches` must outlive the result.
  static PreparedMatches OnDemand(const GroupedMatches& matches, const Alignment& alignment);

  // Call it before a sample of OnDemand() is solved. Does nothing for other objects. No heap.
  void Prepare(const int* sample, int size);

  // Keeps the memory of the last frame pair.
  void Set(const Rig& rig, const std::vector<Match>& matches, const Alignment& alignment);

  int size() const { return static_cast<int>(place_.size()); }
  const PreparedMatch& operator[](int k) const { return matches_[place_[k]]; }
  const Alignment& alignment() const { return alignment_; }

  // The rays in the body frames (not aligned).
  const RayPair& rays(int k) const { return rays_[place_[k]]; }

 private:
  Alignment alignment_;
  // In the order of their preparation; match k at place_[k], which is negative until then.
  std::vector<PreparedMatch> matches_;
  std::vector<RayPair> rays_;
  std::vector<int> place_;
  const GroupedMatches* grouped_ = nullptr;  // whose matches are prepared when drawn
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_PREPARED_MATCHES_H_
