// The projections of KITTI's rectified cameras, as calib.txt and calib_cam_to_cam.txt state them.
#ifndef RIGEL_PROBLEMS_IO_KITTI_PROJECTION_H_
#define RIGEL_PROBLEMS_IO_KITTI_PROJECTION_H_

#include <string>
#include <string_view>

#include "rigel/core/rig.h"

namespace rigel {

// A rectified camera from the 12 numbers of the rows of P = K [I | t] with t = camera_from_camera0.
// The body is camera 0. The image size is left alone. False with what was expected instead.
bool ParseKittiProjection(std::string_view numbers, RigCamera* camera, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_KITTI_PROJECTION_H_
