#include "rigel/refine/least_squares/calibration_equations.h"

#include "rigel/refine/least_squares/normal_equations.h"

namespace rigel {

void CalibrationEquations::Add(const SampsonKernelOptions& options, const GroupedMatches& matches,
                               const MatchGroup& group, const double* weights, const Pose& pose,
                               double factor) {
  const RowMajor3d F = matches.Fundamental(group, pose);
  SampsonSums sums;
  SumSampson(options, matches.Rows(group), weights, F.data(), Rounding2(F), SampsonParts::kAll,
             &sums);
  const Eigen::Map<const Eigen::Matrix<double, 9, 9>> H(sums.H);
  const ByMotionMatrix M = FundamentalByMotion(matches, group, pose, false);
  const ByCalibrationMatrix E = FundamentalByCalibration(matches, group, pose);
  const ByCalibrationMatrix HE = factor * H * E;
  motion += factor * M.transpose() * H * M;
  const Eigen::Matrix<double, 6, 2 * kCameraErrors> cross_here = M.transpose() * HE;
  const Eigen::Matrix<double, 2 * kCameraErrors, 2 * kCameraErrors> own_here = E.transpose() * HE;
  const int at[2] = {kCameraErrors * group.camera1, kCameraErrors * group.camera2};
  for (int a = 0; a < 2; ++a) {
    cross.middleCols<kCameraErrors>(at[a]) +=
        cross_here.middleCols<kCameraErrors>(kCameraErrors * a);
    for (int c = 0; c < 2; ++c) {
      own.block<kCameraErrors, kCameraErrors>(at[a], at[c]) +=
          own_here.block<kCameraErrors, kCameraErrors>(kCameraErrors * a, kCameraErrors * c);
    }
  }
}

}  // namespace rigel
