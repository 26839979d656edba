// Lenses by the names of Kalibr, which EuRoC's sensor.yaml uses too.
//
//   camera_model  intrinsics            distortion_model  distortion     model
//   pinhole       fu fv pu pv           radtan            k1 k2 p1 p2    opencv
//   pinhole       fu fv pu pv           radtan            .. k3          full_opencv
//   pinhole       fu fv pu pv           equidistant       k1 k2 k3 k4    opencv_fisheye
//   pinhole       fu fv pu pv           fov               w              fov
//   pinhole       fu fv pu pv           none                             pinhole
//   omni          xi fu fv pu pv        radtan or none                   omni
//   ds            xi alpha fu fv pu pv  none                             double_sphere
//   eucm          alpha beta fu .. pv   none                             eucm
//
// radial-tangential is radtan. A pinhole whose coefficients are all 0 has no distortion. Kalibr has
// no camera with five coefficients; files in EuRoC's form do. Source: Kalibr's wiki, "yaml
// formats" and "supported models", and kalibr_common/ConfigReader.py.
#ifndef RIGEL_PROBLEMS_RIGS_KALIBR_LENS_H_
#define RIGEL_PROBLEMS_RIGS_KALIBR_LENS_H_

#include <string>

#include <yaml-cpp/yaml.h>

#include "rigel/core/camera.h"

namespace rigel {

// The lens of a camera's map, with the size of `resolution`. `coefficients` is the key of its
// distortion. Throws LineError.
Camera KalibrLens(const YAML::Node& camera, const std::string& coefficients);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_KALIBR_LENS_H_
