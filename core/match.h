// A matched image point.
#ifndef RIGEL_CORE_MATCH_H_
#define RIGEL_CORE_MATCH_H_

#include "rigel/core/eigen_types.h"

namespace rigel {

// One landmark seen by camera i = camera1 at time 1 and by camera j = camera2 at time 2.
// Pixels are undistorted. `score` says how good the match is; lower is better, as for Lowe's ratio.
// RANSAC draws from the lowest first. If the scores are unknown, all are alike, such as 0. Among
// other scores 0 is not unknown but the best, and NaN is the worst.
struct Match {
  int camera1 = 0;
  Pixel pixel1 = Pixel::Zero();
  int camera2 = 0;
  Pixel pixel2 = Pixel::Zero();
  double score = 0.0;

  bool IsIntra() const { return camera1 == camera2; }
};
static_assert(kSameLayoutEverywhere<Match>, "no member of Match may be aligned");

}  // namespace rigel

#endif  // RIGEL_CORE_MATCH_H_
