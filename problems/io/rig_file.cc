#include "rigel/problems/io/rig_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include "rigel/core/angles.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/json_message.h"
#include "rigel/problems/io/json_text.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

// Directions and quaternions must have unit length to within this, as in match files.
constexpr double kMaxNormError = 1e-3;

struct CameraModel {
  std::string_view name;
  size_t num_parameters;
  bool two_focal_lengths;  // fx fy, or one f for both; then cx cy
};
// Those of COLMAP of which the pinhole part is a good camera.
constexpr CameraModel kModels[] = {{"pinhole", 4, true},        {"simple_pinhole", 3, false},
                                   {"simple_radial", 4, false}, {"radial", 5, false},
                                   {"opencv", 8, true},         {"full_opencv", 12, true}};

// Of the older keys: how a model's text begins, and its number of distortion coefficients.
struct OlderModel {
  std::string_view begin;
  size_t num_coefficients;
};
constexpr OlderModel kOlderModels[] = {{"pinhole", 0}, {"radial", 3}, {"brown", 5}};

[[noreturn]] void Fail(const std::string& message) { throw std::runtime_error(message); }

const Json& Member(const Json& object, const char* key, const char* expected) {
  const auto found = object.find(key);
  if (found == object.end()) Fail(std::string("no '") + key + "', expected " + expected);
  return *found;
}

double Number(const Json& value, const std::string& what) {
  const double number = value.is_number() ? value.get<double>() : NAN;
  if (!std::isfinite(number)) Fail(what + " is " + QuoteJson(value) + ", expected a number");
  return number;
}

double Positive(const Json& value, const std::string& what) {
  const double number = Number(value, what);
  if (!(number > 0)) Fail(what + " is " + QuoteJson(value) + ", expected a positive number");
  return number;
}

std::string Text(const Json& value, const char* what) {
  if (!value.is_string()) Fail(std::string(what) + " is " + QuoteJson(value) + ", expected a text");
  return value.get<std::string>();
}

std::vector<double> Numbers(const Json& value, const std::string& what, size_t count) {
  if (!value.is_array() || value.size() != count) {
    const std::string found =
        value.is_array() ? std::to_string(value.size()) + " entries" : QuoteJson(value);
    Fail(what + " has " + found + ", expected " + std::to_string(count) + " numbers");
  }
  std::vector<double> numbers;
  for (const Json& number : value) numbers.push_back(Number(number, what));
  return numbers;
}

// A vector of unit length within kMaxNormError, normalized.
template <int kSize>
Eigen::Matrix<double, kSize, 1> UnitVector(const Json& value, const char* what) {
  const std::vector<double> numbers = Numbers(value, what, kSize);
  const Eigen::Matrix<double, kSize, 1> v =
      Eigen::Map<const Eigen::Matrix<double, kSize, 1>>(numbers.data());
  if (!(std::abs(v.norm() - 1.0) <= kMaxNormError)) {
    Fail(std::string(what) + " has a norm that is not 1, expected one within 0.001 of it");
  }
  return v.normalized();
}

bool AnyNot0(const double* begin, const double* end) {
  return std::any_of(begin, end, [](double x) { return x != 0; });
}

[[noreturn]] void FailModel(const std::string& model, const char* expected) {
  Fail("camera model " + Quoted(model) + " is not read, expected " + expected);
}

// `model` and `parameters`. Whether a distortion was left out.
bool ReadParameters(const Json& json, const std::string& model, PinholeCamera* camera) {
  const auto known = std::find_if(std::begin(kModels), std::end(kModels),
                                  [&](const CameraModel& m) { return m.name == model; });
  if (known == std::end(kModels)) {
    FailModel(model, "pinhole, simple_pinhole, simple_radial, radial, opencv or full_opencv");
  }
  const std::vector<double> p = Numbers(json["parameters"], "parameters", known->num_parameters);
  const size_t y = known->two_focal_lengths ? 1 : 0;
  if (!(p[0] > 0 && p[y] > 0)) {
    Fail("parameters have a focal length that is not positive, expected a positive one");
  }
  camera->fx = p[0];
  camera->fy = p[y];
  camera->cx = p[y + 1];
  camera->cy = p[y + 2];
  return AnyNot0(p.data() + y + 3, p.data() + p.size());
}

// `fx`, `fy`, `cx`, `cy` and `distortion`. Whether a distortion was left out.
bool ReadOlderKeys(const Json& json, const std::string& model, PinholeCamera* camera) {
  const auto known = std::find_if(
      std::begin(kOlderModels), std::end(kOlderModels),
      [&](const OlderModel& m) { return model.compare(0, m.begin.size(), m.begin) == 0; });
  if (known == std::end(kOlderModels)) {
    FailModel(model, "pinhole, or one that begins with radial or brown");
  }
  constexpr char kExpected[] = "'parameters', or 'fx', 'fy', 'cx' and 'cy'";
  camera->fx = Positive(Member(json, "fx", kExpected), "fx");
  camera->fy = Positive(Member(json, "fy", kExpected), "fy");
  camera->cx = Number(Member(json, "cx", kExpected), "cx");
  camera->cy = Number(Member(json, "cy", kExpected), "cy");
  if (known->num_coefficients == 0 && !json.contains("distortion")) return false;
  const std::vector<double> d = Numbers(Member(json, "distortion", "its coefficients"),
                                        "distortion", known->num_coefficients);
  return AnyNot0(d.data(), d.data() + d.size());
}

