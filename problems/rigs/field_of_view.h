// How wide a camera sees.
#ifndef RIGEL_PROBLEMS_RIGS_FIELD_OF_VIEW_H_
#define RIGEL_PROBLEMS_RIGS_FIELD_OF_VIEW_H_

#include "rigel/core/camera.h"

namespace rigel {

// The angle between the rays of the left and the right edge of the image, at the height of the
// principal point, radians; it may be above pi. Where the lens has no ray at an edge, as in the
// black corner of a fisheye's image, up to the last pixel that has one. 0 without an image size.
double HorizontalFieldOfView(const Camera& camera);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_FIELD_OF_VIEW_H_
