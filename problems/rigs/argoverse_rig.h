// Rigs of Argoverse 2: intrinsics.csv and egovehicle_SE3_sensor.csv of a log's folder calibration.
//
// The data set has them as .feather; in Python
//   pandas.read_feather("intrinsics.feather").to_csv("intrinsics.csv")
// makes the CSV. Columns, in any order, and others are not looked at:
//   intrinsics.csv             sensor_name fx_px fy_px cx_px cy_px height_px width_px
//   egovehicle_SE3_sensor.csv  sensor_name qw qx qy qz tx_m ty_m tz_m     body_from_sensor
// The body is the ego vehicle: x forward, y left, z up, at the rear axle. The images of the data
// set are undistorted, so k1, k2 and k3 are left out.
//
// Source: av2-api, src/av2/geometry/camera/pinhole_camera.py, and its issues 219 and 226.
#ifndef RIGEL_PROBLEMS_RIGS_ARGOVERSE_RIG_H_
#define RIGEL_PROBLEMS_RIGS_ARGOVERSE_RIG_H_

#include <string>

#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// `path` is one of the two files, the folder that holds them, or the log's folder. False with a
// message of one line if it is no such.
bool ReadArgoverseRig(const std::string& path, const CalibrationOptions& options,
                      Calibration* calibration, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_ARGOVERSE_RIG_H_
