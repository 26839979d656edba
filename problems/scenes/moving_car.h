// A car that moves by itself in a synthetic scene (synthetic.h).
#ifndef RIGEL_PROBLEMS_SCENES_MOVING_CAR_H_
#define RIGEL_PROBLEMS_SCENES_MOVING_CAR_H_

#include <Eigen/Core>

#include "rigel/core/match.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"
#include "rigel/core/rig.h"

namespace rigel {

// A box on the ground in the frame of view 1 and its motion between the frames.
struct Car {
  Eigen::Matrix3d axes;  // lengthwise, across, down
  Eigen::Vector3d centre;
  Pose motion;  // of its points
};

// A car in front of the rig; `down` is a unit vector of the body frame.
Car DrawCar(const Eigen::Vector3d& down, Random* random);

// Sets the pixels of the match to a random point of the car; its cameras are given. `truth` is the
// motion of the rig. False if kMaxDraws points are not seen by both cameras.
bool DrawCarMatch(const Car& car, const Rig& rig, const Pose& truth, Random* random, Match* match);

// Draws of a point before giving up: a motion that leaves fewer than one point in a thousand in
// view is out of view.
inline constexpr int kMaxDraws = 1000;

// Metres in front of a camera: what is nearer is not seen.
inline constexpr double kMinDepth = 0.1;

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_MOVING_CAR_H_
