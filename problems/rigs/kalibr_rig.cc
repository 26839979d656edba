#include "rigel/problems/rigs/kalibr_rig.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "rigel/core/angles.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/rigs/calibration_text.h"
#include "rigel/problems/rigs/kalibr_lens.h"
#include "rigel/problems/rigs/yaml_text.h"

namespace rigel {
namespace {

std::optional<Pose> PoseOfKey(const YAML::Node& camera, const std::string& key) {
  if (!HasKey(camera, key)) return std::nullopt;
  return PoseOfRows(YamlNumbers(camera, key), key, YamlLine(YamlMember(camera, key)));
}

std::optional<Pose> BodyFromCamera(const YAML::Node& camera) {
  if (std::optional<Pose> pose = PoseOfKey(camera, "T_imu_cam")) return pose;
  const std::optional<Pose> inverse = PoseOfKey(camera, "T_cam_imu");
  return inverse ? std::optional<Pose>(inverse->Inverse()) : std::nullopt;
}

// A file may state a camera both ways; it was changed by hand if they differ by more than this.
constexpr double kSame = 1e-3;  // radians, metres

// Empty if the pose and the one of the chain are the same.
std::string Difference(const std::string& name, const Pose& pose, const Pose& of_chain) {
  const Pose off = pose.Inverse() * of_chain;
  const double turn = LogSO3(off.R).norm(), shift = off.t.norm();
  if (turn <= kSame && shift <= kSame) return "";
  return name + ": T_cn_cnm1 differs from the pose to the IMU by " +
         FormatNumber(RadToDeg(turn), 2) + " degrees and " + FormatNumber(shift, 3) +
         " m; the pose to the IMU is taken";
}

std::string NameOf(size_t k) { return "cam" + std::to_string(k); }

// The maps cam0, cam1, ...; a gap would leave out cameras.
std::vector<YAML::Node> CamerasOf(const YAML::Node& root) {
  std::vector<YAML::Node> cameras;
  while (HasKey(root, NameOf(cameras.size()))) cameras.push_back(root[NameOf(cameras.size())]);
  if (cameras.empty()) throw LineError(0, "the key cam0 is missing, expected cam0, cam1, ...");
  for (const auto& entry : root) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    const bool is_camera = key.size() > 3 && key.compare(0, 3, "cam") == 0 &&
                           key.find_first_not_of("0123456789", 3) == std::string::npos;
    const bool is_known =
        std::any_of(cameras.begin(), cameras.end(),
                    [&](const YAML::Node& camera) { return camera.is(entry.second); });
    if (is_camera && !is_known) {
      throw LineError(YamlLine(entry.first),
                      key + " without " + NameOf(cameras.size()) + ", expected cam0, cam1, ...");
    }
  }
  return cameras;
}

// Adds camera k and returns its pose. `has_imu`: cam0 has a pose to the IMU.
Pose AddKalibrCamera(const YAML::Node& camera, size_t k, bool has_imu, const Pose& body_from_last,
                     Calibration* calibration) {
  std::optional<Pose> pose = BodyFromCamera(camera);
  if (pose && !has_imu) throw LineError(YamlLine(camera), "a pose to the IMU, but cam0 has none");
  std::optional<Pose> of_chain;
  if (k == 0) {
    of_chain = Pose();
  } else if (const std::optional<Pose> from_last = PoseOfKey(camera, "T_cn_cnm1")) {
    of_chain = body_from_last * from_last->Inverse();
  }
  if (!pose && !of_chain) {
    throw LineError(YamlLine(camera), "no pose, expected T_cam_imu, T_imu_cam or T_cn_cnm1");
  }
  const std::string note = pose && of_chain && k > 0 ? Difference(NameOf(k), *pose, *of_chain) : "";
  if (!note.empty()) calibration->notes.push_back(note);
  if (!pose) pose = of_chain;
  RigCamera* added =
      AddCamera(NameOf(k), KalibrLens(camera, "distortion_coeffs"), *pose, &calibration->rig);
  if (HasKey(camera, "timeshift_cam_imu")) {
    added->time_offset = YamlNumber(camera, "timeshift_cam_imu");
  }
  return *pose;
}

void Parse(const std::string& text, Calibration* calibration) {
  const std::vector<YAML::Node> cameras = CamerasOf(ParseYaml(text));
  const bool has_imu = HasKey(cameras[0], "T_imu_cam") || HasKey(cameras[0], "T_cam_imu");
  calibration->body = has_imu ? "the IMU" : "cam0";
  Pose body_from_last;
  for (size_t k = 0; k < cameras.size(); ++k) {
    try {
      body_from_last = AddKalibrCamera(cameras[k], k, has_imu, body_from_last, calibration);
    } catch (const LineError& error) {
      throw LineError(error.line(), NameOf(k) + ": " + error.what());
    }
  }
}

}  // namespace

bool ReadKalibrRig(const std::string& path, const CalibrationOptions& /*options*/,
                   Calibration* calibration, std::string* error) {
  return ReadWith(
      path, [&](const std::string& text) { Parse(text, calibration); }, error);
}

}  // namespace rigel
