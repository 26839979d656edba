// Trajectory files as the KITTI odometry benchmark and TUM's tools have them; evo reads both.
//
//   KITTI  R11 R12 R13 X R21 R22 R23 Y R31 R32 R33 Z    rows of the 3x4 matrix world_from_body
//   TUM    TIME X Y Z QX QY QZ QW                       seconds, metres, unit quaternion
//
// One line a pose, columns parted by one blank. Numbers are the shortest that read back as the same
// doubles.
#ifndef RIGEL_PROBLEMS_IO_TRAJECTORY_FILE_H_
#define RIGEL_PROBLEMS_IO_TRAJECTORY_FILE_H_

#include <string>
#include <vector>

#include "rigel/core/body_axes.h"
#include "rigel/core/pose.h"

namespace rigel {

// No comments: the benchmark's own reader does not accept any.
std::string FormatKittiTrajectory(const std::vector<Pose>& world_from_body);

// Begins with a comment line that states the axes of the body, "# body: down +y, forward +z", which
// a plot from above needs. Without times (an empty list) the poses are numbered 0, 1, ..., which a
// second comment line states.
std::string FormatTumTrajectory(const std::vector<Pose>& world_from_body,
                                const std::vector<double>& times, const BodyAxes& axes);

// The name of the file of one of `count` trajectories: `path` itself if there is one only, else
// with "_0", "_1", ... before its extension. `truth`: with "_truth" before that.
std::string TrajectoryPath(const std::string& path, size_t index, size_t count, bool truth);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_TRAJECTORY_FILE_H_
