#include "rigel/refine/least_squares/fundamental_derivatives.h"

#include <Eigen/Geometry>

#include "rigel/core/epipolar.h"

namespace rigel {
namespace {

// F_ij = l.(b x r), l column i of A_2 and r column j of R A_1.
struct Factors {
  Factors(const GroupedMatches::Places& at, const Pose& pose)
      : s1(at.s1), b(Baseline(pose, at.s1, at.s2)), left(at.A2), right(pose.R * at.A1) {}
  Eigen::Vector3d s1, b;
  Eigen::Matrix3d left, right;
};

// By the turns and shifts of camera1 and of camera2 in the frame of f2.
Eigen::Matrix<double, 9, 12> ByPlaces(const Factors& f, const Eigen::Matrix3d& R) {
  Eigen::Matrix<double, 9, 12> D;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d l = f.left.col(i);
    const Eigen::Vector3d lb = l.cross(f.b);
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d r = f.right.col(j);
      const Eigen::Vector3d rl = r.cross(l);
      D.row(3 * i + j) << (R.transpose() * r.cross(lb)).transpose(),
          (R.transpose() * rl).transpose(), l.cross(f.b.cross(r)).transpose(), -rl.transpose();
    }
  }
  return D;
}

}  // namespace

RowMajor3d FundamentalOf(const GroupedMatches& matches, const MatchGroup& group, const Pose& pose,
                         bool of_rays) {
  if (!of_rays) return matches.Fundamental(group, pose);
  const Factors f(matches.PlacesOf(group, pose, true), pose);
  return f.left.transpose() * Skew(f.b) * f.right;
}

ByMotionMatrix FundamentalByMotion(const GroupedMatches& matches, const MatchGroup& group,
                                   const Pose& pose, bool of_rays) {
  const Factors f(matches.PlacesOf(group, pose, of_rays), pose);
  const Eigen::Vector3d Rs = pose.R * f.s1;
  ByMotionMatrix D;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d l = f.left.col(i);
    const Eigen::Vector3d lb = l.cross(f.b);
    for (int j = 0; j < 3; ++j) {
      // r depends on R, b on R and t.
      const Eigen::Vector3d r = f.right.col(j);
      const Eigen::Vector3d rl = r.cross(l);
      D.row(3 * i + j) << (Rs.cross(rl) + r.cross(lb)).transpose(), rl.transpose();
    }
  }
  if (matches.HasTimes()) {
    const Eigen::Matrix<double, 9, 12> by_places = ByPlaces(f, pose.R);
    D += by_places.leftCols<6>() * matches.PlaceByMotion(group.camera1, pose);
    D += by_places.rightCols<6>() * matches.PlaceByMotion(group.camera2, pose);
  }
  return D;
}

ByCalibrationMatrix FundamentalByCalibration(const GroupedMatches& matches, const MatchGroup& group,
                                             const Pose& pose) {
  const Factors f(matches.PlacesOf(group, pose, false), pose);
  const Eigen::Matrix<double, 9, 12> by_places = ByPlaces(f, pose.R);
  ByCalibrationMatrix D = ByCalibrationMatrix::Zero();
  D.leftCols<6>() = by_places.leftCols<6>();
  D.middleCols<6>(kCameraErrors) = by_places.rightCols<6>();
  const RowMajor3d F = matches.Fundamental(group, pose);
  const auto is_pinhole = [&matches](int camera) {
    return matches.rig().cameras[camera].intrinsics.IsPinhole();
  };
  const bool pinhole1 = is_pinhole(group.camera1), pinhole2 = is_pinhole(group.camera2);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      // U = diag(1 / fx, 1 / fy, 1).
      if (pinhole1 && j < 2) D(3 * i + j, 6) = -F(i, j);
      if (pinhole2 && i < 2) D(3 * i + j, kCameraErrors + 6) = -F(i, j);
    }
  }
  return D;
}

Eigen::Vector3d FocalShift(const RigCamera& camera, const Pixel& pixel) {
  const Camera& c = camera.intrinsics;
  return -(RowPointOf(camera, pixel).J * (pixel - Pixel(c.cx(), c.cy())));
}

}  // namespace rigel
