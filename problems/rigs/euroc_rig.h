// Rigs of the EuRoC MAV data set and of data in its form: mav0/cam0/sensor.yaml, mav0/cam1, ...
//
// Each file has a lens (kalibr_lens.h, with `distortion_coefficients`), `resolution` and T_BS, the
// pose body_from_sensor. The body is the IMU. Source: Burri et al., "The EuRoC micro aerial vehicle
// datasets", IJRR 2016, and the files of the data set; TUM-VI has the same with `equidistant`.
#ifndef RIGEL_PROBLEMS_RIGS_EUROC_RIG_H_
#define RIGEL_PROBLEMS_RIGS_EUROC_RIG_H_

#include <string>

#include "rigel/core/rig.h"
#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// The camera of one sensor.yaml. False with a message of one line if it is no such.
bool ReadEurocSensor(const std::string& path, RigCamera* camera, std::string* error);

// `path` is mav0, the folder that holds it, or one sensor.yaml. False with a message of one line if
// it is no such.
bool ReadEurocRig(const std::string& path, const CalibrationOptions& options,
                  Calibration* calibration, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_EUROC_RIG_H_
