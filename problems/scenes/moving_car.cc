#include "rigel/problems/scenes/moving_car.h"

#include <cmath>

#include "rigel/core/angles.h"

namespace rigel {
namespace {

// Metres: half the length, width and height of the car, those of synthetic.h.
const Eigen::Vector3d kHalfSize(2.25, 0.9, 0.75);
// Metres, the distance of its centre from the rig; radians, its bearing from straight ahead;
// metres, the way that it moves; degrees, the angle that it turns by: these are ranges of
// synthetic.h, and the bearing keeps it in view of a camera that looks ahead.
constexpr double kNearest = 5.0, kFarthest = 15.0;
constexpr double kMaxBearing = 0.4;
constexpr double kShortestWay = 0.5, kLongestWay = 2.0;
constexpr double kMaxTurnDeg = 3.0;
// Metres. Cameras are a metre and a half above the ground, the centre of the car half as much.
constexpr double kCentreBelowRig = 0.75;

}  // namespace

Car DrawCar(const Eigen::Vector3d& down, Random* random) {
  Car car;
  const Eigen::Vector3d ahead =
      (Eigen::Vector3d::UnitZ() - down.z() * down).normalized();  // a camera looks along z
  const Eigen::Vector3d right = down.cross(ahead);
  const auto horizontal = [&](double angle) -> Eigen::Vector3d {
    return std::cos(angle) * ahead + std::sin(angle) * right;
  };
  const double distance = random->Uniform(kNearest, kFarthest);
  const double bearing = random->Uniform(-kMaxBearing, kMaxBearing);
  car.centre = distance * horizontal(bearing) + kCentreBelowRig * down;
  const Eigen::Vector3d length = horizontal(random->Uniform(0.0, 2.0 * kPi));
  car.axes << length, down.cross(length), down;
  const double way = random->Uniform(kShortestWay, kLongestWay);
  const Eigen::Vector3d shift = way * horizontal(random->Uniform(0.0, 2.0 * kPi));
  car.motion.R = ExpSO3(DegToRad(random->Uniform(-kMaxTurnDeg, kMaxTurnDeg)) * down);
  car.motion.t = car.centre + shift - car.motion.R * car.centre;
  return car;
}

bool DrawCarMatch(const Car& car, const Rig& rig, const Pose& truth, Random* random, Match* match) {
  const RigCamera& camera1 = rig.cameras[match->camera1];
  const RigCamera& camera2 = rig.cameras[match->camera2];
  const Pose motion = truth * car.motion;
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const double x = random->Uniform(-kHalfSize.x(), kHalfSize.x());
    const double y = random->Uniform(-kHalfSize.y(), kHalfSize.y());
    const double z = random->Uniform(-kHalfSize.z(), kHalfSize.z());
    const Eigen::Vector3d X = car.centre + car.axes * Eigen::Vector3d(x, y, z);
    const Eigen::Vector3d X1 = camera1.Q.transpose() * (X - camera1.s);
    const Eigen::Vector3d X2 = camera2.Q.transpose() * (motion * X - camera2.s);
    if (!(X1.z() > kMinDepth) || !(X2.z() > kMinDepth)) continue;
    match->pixel1 = camera1.intrinsics.Project(X1);
    match->pixel2 = camera2.intrinsics.Project(X2);
    if (camera1.intrinsics.InImage(match->pixel1) && camera2.intrinsics.InImage(match->pixel2)) {
      return true;
    }
  }
  return false;
}

}  // namespace rigel
