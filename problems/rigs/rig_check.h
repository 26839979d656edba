// What looks wrong with a rig: mistakes of calibration files that no number of them shows.
//
// Cameras of a vehicle stand upright, and those of a ring look away from its middle. A rig of which
// neither is so, but both are if its poses are inverted or its quaternions are read as x y z w, was
// written that way.
#ifndef RIGEL_PROBLEMS_RIGS_RIG_CHECK_H_
#define RIGEL_PROBLEMS_RIGS_RIG_CHECK_H_

#include <string>
#include <vector>

#include "rigel/problems/io/rig_file.h"

namespace rigel {

// How far the cameras agree on down, 0 to 1, and how far they look away from their middle, -1 to 1.
struct RigLook {
  double upright = 0.0;
  double outward = 0.0;
};
RigLook LookOf(const Rig& rig);

// The rig if what was read as body_from_camera were camera_from_body.
Rig InvertedRig(const Rig& rig);

// What looks wrong, one line each, with the names of the cameras; empty if nothing does.
// `has_quaternions`: whether the file has quaternions, whose order can be mistaken.
std::vector<std::string> RigWarnings(const RigFile& file, bool has_quaternions);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_RIG_CHECK_H_
