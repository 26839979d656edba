// Pose graphs of g2o from estimated motions.
//
//   VERTEX_SE3:QUAT ID X Y Z QX QY QZ QW
//   EDGE_SE3:QUAT ID1 ID2 X Y Z QX QY QZ QW I11 I12 ... I16 I22 ... I66
//   # comment
//
// Conventions of vertices, edges and information: rigel/refine/between_factor.h. All vertices come
// first. Numbers have 17 digits, so that they read back as the same doubles.
#ifndef RIGEL_PROBLEMS_TRAJECTORIES_G2O_FILE_H_
#define RIGEL_PROBLEMS_TRAJECTORIES_G2O_FILE_H_

#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/trajectories/trajectory.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

// Metres. Any length would do, as the edge has no information on it.
inline constexpr double kLengthWithoutScale = 1.0;

// Chains the motions: pair k leads from one pose to the next, where pair k + 1 starts. `pairs` and
// `estimates` go together; `positions` has the place of each pair in the drive, increasing, or is
// empty where they follow each other. Each trajectory starts with a vertex at the identity; the
// next starts
//   - after a pair without an edge: no refined motion, or its rotation is not observable, or the
//     direction of its translation is not and it does not stand still (StandsStill());
//   - at a pair whose position does not follow that of the pair before, whose sequence is another,
//     or that starts at another time than the pair before ended, if both state their times.
// Each of these is told in one line of printable text in *notes and as a comment. A pose that no
// edge reaches has no vertex.
//
// Where nothing says the length of the rig's motion an edge has no information on it, yet needs
// one: the distance of the pair's prior, else kLengthWithoutScale. A note counts these edges.
//
// Where the rig stands still the edge has the rotation of the estimate, its centre at rest and the
// covariance of the estimate; where |t| is not determined at all, kStillMetres for the translation.
// A last note counts these edges.
std::string FormatG2o(const std::vector<FramePair>& pairs,
                      const std::vector<MotionEstimate>& estimates,
                      const std::vector<int>& positions, std::vector<std::string>* notes);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_TRAJECTORIES_G2O_FILE_H_
