// Which way is down and which is forward in a body frame. The frame is the user's, no axis of it
// has a meaning of its own: x forward and z up, z forward and y down, or any other.
#ifndef RIGEL_CORE_BODY_AXES_H_
#define RIGEL_CORE_BODY_AXES_H_

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "rigel/core/rig.h"

namespace rigel {

// Unit vectors in the body frame, perpendicular to one another.
struct BodyAxes {
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();

  Eigen::Vector3d Right() const { return down.cross(forward); }
};

// The axes as far as they are stated, for the rest those that the cameras of the rig suggest:
//   down     the body axis (+x, -x, ... -z) nearest to the mean of the cameras' down directions, a
//            stated forward direction's own axis left out
//   forward  among the body axes across `down` the one nearest to the mean of the cameras' optical
//            axes, where that is longer than half: they look the same way. Cameras all round have
//            no mean: then +x where down is -z, +z where down is +y, as nearly all such bodies
//            have it, else the axis nearest to the first camera's optical axis.
// A stated `forward` is taken across `down`. False with a message if both are stated and within 30
// degrees of one line. A rig without cameras: y down, z forward.
bool ResolveBodyAxes(const Rig& rig, const std::optional<Eigen::Vector3d>& down,
                     const std::optional<Eigen::Vector3d>& forward, BodyAxes* axes,
                     std::string* error);

// How far the mean of the cameras' down directions is from `down`, radians. 0 without cameras.
double CamerasOffDown(const Rig& rig, const Eigen::Vector3d& down);

// "+y", "-z", "x" or three numbers "0,0.1,-1", whose length does not matter. False if it is
// neither; *direction is a unit vector.
bool ParseDirection(std::string_view text, Eigen::Vector3d* direction);

// What ParseDirection() reads: "-z" of a body axis, else three numbers.
std::string DirectionText(const Eigen::Vector3d& direction);

}  // namespace rigel

#endif  // RIGEL_CORE_BODY_AXES_H_