// Degrees and metres, both positive.
void ReadSigma(const Json& value, RigCamera* camera) {
  constexpr char kName[] = "camera_sigma";
  Numbers(value, kName, 2);
  camera->rotation_sigma = DegToRad(Positive(value[0], kName));
  camera->position_sigma = Positive(value[1], kName);
}

RigCamera ReadCamera(const Json& json, bool* undistorted) {
  RigCamera camera;
  const std::string model = Text(Member(json, "model", "the name of a camera model"), "model");
  if (json.contains("parameters") && json.contains("fx")) {
    Fail("'parameters' and 'fx', expected one of them");
  }
  *undistorted = json.contains("parameters") ? ReadParameters(json, model, &camera.intrinsics)
                                             : ReadOlderKeys(json, model, &camera.intrinsics);
  for (const auto& [key, size] : {std::pair("width", &camera.intrinsics.width),
                                  std::pair("height", &camera.intrinsics.height)}) {
    const Json& value = Member(json, key, "the size of the image, pixels");
    try {
      *size = JsonInteger(value, 1);
    } catch (const std::exception& e) {
      Fail(std::string(key) + " is " + e.what());
    }
  }
  const Eigen::Vector4d q =
      UnitVector<4>(Member(json, "q", "the quaternion w x y z of body_from_camera"), "q");
  camera.Q = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  const std::vector<double> s =
      Numbers(Member(json, "s", "the position x y z of the camera in the body frame"), "s", 3);
  camera.s = {s[0], s[1], s[2]};
  if (json.contains("camera_sigma")) ReadSigma(json["camera_sigma"], &camera);
  if (json.contains("time_offset")) camera.time_offset = Number(json["time_offset"], "time_offset");
  return camera;
}

void ReadCameras(const Json& cameras, RigFile* file) {
  if (!cameras.is_array() || cameras.empty()) {
    Fail("cameras is " + QuoteJson(cameras) + ", expected an array of at least one camera");
  }
  for (size_t k = 0; k < cameras.size(); ++k) {
    const Json& json = cameras[k];
    std::string where = "camera " + std::to_string(k);
    try {
      if (!json.is_object()) Fail(QuoteJson(json) + ", expected an object");
      const std::string name =
          json.contains("name") ? Text(json["name"], "name") : std::to_string(k);
      if (json.contains("name")) where += " (" + name + ")";
      bool undistorted = false;
      file->rig.cameras.push_back(ReadCamera(json, &undistorted));
      file->camera_names.push_back(name);
      file->num_undistorted += undistorted ? 1 : 0;
    } catch (const std::exception& e) {
      Fail(where + ": " + JsonMessage(e));
    }
  }
}

RigFile ReadRig(std::string_view text) {
  const Json json = ParseJson(text);
  if (!json.is_object()) Fail(QuoteJson(json) + ", expected an object with 'cameras'");
  RigFile file;
  if (json.contains("format") && json["format"] != "rigel-rig 1") {
    Fail("format is " + QuoteJson(json["format"]) + ", expected 'rigel-rig 1'");
  }
  if (json.contains("name")) file.name = Text(json["name"], "name");
  if (json.contains("ground_m")) file.ground_m = Number(json["ground_m"], "ground_m");
  if (json.contains("down")) file.down = UnitVector<3>(json["down"], "down");
  if (json.contains("forward")) file.forward = UnitVector<3>(json["forward"], "forward");
  ReadCameras(Member(json, "cameras", "an array of cameras"), &file);
  std::string error;
  if (!file.rig.IsValid(&error)) Fail(error);
  return file;
}

}  // namespace

bool ParseRigFile(std::string_view text, const std::string& name, RigFile* rig,
                  std::string* error) {
  try {
    int64_t line;
    std::string what;
    if (!CheckText(&text, &line, &what)) Fail(what + ", expected JSON (UTF-8 text)");
    *rig = ReadRig(text);
    return true;
  } catch (const std::exception& e) {
    *error = Printable(name) + ": " + JsonMessage(e);
    return false;
  }
}

bool ReadRigFile(const std::string& path, RigFile* rig, std::string* error) {
  InputBytes bytes;
  return ReadInputFile(path, &bytes, error) &&
         ParseRigFile(bytes.text(), InputName(path), rig, error);
}

}  // namespace rigel
