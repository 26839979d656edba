#include "rigel/refine/least_squares/calibration_equations.h"

#include "rigel/refine/least_squares/normal_equations.h"

namespace rigel {
namespace {

// The errors of the two cameras of a group.
constexpr int kPairErrors = 2 * kCameraErrors;
using PairMatrix = Eigen::Matrix<double, kPairErrors, kPairErrors>;

// What rows of one camera pair add.
struct PairSums {
  Matrix6d motion = Matrix6d::Zero();
  Eigen::Matrix<double, 6, kPairErrors> cross = Eigen::Matrix<double, 6, kPairErrors>::Zero();
  PairMatrix own = PairMatrix::Zero();

  void Add(const SampsonSums& sums, double factor, const ByMotionMatrix& M,
           const ByCalibrationMatrix& E) {
    const Eigen::Map<const Eigen::Matrix<double, 9, 9>> H(sums.H);
    const ByCalibrationMatrix HE = factor * H * E;
    motion += factor * M.transpose() * H * M;
    cross += M.transpose() * HE;
    own += E.transpose() * HE;
  }
};

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
    E->col(kPairErrors - 1) =
        Eigen::Map<const Eigen::Matrix<double, 9, 1>>(change.data()) / p.squaredNorm();
  }
}

}  // namespace

void CalibrationEquations::Add(const SampsonKernelOptions& options, const GroupedMatches& matches,
                               const MatchGroup& group, const double* weights, const Pose& pose,
                               double factor) {
  const RowMajor3d F = matches.Fundamental(group, pose);
  const RowArrays rows = matches.Rows(group);
  const ByMotionMatrix M = FundamentalByMotion(matches, group, pose, false);
  ByCalibrationMatrix E = FundamentalByCalibration(matches, group, pose);
  PairSums pair;
  if (HasLensError(matches.rig().cameras[group.camera1]) ||
      HasLensError(matches.rig().cameras[group.camera2])) {
    for (int i = 0; i < group.size; ++i) {
      if (!(weights[i] > 0)) continue;
      SampsonSums sums;
      SumSampson(options, RowsFrom(rows, i, 1), weights + i, F.data(), Rounding2(F),
                 SampsonParts::kAll, &sums);
      SetFocalColumns(matches, group.begin + i, F, &E);
      pair.Add(sums, factor, M, E);
    }
  } else {
    SampsonSums sums;
    SumSampson(options, rows, weights, F.data(), Rounding2(F), SampsonParts::kAll, &sums);
    pair.Add(sums, factor, M, E);
  }
  motion += pair.motion;
  const int at[2] = {kCameraErrors * group.camera1, kCameraErrors * group.camera2};
  for (int a = 0; a < 2; ++a) {
    cross.middleCols<kCameraErrors>(at[a]) +=
        pair.cross.middleCols<kCameraErrors>(kCameraErrors * a);
    for (int c = 0; c < 2; ++c) {
      own.block<kCameraErrors, kCameraErrors>(at[a], at[c]) +=
          pair.own.block<kCameraErrors, kCameraErrors>(kCameraErrors * a, kCameraErrors * c);
    }
  }
}

}  // namespace rigel
