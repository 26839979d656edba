// Trajectories of the KITTI odometry benchmark, as motions to simulate.
//
// One text file a sequence, one line a frame: 12 numbers, the rows of the 3x4 matrix
// world_from_camera of the left camera (+z forward, +x right, +y down), metres.
#ifndef RIGEL_PROBLEMS_IO_KITTI_POSES_H_
#define RIGEL_PROBLEMS_IO_KITTI_POSES_H_

#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/pose.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {

// Rotations off orthonormal by up to 1e-3 are made orthonormal. False with a message that names
// file and line if the file cannot be read, has no pose or is not of the format: line k is that of
// frame k, so that there is no comment, and no blank line but at the end.
bool ReadKittiPoses(const std::string& path, std::vector<Pose>* world_from_camera,
                    std::string* error);

// Where a frame pair's motion comes from.
struct DrivenMotion {
  std::string sequence;
  Pose world_from_body1, world_from_body2;

  Pose body2_from_body1() const { return world_from_body2.Inverse() * world_from_body1; }
};

// Of the motions between consecutive poses the first and each `every`-th after it, of each of the
// files *.txt of a directory, in byte order of their names, which name the sequences; the body is
// the left camera. False with a message if a file cannot be read or there is no motion.
bool ReadDrivenMotions(const std::string& directory, int every, std::vector<DrivenMotion>* motions,
                       std::string* error);

// Pair number `index` of the scene (rigel/problems/scenes/synthetic.h) with that motion and sequence.
// "Down" is the world's Y: that of the first camera frame, which is level to a degree or two.
bool MakeDrivenPair(const SceneOptions& options, int index, const DrivenMotion& motion,
                    FramePair* pair, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_KITTI_POSES_H_
