// What contradicts the rig: words for a person to look into a calibration. Nothing here changes an
// estimate.
#ifndef RIGEL_REFINE_RIG_DOUBTS_H_
#define RIGEL_REFINE_RIG_DOUBTS_H_

#include <functional>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/refine/refine.h"

namespace rigel {

enum class RigDoubtKind {
  kFrozen,   // camera1 shows the same image twice
  kFewFit,   // few of the matches between camera1 and camera2 fit
  kSwapped,  // more would fit if the two were swapped
};

// What in a pair contradicts its rig.
struct RigDoubt {
  RigDoubtKind kind = RigDoubtKind::kFewFit;
  int camera1 = 0;  // at most camera2
  int camera2 = 0;
  std::string message;  // "cameras 0-1: 12 of 760 fit; are they swapped, ..."
};

// Camera pairs with fewer rows tell nothing.
inline constexpr int kMinDoubtRows = 20;
// The share of a camera pair's matches that fit is far below the largest one's if it is less than
// this part of it, ...
inline constexpr double kFewFit = 0.25;
// ... and that one is at least so large.
inline constexpr double kMostFit = 0.4;

// Of a refinement of the pair's matches with this scale, in this order:
//   - a frozen camera: nearly all of its intra-camera matches stay where they are to within
//     kMinMatchNoisePx (times PixelUnit()), and half of those of another camera move by ten times
//     that;
//   - the matches between two cameras, or of one, of which far fewer fit than of the others;
//   - two cameras with which the matches fit better when they are swapped: their poses, or their
//     poses and intrinsics. Tried where the matches between them do not fit, or where they fit and
//     do not determine |t| either, although the rig moves: a mirrored baseline is explained away by
//     a motion so long that no baseline matters.
// Where the prior is doubted it explains what fits badly, and that is not told.
// `inliers_with` estimates the motion of a pair anew and returns how many matches fit, 0 if there
// is no motion; it need not look long: kMaxSwapIterations of RANSAC.
inline constexpr int kMaxSwapIterations = 500;
std::vector<RigDoubt> FindRigDoubts(const FramePair& pair, ScaleMode scale, bool prior_is_doubted,
                                    const RefineSummary& refine,
                                    const std::function<int(const FramePair&)>& inliers_with);

}  // namespace rigel

#endif  // RIGEL_REFINE_RIG_DOUBTS_H_
