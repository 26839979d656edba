#include "rigel/problems/rigs/euroc_rig.h"

#include <filesystem>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"
#include "rigel/problems/rigs/kalibr_lens.h"
#include "rigel/problems/rigs/yaml_text.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

bool AddSensor(const std::string& path, const std::string& name, RigFile* rig, std::string* error) {
  RigCamera camera;
  if (!ReadEurocSensor(path, &camera, error)) return false;
  AddCamera(name, camera.intrinsics, {camera.Q, camera.s}, rig);
  return true;
}

}  // namespace

bool ReadEurocSensor(const std::string& path, RigCamera* camera, std::string* error) {
  const auto parse = [&](const std::string& text) {
    const YAML::Node sensor = ParseYaml(text);
    const Pose pose =
        PoseOfRows(YamlNumbers(sensor, "T_BS"), "T_BS", YamlLine(YamlMember(sensor, "T_BS")));
    camera->intrinsics = KalibrLens(sensor, "distortion_coefficients");
    camera->Q = pose.R;
    camera->s = pose.t;
  };
  return ReadWith(path, parse, error);
}

bool ReadEurocRig(const std::string& path, const CalibrationOptions& /*options*/,
                  Calibration* calibration, std::string* error) {
  RigFile* rig = &calibration->rig;
  calibration->body = "the IMU";
  if (!IsDirectory(path)) return AddSensor(path, "cam0", rig, error);
  const fs::path mav =
      IsDirectory(fs::path(path) / "mav0") ? fs::path(path) / "mav0" : fs::path(path);
  for (int k = 0;; ++k) {
    const std::string name = "cam" + std::to_string(k);
    if (!Exists(mav / name / "sensor.yaml")) break;
    if (!AddSensor((mav / name / "sensor.yaml").string(), name, rig, error)) return false;
    if (IsDirectory(mav / name / "data")) rig->camera_images.back() = name + "/data";
  }
  if (!rig->rig.cameras.empty()) return true;
  *error = Printable(path) +
           ": no cam0/sensor.yaml, expected EuRoC's folder mav0, or the one that "
           "holds it";
  return false;
}

}  // namespace rigel
