// Rigs of nuScenes: calibrated_sensor.json, with sensor.json beside it.
//
// An entry has `sensor_token`, `translation` and `rotation` (w x y z), which are body_from_sensor,
// and of cameras the 3x3 `camera_intrinsic`. sensor.json has the `channel` of each sensor, such as
// CAM_FRONT, and its `modality`. The body is the ego vehicle: x forward, y left, z up, at the rear
// axle. Images are undistorted and of 1600 x 900 pixels, which the tables do not say.
//
// A table has the calibrations of many drives. Those of one drive stand together: an entry begins
// the next rig if its channel is there already.
//
// Source: the schema of nuScenes, a page of its nuscenes-devkit.
#ifndef RIGEL_PROBLEMS_RIGS_NUSCENES_RIG_H_
#define RIGEL_PROBLEMS_RIGS_NUSCENES_RIG_H_

#include <string>

#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// `path` is calibrated_sensor.json or its folder. False with a message of one line if it is no
// such.
bool ReadNuscenesRig(const std::string& path, const CalibrationOptions& options,
                     Calibration* calibration, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_NUSCENES_RIG_H_
