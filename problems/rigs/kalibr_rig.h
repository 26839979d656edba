// Rigs of Kalibr, camchain.yaml and camchain-imucam.yaml, and of OpenVINS,
// kalibr_imucam_chain.yaml.
//
// Maps cam0, cam1, ... with a lens (kalibr_lens.h) and where the camera sits:
//   T_imu_cam   body_from_camera, OpenVINS
//   T_cam_imu   camera_from_body, X_cam = T X_imu
//   T_cn_cnm1   camera n from camera n - 1, where there is no IMU
// The body is the IMU; without one it is cam0. timeshift_cam_imu is the camera's time offset:
// t_imu = t_cam + shift. Kalibr's pixel (0, 0) is the centre of the first pixel, as here.
//
// Source: Kalibr's wiki, "yaml formats", and kalibr_common/ConfigReader.py; OpenVINS' files in its
// folder config.
#ifndef RIGEL_PROBLEMS_RIGS_KALIBR_RIG_H_
#define RIGEL_PROBLEMS_RIGS_KALIBR_RIG_H_

#include <string>

#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// False with a message of one line if the file is no such.
bool ReadKalibrRig(const std::string& path, const CalibrationOptions& options,
                   Calibration* calibration, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_KALIBR_RIG_H_
