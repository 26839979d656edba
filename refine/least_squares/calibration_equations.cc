#include "rigel/refine/least_squares/calibration_equations.h"

#include <algorithm>

#include "rigel/refine/least_squares/normal_equations.h"

namespace rigel {
namespace {

// The derivatives by the errors of the two cameras of a group.
using PairDerivatives = Eigen::Matrix<double, 6, 2 * kCameraErrors>;

// Those that the sums of rows of one camera pair give.
PairDerivatives DerivativesOf(const SampsonSums& sums, const ByMotionMatrix& M,
                              const ByCalibrationMatrix& E) {
  const Eigen::Map<const Eigen::Matrix<double, 9, 9>> H(sums.H);
  return M.transpose() * H * E;
}

// A lens that is no pinhole and whose focal lengths have a stated error.
bool HasLensError(const RigCamera& camera) {
  return !camera.intrinsics.IsPinhole() && camera.focal_sigma > 0;
}

// Sets the columns of E of focal lengths that act on this row alone: changes of F that do to the
// row's constraint what FocalShift() does to its points.
void SetFocalColumns(const GroupedMatches& matches, int k, const RowMajor3d& F,
                     ByCalibrationMatrix* E) {
  const Match& match = matches.matches()[k];
  const RigCamera& camera1 = matches.rig().cameras[match.camera1];
  const RigCamera& camera2 = matches.rig().cameras[match.camera2];
  if (HasLensError(camera1)) {
    const Eigen::Vector3d p = matches.Point1(k).p;
    const RowMajor3d change = F * FocalShift(camera1, match.pixel1) * p.transpose();
    E->col(kCameraErrors - 1) =
        Eigen::Map<const Eigen::Matrix<double, 9, 1>>(change.data()) / p.squaredNorm();
  }
  if (HasLensError(camera2)) {
    const Eigen::Vector3d p = matches.Point2(k).p;
    const RowMajor3d change = p * FocalShift(camera2, match.pixel2).transpose() * F;
    E->col(2 * kCameraErrors - 1) =
        Eigen::Map<const Eigen::Matrix<double, 9, 1>>(change.data()) / p.squaredNorm();
  }
}

}  // namespace

UnalignedMatrix<kCameraErrors> CalibrationVariances(const RigCamera& camera) {
  UnalignedMatrix<kCameraErrors> variances;
  variances.head<3>().setConstant(camera.rotation_sigma * camera.rotation_sigma);
  variances.segment<3>(3).setConstant(camera.position_sigma * camera.position_sigma);
  variances(6) = camera.focal_sigma * camera.focal_sigma;
  return variances;
}

bool StatesCalibrationErrors(const Rig& rig) {
  return std::any_of(rig.cameras.begin(), rig.cameras.end(), [](const RigCamera& camera) {
    return !CalibrationVariances(camera).isZero(0.0);
  });
}

void AddCalibrationDerivatives(const SampsonKernelOptions& options, const GroupedMatches& matches,
                               const MatchGroup& group, const double* weights, const Pose& pose,
                               double factor, CalibrationDerivatives* sum) {
  const RowMajor3d F = matches.Fundamental(group, pose);
  const RowArrays rows = matches.Rows(group);
  const ByMotionMatrix M = FundamentalByMotion(matches, group, pose, false);
  ByCalibrationMatrix E = FundamentalByCalibration(matches, group, pose);
  PairDerivatives of_group = PairDerivatives::Zero();
  if (HasLensError(matches.rig().cameras[group.camera1]) ||
      HasLensError(matches.rig().cameras[group.camera2])) {
    for (int i = 0; i < group.size; ++i) {
      if (!(weights[i] > 0)) continue;
      SampsonSums sums;
      SumSampson(options, RowsFrom(rows, i, 1), weights + i, F.data(), Rounding2(F),
                 SampsonParts::kAll, &sums);
      SetFocalColumns(matches, group.begin + i, F, &E);
      of_group += DerivativesOf(sums, M, E);
    }
  } else {
    SampsonSums sums;
    SumSampson(options, rows, weights, F.data(), Rounding2(F), SampsonParts::kAll, &sums);
    of_group = DerivativesOf(sums, M, E);
  }
  of_group *= factor;
  sum->middleCols<kCameraErrors>(kCameraErrors * group.camera1) +=
      of_group.leftCols<kCameraErrors>();
  sum->middleCols<kCameraErrors>(kCameraErrors * group.camera2) +=
      of_group.rightCols<kCameraErrors>();
}

}  // namespace rigel
