// A car that moves by itself in a synthetic scene (synthetic.h, street.h).
#ifndef RIGEL_PROBLEMS_SCENES_MOVING_CAR_H_
#define RIGEL_PROBLEMS_SCENES_MOVING_CAR_H_

#include <Eigen/Core>

#include "rigel/core/body_axes.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"

namespace rigel {

// A box on the ground in the frame of view 1 and its motion between the frames.
struct Car {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // lengthwise, across, down
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Pose motion;  // of its points
};

// A car ahead of the body's origin, its centre `below` metres below it.
Car DrawCar(const BodyAxes& axes, double below, Random* random);

// A random point of it, in the frame of view 1.
Eigen::Vector3d DrawCarPoint(const Car& car, Random* random);

// Metres: half the height of the car.
inline constexpr double kHalfCarHeight = 0.75;

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_MOVING_CAR_H_
