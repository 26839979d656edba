#include "rigel/refine/scale_search.h"

#include <limits>

namespace rigel {

void ChooseTranslationScale(const GroupedMatches& matches, double threshold_px, Pose* pose) {
  Pose candidate = *pose;
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= 6; ++k) {
    int inliers = 0;
    const double score = matches.Score(candidate, threshold_px, best, &inliers);
    if (score < best) {
      best = score;
      pose->t = candidate.t;
    }
    candidate.t *= 4.0;
  }
}

}  // namespace rigel
