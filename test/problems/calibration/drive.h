// Motions of a simulated drive, for the tests of the calibration.
#ifndef RIGEL_TEST_PROBLEMS_CALIBRATION_DRIVE_H_
#define RIGEL_TEST_PROBLEMS_CALIBRATION_DRIVE_H_

#include <cmath>
#include <cstdint>
#include <vector>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/core/random.h"
#include "rigel/problems/calibration/prior_calibration.h"

namespace rigel {

inline const Eigen::Vector3d kY = Eigen::Vector3d::UnitY();
inline const Eigen::Matrix3d kTilted = ExpSO3({DegToRad(1.2), 0, DegToRad(1.6)});  // 2 degrees

struct DriveOptions {
  int pairs = 100;
  double yaw_deg = 2.0;        // of the largest turns between two frames
  double vibration_deg = 0.1;  // 1-sigma of rotations about each axis
  double bumps_deg = 0.5;      // 1-sigma of the directions of translation
  double pitch_deg = 0.0;      // of hills: largest turns about X
  double gravity_deg = 0.0;    // 1-sigma of the stated directions
  int outliers = 0;            // motions of anything
};

// A drive whose plane has the normal A' Y in the body frame, and whose stated gravity, C' times the
// body's, is Y on level ground but for C.
inline std::vector<CalibrationMotion> Drive(const DriveOptions& options, const Eigen::Matrix3d& A,
                                            const Eigen::Matrix3d& C, uint64_t seed) {
  Random random(seed);
  std::vector<CalibrationMotion> motions;
  Eigen::Matrix3d body_from_world = A.transpose();  // the body's Y is the world's but for A
  const auto stated = [&](const Eigen::Matrix3d& from_world) {
    const Eigen::Matrix3d noise = ExpSO3(DegToRad(options.gravity_deg) * random.NormalVector3());
    return Eigen::Vector3d(C.transpose() * noise * from_world * kY);
  };
  Eigen::Vector3d gravity = stated(body_from_world);
  for (int k = 0; k < options.pairs; ++k) {
    const double yaw = DegToRad(options.yaw_deg) * std::sin(0.1 * k);
    const double pitch = DegToRad(options.pitch_deg) * std::cos(0.13 * k);
    CalibrationMotion motion;
    const Eigen::Matrix3d turn = ExpSO3({pitch, yaw, 0});
    const Eigen::Matrix3d true_R = A.transpose() * turn * A;
    motion.pose.R = ExpSO3(DegToRad(options.vibration_deg) * random.NormalVector3()) * true_R;
    const Eigen::Matrix3d bump = ExpSO3(DegToRad(options.bumps_deg) * random.NormalVector3());
    motion.pose.t = A.transpose() * bump * RotationY(0.5 * yaw) * Eigen::Vector3d(0, 0, -1);
    body_from_world = true_R * body_from_world;
    motion.prior.gravity1 = gravity;
    motion.prior.gravity2 = gravity = stated(body_from_world);
    if (k < options.outliers) {
      motion.pose.R = ExpSO3(0.05 * random.NormalVector3());
      motion.pose.t = random.UnitVector3();
    }
    motions.push_back(motion);
  }
  return motions;
}

inline double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(AngleBetween(a, b));
}

}  // namespace rigel

#endif  // RIGEL_TEST_PROBLEMS_CALIBRATION_DRIVE_H_
