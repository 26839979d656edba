// How errors of the calibration (fundamental_derivatives.h) change the normal equations of the
// motion. Of pinholes both change the Sampson errors through F alone. So the sums of SumSampson()
// serve both. A stated error of the focal lengths of another lens changes them row by row.
#ifndef RIGEL_REFINE_LEAST_SQUARES_CALIBRATION_EQUATIONS_H_
#define RIGEL_REFINE_LEAST_SQUARES_CALIBRATION_EQUATIONS_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/fundamental_derivatives.h"
#include "rigel/refine/least_squares/sampson_kernel.h"

namespace rigel {

// The variances of the errors of a camera that the rig states, and whether it states any.
UnalignedMatrix<kCameraErrors> CalibrationVariances(const RigCamera& camera);
bool StatesCalibrationErrors(const Rig& rig);

// The derivatives of the gradient of the cost, by the motion, by the errors of the cameras: sums
// over matches, kCameraErrors columns for each camera.
using CalibrationDerivatives = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Adds those of SumSampson() of the group at `pose`, times `factor`.
void AddCalibrationDerivatives(const SampsonKernelOptions& options, const GroupedMatches& matches,
                               const MatchGroup& group, const double* weights, const Pose& pose,
                               double factor, CalibrationDerivatives* sum);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_CALIBRATION_EQUATIONS_H_
