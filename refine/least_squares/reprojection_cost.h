// Two-view bundle adjustment: the reprojection errors of one match in both images.
//
// A point has three parameters: the error (du, dv) of its image in view 1, pixels, and rho, the
// inverse of its distance from camera 1 along AlongRay(), 1/metres: of a pinhole 1/z. With rho
// alone the ray of view 1 would be exact, and the noise of view 1 would count as an error in
// view 2. With all three the minimum is the maximum-likelihood motion. rho = 0, a point at
// infinity, is no special case.
#ifndef RIGEL_REFINE_LEAST_SQUARES_REPROJECTION_COST_H_
#define RIGEL_REFINE_LEAST_SQUARES_REPROJECTION_COST_H_

#include <array>

#include <ceres/cost_function.h>

#include "rigel/core/match.h"
#include "rigel/core/pose.h"
#include "rigel/core/rig.h"
#include "rigel/refine/least_squares/motion_parameterization.h"

namespace rigel {

class ReprojectionCost : public ceres::CostFunction {
 public:
  using Point = std::array<double, 3>;  // du, dv, rho

  // Parameter blocks: the motion (`size` numbers, whose pose and basis the caller keeps up to date
  // in `pose` and `basis`), and the point. Residuals, pixels times `weight`: (du, dv), projection -
  // pixel2. All must outlive this object. The match's cameras must be in the rig. Evaluate()
  // returns false where the point has no image or no ray, and while `*stopped` is true (may be
  // null).
  ReprojectionCost(const Rig& rig, const Match& match, const Pose& pose, const MotionBasis& basis,
                   int size, double weight, const bool* stopped = nullptr);

  // The point nearest to both rays of the match: (0, 0, rho), rho = 0 if they do not meet in front.
  static Point Triangulate(const Rig& rig, const Match& match, const Pose& pose);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const RigCamera& camera1_;
  const RigCamera& camera2_;
  const Match& match_;
  const Pose& pose_;
  const MotionBasis& basis_;
  double weight_;
  const bool* stopped_;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_REPROJECTION_COST_H_
