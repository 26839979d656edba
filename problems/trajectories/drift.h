// How far a trajectory drifts from the truth: KITTI's metric, errors of single steps, of the end.
//
// KITTI's metric (Geiger, Lenz, Urtasun 2012; evaluate_odometry.cpp of its devkit) is a mean over
// segments. They begin at each 10th frame and have the lengths L of 100, 200, ..., 800 m of the
// true path. A segment ends at the first frame that is more than L farther. Its error is that of
// the motion over it, divided by L.
#ifndef RIGEL_PROBLEMS_TRAJECTORIES_DRIFT_H_
#define RIGEL_PROBLEMS_TRAJECTORIES_DRIFT_H_

#include <optional>
#include <vector>

#include "rigel/core/pose.h"
#include "rigel/core/statistics.h"

namespace rigel {

// Means over segments of one length, or of all.
struct SegmentDrift {
  double length = 0.0;  // metres; 0 for all
  int segments = 0;
  double translation = 0.0;  // fraction of the length
  double rotation = 0.0;     // radians a metre
};

struct Drift {
  double path_length = 0.0;  // of the truth, metres
  int start_step = 10;       // segments start at each so many frames
  // Only lengths with a segment. Empty if the path is no longer than a metre.
  std::vector<SegmentDrift> by_length;
  SegmentDrift all;

  // Of each motion from a frame to the next: |t| of true^-1 * estimate (metres), and its angle
  // (radians). evo calls it RPE over one frame.
  std::optional<Statistics> step_translation, step_rotation;

  // Of the last pose, the first ones being the same: metres and radians; over the path length the
  // translation's is what the table gives in percent.
  double end_translation = 0.0, end_rotation = 0.0;
  // Of the first pose seen from the last, X_last = R X_first + t: metres.
  double start_translation = 0.0;
};

// Both start at the identity and have the same number of poses, at least two. If the true path is
// at most 100 m long, the lengths are 10, 20, ..., 80 m; if it is at most 10 m, 1, ..., 8 m.
// Segments then start at every frame. Such figures are not KITTI's and show more of the noise of
// single motions.
Drift ComputeDrift(const std::vector<Pose>& truth, const std::vector<Pose>& estimate);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_TRAJECTORIES_DRIFT_H_
