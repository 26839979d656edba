#include "rigel/refine/least_squares/calibration_equations.h"

#include "rigel/refine/least_squares/normal_equations.h"

namespace rigel {

void AddCalibrationDerivatives(const SampsonKernelOptions& options, const GroupedMatches& matches,
                               const MatchGroup& group, const double* weights, const Pose& pose,
                               double factor, CalibrationDerivatives* sum) {
  const RowMajor3d F = matches.Fundamental(group, pose);
  SampsonSums sums;
  SumSampson(options, matches.Rows(group), weights, F.data(), Rounding2(F), SampsonParts::kAll,
             &sums);
  const Eigen::Map<const Eigen::Matrix<double, 9, 9>> H(sums.H);
  const Eigen::Matrix<double, 6, 2 * kCameraErrors> of_group =
      factor * FundamentalByMotion(matches, group, pose, false).transpose() * H *
      FundamentalByCalibration(matches, group, pose);
  sum->middleCols<kCameraErrors>(kCameraErrors * group.camera1) +=
      of_group.leftCols<kCameraErrors>();
  sum->middleCols<kCameraErrors>(kCameraErrors * group.camera2) +=
      of_group.rightCols<kCameraErrors>();
}

}  // namespace rigel
