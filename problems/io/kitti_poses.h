// Trajectories of the KITTI odometry benchmark.
//
// One text file a sequence, one line a frame: 12 numbers, the rows of the 3x4 matrix
// world_from_camera of the left camera (+z forward, +x right, +y down), metres.
#ifndef RIGEL_PROBLEMS_IO_KITTI_POSES_H_
#define RIGEL_PROBLEMS_IO_KITTI_POSES_H_

#include <string>
#include <vector>

#include "rigel/core/pose.h"

namespace rigel {

// Line k is the pose of frame k. Rotations are made orthonormal; an error of up to 1e-3 is
// accepted. False with a message that names file and line if the file cannot be read, has no pose
// or breaks the format. There are no comments, and blank lines only at the end.
bool ReadKittiPoses(const std::string& path, std::vector<Pose>* world_from_camera,
                    std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_KITTI_POSES_H_
