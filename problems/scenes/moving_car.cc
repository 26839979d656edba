#include "rigel/problems/scenes/moving_car.h"

#include <cmath>

#include "rigel/core/angles.h"

namespace rigel {
namespace {

// Metres: half the length, width and height of the car, those of synthetic.h.
const Eigen::Vector3d kHalfSize(2.25, 0.9, kHalfCarHeight);
// Metres, the distance of its centre from the rig; radians, its bearing from straight ahead;
// metres, the way that it moves; degrees, the angle that it turns by: these are ranges of
// synthetic.h, and the bearing keeps it in view of a camera that looks ahead.
constexpr double kNearest = 5.0, kFarthest = 15.0;
constexpr double kMaxBearing = 0.4;
constexpr double kShortestWay = 0.5, kLongestWay = 2.0;
constexpr double kMaxTurnDeg = 3.0;

}  // namespace

Car DrawCar(const BodyAxes& axes, double below, Random* random) {
  Car car;
  const Eigen::Vector3d right = axes.Right();
  const auto horizontal = [&](double angle) -> Eigen::Vector3d {
    return std::cos(angle) * axes.forward + std::sin(angle) * right;
  };
  const double distance = random->Uniform(kNearest, kFarthest);
  const double bearing = random->Uniform(-kMaxBearing, kMaxBearing);
  car.centre = distance * horizontal(bearing) + below * axes.down;
  const Eigen::Vector3d length = horizontal(random->Uniform(0.0, 2.0 * kPi));
  car.axes << length, axes.down.cross(length), axes.down;
  const double way = random->Uniform(kShortestWay, kLongestWay);
  const Eigen::Vector3d shift = way * horizontal(random->Uniform(0.0, 2.0 * kPi));
  car.motion.R = ExpSO3(DegToRad(random->Uniform(-kMaxTurnDeg, kMaxTurnDeg)) * axes.down);
  car.motion.t = car.centre + shift - car.motion.R * car.centre;
  return car;
}

Eigen::Vector3d DrawCarPoint(const Car& car, Random* random) {
  const double x = random->Uniform(-kHalfSize.x(), kHalfSize.x());
  const double y = random->Uniform(-kHalfSize.y(), kHalfSize.y());
  const double z = random->Uniform(-kHalfSize.z(), kHalfSize.z());
  return car.centre + car.axes * Eigen::Vector3d(x, y, z);
}

}  // namespace rigel
