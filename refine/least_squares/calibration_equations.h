// The normal equations of the motion and the errors of the calibration (fundamental_derivatives.h).
// Both change the Sampson errors through F alone. So the sums of SumSampson() serve both.
#ifndef RIGEL_REFINE_LEAST_SQUARES_CALIBRATION_EQUATIONS_H_
#define RIGEL_REFINE_LEAST_SQUARES_CALIBRATION_EQUATIONS_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/fundamental_derivatives.h"
#include "rigel/refine/least_squares/sampson_kernel.h"

namespace rigel {

// Sums over matches of the second derivatives of the cost: by the motion and by the errors of the
// cameras, camera by camera.
struct CalibrationEquations {
  explicit CalibrationEquations(int num_cameras)
      : cross(6, kCameraErrors * num_cameras),
        own(kCameraErrors * num_cameras, kCameraErrors * num_cameras) {
    cross.setZero();
    own.setZero();
  }

  // Adds SumSampson() of the group at `pose`, times `factor`.
  void Add(const SampsonKernelOptions& options, const GroupedMatches& matches,
           const MatchGroup& group, const double* weights, const Pose& pose, double factor);

  Matrix6d motion = Matrix6d::Zero();
  Eigen::Matrix<double, 6, Eigen::Dynamic> cross;
  Eigen::MatrixXd own;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_CALIBRATION_EQUATIONS_H_
