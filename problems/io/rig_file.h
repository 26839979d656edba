// Rig files: the calibration of a camera rig as JSON, format `rigel-rig 1`.
//
//   {"format": "rigel-rig 1", "name": NAME, "ground_m": G, "down": [x, y, z], "forward": [x, y, z],
//    "cameras": [{"name": NAME, "model": MODEL, "parameters": [...], "width": W, "height": H,
//                 "q": [w, x, y, z], "s": [x, y, z], "camera_sigma": [ROT_DEG, POS_M],
//                 "time_offset": DT, "images": FOLDER}, ...]}
//
// Required are `cameras`, at least one, and of each camera all but its name, its sigma, its time
// offset and its images. Sigma and time offset are as the lines `camera_sigma` and `camera_time` of
// match files. q and s are body_from_camera. `images` is the folder of a camera's images, or a
// pattern. `model` and `parameters` are those of core/camera.h. Files without `format` may
// state a camera by the older keys instead of `parameters`: `fx`, `fy`, `cx`, `cy` and
// `distortion`. Their model is `pinhole`, or begins with `radial` (k1 k2 k3) or `brown`
// (k1 k2 p1 p2 k3), which both are full_opencv, or with `equidistant` (k1 k2 k3 k4), which is
// opencv_fisheye. Other keys are not looked at.
#ifndef RIGEL_PROBLEMS_IO_RIG_FILE_H_
#define RIGEL_PROBLEMS_IO_RIG_FILE_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/rig.h"

namespace rigel {

struct RigFile {
  std::string name;  // may be empty
  Rig rig;
  std::vector<std::string> camera_names;         // the number where a camera has no name
  std::vector<std::string> camera_images;        // empty where a camera states none
  std::optional<double> ground_m;                // how far the ground is below the body's origin
  std::optional<Eigen::Vector3d> down, forward;  // unit vectors of the body frame
};

// False if the file cannot be read, is no such JSON, or has a model that is not one of these. The
// message of one line names the file, the camera and what was expected. *rig is then unchanged. The
// rig passes Rig::IsValid, and its image sizes are positive.
bool ReadRigFile(const std::string& path, RigFile* rig, std::string* error);

// The same for text in memory; `name` stands for the path in messages.
bool ParseRigFile(std::string_view text, const std::string& name, RigFile* rig, std::string* error);

// The text of such a file, which reads back as the same rig. The rig passes Rig::IsValid, and the
// cameras have image sizes; there may be fewer names and images than cameras. A camera's sigma is
// written if both its parts are positive.
std::string RigFileText(const RigFile& rig);

// The file appears complete or not at all (whole_file.h). False with a message if it cannot be
// written.
bool WriteRigFile(const std::string& path, const RigFile& rig, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_RIG_FILE_H_
