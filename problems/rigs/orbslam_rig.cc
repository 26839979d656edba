#include "rigel/problems/rigs/orbslam_rig.h"

#include <optional>
#include <vector>

#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"
#include "rigel/problems/rigs/yaml_text.h"

namespace rigel {
namespace {

enum class Type { kPinHole, kRectified, kKannalaBrandt8 };

Type TypeOf(const YAML::Node& root) {
  const std::string type = YamlWord(root, "Camera.type");
  if (type == "PinHole") return Type::kPinHole;
  if (type == "Rectified") return Type::kRectified;
  if (type == "KannalaBrandt8") return Type::kKannalaBrandt8;
  throw LineError(
      YamlLine(YamlMember(root, "Camera.type")),
      "Camera.type is " + Quoted(type) + ", expected PinHole, Rectified or KannalaBrandt8");
}

// The coefficients of a camera that the file has, 0 for those that it has not.
void AddCoefficients(const YAML::Node& root, const std::string& camera,
                     const std::vector<const char*>& names, Camera* lens) {
  bool distorted = false;
  for (size_t k = 0; k < names.size(); ++k) {
    const std::string key = camera + "." + names[k];
    if (HasKey(root, key)) lens->parameters[4 + k] = YamlNumber(root, key);
    distorted = distorted || lens->parameters[4 + k] != 0;
  }
  if (distorted && lens->model == CameraModel::kPinhole) lens->model = CameraModel::kFullOpencv;
}

Camera LensOf(const YAML::Node& root, const std::string& camera, Type type, const ImageSize& size) {
  Camera lens = Camera::Pinhole(YamlNumber(root, camera + ".fx"), YamlNumber(root, camera + ".fy"),
                                YamlNumber(root, camera + ".cx"), YamlNumber(root, camera + ".cy"),
                                size.width, size.height);
  if (type == Type::kPinHole) {
    AddCoefficients(root, camera, {"k1", "k2", "p1", "p2", "k3"}, &lens);
  } else if (type == Type::kKannalaBrandt8) {
    lens.model = CameraModel::kOpencvFisheye;
    AddCoefficients(root, camera, {"k1", "k2", "k3", "k4"}, &lens);
  }
  std::string what;
  if (!lens.IsValid(&what)) {
    throw LineError(YamlLine(YamlMember(root, camera + ".fx")), camera + ": " + what);
  }
  return lens;
}

ImageSize SizeOf(const YAML::Node& root, const CalibrationOptions& options) {
  if (!HasKey(root, "Camera.width") && options.size) return *options.size;
  if (!HasKey(root, "Camera.width")) {
    throw LineError(0, "no Camera.width, expected it or an image size from the user");
  }
  const auto pixels = [&](const char* key) {
    return PixelsOf(YamlNumber(root, key), key, YamlLine(YamlMember(root, key)));
  };
  return {pixels("Camera.width"), pixels("Camera.height")};
}

// The pose of the first of the two keys that is there.
std::optional<Pose> PoseOfKeys(const YAML::Node& root, const std::string& key,
                               const std::string& older) {
  const std::string& name = HasKey(root, key) ? key : older;
  if (!HasKey(root, name)) return std::nullopt;
  return PoseOfRows(YamlNumbers(root, name), name, YamlLine(YamlMember(root, name)));
}

// Of rectified cameras: how far the second is to the right of the first, metres.
std::optional<double> BaselineOf(const YAML::Node& root, double fx) {
  for (const char* key : {"Stereo.b", "Camera.bf"}) {
    if (!HasKey(root, key)) continue;
    const double value = YamlNumber(root, key);
    if (!(value > 0)) {
      throw LineError(YamlLine(YamlMember(root, key)),
                      std::string(key) + ": expected a positive number");
    }
    return key[0] == 'S' ? value : value / fx;
  }
  return std::nullopt;
}

void Parse(const std::string& text, const CalibrationOptions& options, Calibration* calibration) {
  const YAML::Node root = ParseYaml(text);
  const Type type = TypeOf(root);
  const ImageSize size = SizeOf(root, options);
  const Camera left = LensOf(root, HasKey(root, "Camera1.fx") ? "Camera1" : "Camera", type, size);
  const std::optional<Pose> imu = PoseOfKeys(root, "IMU.T_b_c1", "Tbc");
  const Pose body_from_left = imu.value_or(Pose());
  calibration->body = imu ? "the IMU" : "camera 1";
  RigFile* rig = &calibration->rig;
  AddCamera("camera1", left, body_from_left, rig);

  if (const std::optional<Pose> left_from_right = PoseOfKeys(root, "Stereo.T_c1_c2", "Tlr")) {
    AddCamera("camera2", LensOf(root, "Camera2", type, size), body_from_left * *left_from_right,
              rig);
  } else if (HasKey(root, "Camera2.fx")) {
    throw LineError(YamlLine(YamlMember(root, "Camera2.fx")),
                    "Camera2 without a pose, expected Stereo.T_c1_c2 or Tlr");
  } else if (const std::optional<double> baseline = BaselineOf(root, left.fx())) {
    Pose to_the_right;
    to_the_right.t.x() = *baseline;
    AddCamera("camera2", left, body_from_left * to_the_right, rig);
    calibration->notes.emplace_back("two cameras of rectified images");
  }
}

}  // namespace

bool ReadOrbslamRig(const std::string& path, const CalibrationOptions& options,
                    Calibration* calibration, std::string* error) {
  return ReadWith(
      path, [&](const std::string& text) { Parse(text, options, calibration); }, error);
}

}  // namespace rigel
