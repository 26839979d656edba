// Motions of real drives for simulation, from trajectories of the KITTI odometry benchmark
// (problems/io/kitti_poses.h).
#ifndef RIGEL_PROBLEMS_SCENES_DRIVEN_MOTION_H_
#define RIGEL_PROBLEMS_SCENES_DRIVEN_MOTION_H_

#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/pose.h"
#include "rigel/problems/scenes/street.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {

// Where a frame pair's motion comes from.
struct DrivenMotion {
  std::string sequence;
  Pose world_from_body1, world_from_body2;

  Pose body2_from_body1() const { return world_from_body2.Inverse() * world_from_body1; }
};

// Reads one file, or the files *.txt of a directory, in byte order of their names, which are the
// sequences. Takes the first motion between consecutive poses of a file and each `every`-th after
// it. The body is the left camera. False with a message if a file cannot be read or there is no
// motion.
bool ReadDrivenMotions(const std::string& path, int every, std::vector<DrivenMotion>* motions,
                       std::string* error);

// Pair number `index` of the scene with that motion and sequence.
// "Down" is the world's Y: that of the first camera frame, which is level to a degree or two.
bool MakeDrivenPair(const SceneOptions& options, int index, const DrivenMotion& motion,
                    FramePair* pair, std::string* error);

// The same of the street. The motion is that of the body's origin, the axes are those of the body:
// what KITTI's camera calls forward is forward there, and down is down.
bool MakeDrivenPair(const StreetOptions& options, int index, const DrivenMotion& motion,
                    FramePair* pair, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_DRIVEN_MOTION_H_
