// Rigs of ORB-SLAM3's settings, YAML of OpenCV, of one camera or two.
//
//   Camera.type        PinHole (k1 k2 p1 p2 [k3], may be absent), KannalaBrandt8 (k1 k2 k3 k4) or
//                      Rectified
//   Camera1.fx ..      the left or only camera; in files before 1.0 Camera.fx ..
//   Camera2.fx ..      the right camera
//   Camera.width ..    the size of both; older files may lack it
//   Stereo.T_c1_c2     camera1_from_camera2, 4x4; older: Tlr, 3x4
//   Stereo.b           of Rectified: camera 2 is so far to the right, metres; of older files
//                      Camera.bf, which is b times fx
//   IMU.T_b_c1         body_from_camera1, 4x4; older: Tbc
// The body is the IMU; without one it is camera 1. A file with Camera.newWidth states cameras of
// the size before.
//
// Source: ORB_SLAM3, src/Settings.cc and the files of Examples.
#ifndef RIGEL_PROBLEMS_RIGS_ORBSLAM_RIG_H_
#define RIGEL_PROBLEMS_RIGS_ORBSLAM_RIG_H_

#include <string>

#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// False with a message of one line if the file is no such.
bool ReadOrbslamRig(const std::string& path, const CalibrationOptions& options,
                    Calibration* calibration, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_ORBSLAM_RIG_H_
