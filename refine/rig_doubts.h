// Finds matches that contradict the rig's calibration, and describes them in messages for the user.
// They do not change an estimate.
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

// One contradiction between the matches of a frame pair and its rig.
struct RigDoubt {
  RigDoubtKind kind = RigDoubtKind::kFewFit;
  int camera1 = 0;  // at most camera2
  int camera2 = 0;
  std::string message;  // "cameras 0-1: 12 of 760 fit; are they swapped, ..."
};

// Camera pairs with fewer matches are not judged.
inline constexpr int kMinDoubtRows = 20;
// Few matches of a camera pair fit if their share is below this part of the largest share, ...
inline constexpr double kFewFit = 0.25;
// ... and the largest share is at least this.
inline constexpr double kMostFit = 0.4;

// Finds the contradictions after a refinement (`refine`), in this order:
//   - A frozen camera: nearly all of its intra-camera matches move by less than kMinMatchNoisePx
//     (times PixelUnit()), and half of those of another camera move by more than ten times that.
//   - Matches between two cameras, or of one camera, of which far fewer fit than of others.
//   - Two cameras with which more matches fit if they are swapped: their poses, or their poses and
//     intrinsics. This is tried if the matches between them do not fit. It is also tried if they
//     fit and |t| is still not determined although the rig moves. A motion so long that no baseline
//     matters then hides a baseline of the wrong sign.
// `length_is_open`: nothing but the matches could say |t|.
// If `prior_is_doubted`, the prior may be the reason that few matches fit. That is then not
// reported.
// `inliers_with` estimates the motion of a pair again and returns the number of inliers, 0 if there
// is no motion. kMaxSwapIterations of RANSAC are enough for it.
inline constexpr int kMaxSwapIterations = 500;
std::vector<RigDoubt> FindRigDoubts(const FramePair& pair, bool length_is_open,
                                    bool prior_is_doubted, const RefineSummary& refine,
                                    const std::function<int(const FramePair&)>& inliers_with);

}  // namespace rigel

#endif  // RIGEL_REFINE_RIG_DOUBTS_H_
