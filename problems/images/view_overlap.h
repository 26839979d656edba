// Which cameras of a rig see the same things.
#ifndef RIGEL_PROBLEMS_IMAGES_VIEW_OVERLAP_H_
#define RIGEL_PROBLEMS_IMAGES_VIEW_OVERLAP_H_

#include <utility>
#include <vector>

#include "rigel/core/rig.h"

namespace rigel {

// The share of the pixels of camera i, 0 to 1, whose points camera j sees too: the largest of those
// for points at a few distances, from some metres to far away. Pixels without a ray do not count,
// nor do the corners beside the image circle of a fisheye.
// The images have sizes.
double ViewShare(const Rig& rig, int i, int j);

// The pairs i < j of cameras of which one sees at least 2 percent of what the other sees.
std::vector<std::pair<int, int>> OverlappingCameras(const Rig& rig);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_VIEW_OVERLAP_H_
