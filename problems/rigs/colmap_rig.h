// Rigs of COLMAP.
//
//   rig_config.json  an array of rigs, each with `cameras`. Of COLMAP 3.12 and later a camera has
//                    `image_prefix` and either `ref_sensor` or `cam_from_rig_rotation` (w x y z)
//                    and `cam_from_rig_translation`; it may have `camera_model_name` and
//                    `camera_params`. Before, a camera has `camera_id`, `image_prefix`, `rel_qvec`
//                    (w x y z) and `rel_tvec`, also cam_from_rig, and the rig `ref_camera_id`
//   rigs.txt         of a text model of 3.12 and later, a line a rig: RIG_ID NUM_SENSORS TYPE ID of
//                    the reference sensor, then TYPE ID HAS_POSE [QW QX QY QZ TX TY TZ] of each
//                    other sensor, sensor_from_rig; TYPE is CAMERA or another
//   cameras.txt      the lenses: CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS
//   images.txt       if it is there, of which camera the images of a prefix are
// The body is the rig's frame, which is the reference sensor but for older files. cameras.txt is
// beside the rig or where the options say. Without images.txt the cameras of a newer
// rig_config.json are those of cameras.txt in the order of their numbers. COLMAP's pixels are
// larger by 0.5, which is taken off the principal point.
//
// Source: COLMAP's doc/rigs.rst, src/colmap/scene/rig.cc and reconstruction_io_text.cc of 3.12, and
// src/exe/sfm.cc of 3.8.
#ifndef RIGEL_PROBLEMS_RIGS_COLMAP_RIG_H_
#define RIGEL_PROBLEMS_RIGS_COLMAP_RIG_H_

#include <string>

#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// `path` is rig_config.json, rigs.txt or a folder with one of them; rigs.txt is taken first. False
// with a message of one line if it is no such.
bool ReadColmapRig(const std::string& path, const CalibrationOptions& options,
                   Calibration* calibration, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_COLMAP_RIG_H_
