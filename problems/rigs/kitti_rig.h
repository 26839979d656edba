// Rigs of KITTI.
//
//   kitti            calib.txt of the odometry and object data: lines P0: to P3:, the projections
//   of
//                    rectified cameras (kitti_projection.h). It states no image size
//   kitti_raw        calib_cam_to_cam.txt of the raw data, for images that are not rectified: of
//                    each camera XX the lines S_XX (size), K_XX, D_XX (k1 k2 p1 p2 k3), R_XX and
//                    T_XX (camera_from_camera0)
//   kitti_rectified  the same file, for the rectified images, which KITTI calls synced: S_rect_XX
//                    and P_rect_XX
// The body is camera 0, x right, y down, z forward; of rectified images the rectified one.
//
// Source: Geiger et al., "Vision meets robotics: the KITTI dataset", IJRR 2013, section IV, and the
// files of the data set.
#ifndef RIGEL_PROBLEMS_RIGS_KITTI_RIG_H_
#define RIGEL_PROBLEMS_RIGS_KITTI_RIG_H_

#include <string>

#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// `path` is the file or its folder. False with a message of one line if it is no such.
bool ReadKittiRig(const std::string& path, const CalibrationOptions& options,
                  Calibration* calibration, std::string* error);
bool ReadKittiRawRig(const std::string& path, const CalibrationOptions& options,
                     Calibration* calibration, std::string* error);
bool ReadKittiRectifiedRig(const std::string& path, const CalibrationOptions& options,
                           Calibration* calibration, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_KITTI_RIG_H_
