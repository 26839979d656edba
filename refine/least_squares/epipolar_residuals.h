// The residuals of all matches of a frame pair and their analytic Jacobians.
//
//   kSampson    C / |dC/d(pixels)|: pixels, the first-order distance from an exact match
//   kAngular    C / |dC/d(ray directions)| times the mean focal length: pixels at the image centre,
//               for wide-angle lenses; per unit angle on the viewing sphere
//   kAlgebraic  C itself, metres (paper eq. b2). For intra-camera matches it is zero at the zero
//               motion R = I, t = 0 for any matches, and least squares converges there. So it is of
//               use for inter-camera matches only.
//
// kSampson and kAngular do not change when E is scaled. At an epipole (gradient zero up to
// rounding) and at E = 0 their residual and Jacobian are defined as zero.
#ifndef RIGEL_REFINE_LEAST_SQUARES_EPIPOLAR_RESIDUALS_H_
#define RIGEL_REFINE_LEAST_SQUARES_EPIPOLAR_RESIDUALS_H_

#include <vector>

#include <Eigen/Core>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/least_squares.h"
#include "rigel/refine/least_squares/motion_parameterization.h"

namespace rigel {

// The matrix of one camera pair at one motion, and its derivatives.
struct GroupLinearization {
  Eigen::Matrix3d F;
  Eigen::Matrix3d dF[6];
  double rounding2;  // times |p|^2: the rounding error of a squared gradient of zero
};

// Fills one linearization for each group of the matches, at a motion. `basis` has the derivatives
// by the parameters; null if no Jacobian is wanted.
void LinearizeGroups(const GroupedMatches& matches, ResidualKind kind, const Pose& pose,
                     const MotionBasis* basis, std::vector<GroupLinearization>* groups);

class EpipolarResiduals {
 public:
  // `matches` must outlive this object.
  EpipolarResiduals(const GroupedMatches& matches, ResidualKind kind);

  ResidualKind kind() const { return kind_; }
  int size() const { return static_cast<int>(group_of_.size()); }
  int num_groups() const { return static_cast<int>(matches_->groups().size()); }

  // LinearizeGroups() of these matches.
  void Linearize(const Pose& pose, const MotionBasis* basis,
                 std::vector<GroupLinearization>* groups) const {
    LinearizeGroups(*matches_, kind_, pose, basis, groups);
  }

  // Residual of the match at grouped position k, and its derivative by the `num_parameters` columns
  // of the basis, `stride` doubles apart; `jacobian` may be null.
  double Evaluate(const std::vector<GroupLinearization>& groups, int k, int num_parameters,
                  double* jacobian, int stride = 1) const;

 private:
  const GroupedMatches* matches_;
  ResidualKind kind_;
  std::vector<int> group_of_;
  std::vector<RowPoint> p1_, p2_;  // kSampson: those of the matches; else unit rays, J unused
  std::vector<double> weight_;     // per group; kAngular: the focal length
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_EPIPOLAR_RESIDUALS_H_
