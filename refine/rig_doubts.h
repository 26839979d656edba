// What contradicts the rig: words for a person to look into a calibration. Nothing here changes an
// estimate.
#ifndef RIGEL_REFINE_RIG_DOUBTS_H_
#define RIGEL_REFINE_RIG_DOUBTS_H_

#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

// Camera pairs with fewer rows tell nothing.
inline constexpr int kMinDoubtRows = 20;
// The share of a camera pair's matches that fit is far below the largest one's if it is less than
// this part of it, ...
inline constexpr double kFewFit = 0.25;
// ... and that one is at least so large.
inline constexpr double kMostFit = 0.4;

// In this order, of an estimate that EstimateMotion() made of the pair with these options:
//   - a frozen camera: nearly all of its intra-camera matches stay where they are to within
//     kMinMatchNoisePx (times PixelUnit()), and half of those of another camera move by ten times
//     that;
//   - the matches between two cameras, or of one, of which far fewer fit than of the others;
//   - two cameras with which the matches fit better when they are swapped: their poses, or their
//     poses and intrinsics. Tried (at most kMaxSwapIterations of RANSAC) where the matches between
//     them do not fit, or where they fit and do not determine |t| either, although the rig moves: a
//     mirrored baseline is explained away by a motion so long that no baseline matters.
inline constexpr int kMaxSwapIterations = 500;
std::vector<RigDoubt> FindRigDoubts(const EstimateOptions& options, const FramePair& pair,
                                    const MotionEstimate& estimate);

}  // namespace rigel

#endif  // RIGEL_REFINE_RIG_DOUBTS_H_
