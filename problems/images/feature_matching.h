// Matches of the key points of two images.
#ifndef RIGEL_PROBLEMS_IMAGES_FEATURE_MATCHING_H_
#define RIGEL_PROBLEMS_IMAGES_FEATURE_MATCHING_H_

#include <vector>

#include "rigel/core/match.h"
#include "rigel/problems/images/image_features.h"

namespace rigel {

// Appends the matches of two images: key points that are each other's nearest and pass the ratio
// test. The score is the ratio. A key point with several orientations is one point: a pair of
// pixels occurs once, with its best score. Sorted by pixels.
void AppendMatches(const FeatureOptions& options, int camera1, const ImageFeatures& features1,
                   int camera2, const ImageFeatures& features2, std::vector<Match>* matches);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_FEATURE_MATCHING_H_
