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

// The axes that are stated. Those that are not stated come from the cameras of the rig:
//   down     the body axis (+x, -x, ... -z) nearest to the mean of the cameras' down directions. If
//            `forward` is stated, the axis nearest to it is left out.
//   forward  a body axis perpendicular to `down`. If the cameras look about the same way (the mean
//            of their optical axes is longer than 0.5), the one nearest to that mean. Else, as for
//            cameras all round, +x if down is -z and +z if down is +y, as most such bodies have it.
//            In all other cases the one nearest to the first camera's optical axis.
// Of a stated `forward` the part perpendicular to `down` is taken. False with a message if both are
// stated and within 30 degrees of one line. A rig without cameras: y down, z forward.
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
