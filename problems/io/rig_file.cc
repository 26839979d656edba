#include "rigel/problems/io/rig_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include "rigel/core/angles.h"
#include "rigel/core/pose.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/json_message.h"
#include "rigel/problems/io/json_text.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/whole_file.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

// Directions and quaternions must have unit length to within this, as in match files.
constexpr double kMaxNormError = 1e-3;

// Of the older keys: how a model's text begins, and which parameters of `model` its distortion is.
struct OlderModel {
  std::string_view begin;
  CameraModel model;
  std::array<int, 5> places;  // after fx fy cx cy; the first num_coefficients
  size_t num_coefficients;
};
constexpr OlderModel kOlderModels[] = {
    {"pinhole", CameraModel::kPinhole, {}, 0},
    {"radial", CameraModel::kFullOpencv, {0, 1, 4}, 3},       // k1 k2 k3
    {"brown", CameraModel::kFullOpencv, {0, 1, 2, 3, 4}, 5},  // k1 k2 p1 p2 k3
    {"equidistant", CameraModel::kOpencvFisheye, {0, 1, 2, 3}, 4}};

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

[[noreturn]] void FailModel(const std::string& model, const std::string& expected) {
  Fail("camera model " + Quoted(model) + " is not read, expected " + expected);
}

// `model` and `parameters`.
void ReadParameters(const Json& json, const std::string& model, Camera* camera) {
  if (!ParseCameraModel(model, &camera->model)) {
    FailModel(model, "one of " + CameraModelNames());
  }
  const std::vector<double> p =
      Numbers(json["parameters"], "parameters", NumCameraParameters(camera->model));
  std::copy(p.begin(), p.end(), camera->parameters);
}

// `fx`, `fy`, `cx`, `cy` and `distortion`.
void ReadOlderKeys(const Json& json, const std::string& model, Camera* camera) {
  const auto known = std::find_if(
      std::begin(kOlderModels), std::end(kOlderModels),
      [&](const OlderModel& m) { return model.compare(0, m.begin.size(), m.begin) == 0; });
  if (known == std::end(kOlderModels)) {
    FailModel(model, "pinhole, or one that begins with radial, brown or equidistant");
  }
  constexpr char kExpected[] = "'parameters', or 'fx', 'fy', 'cx' and 'cy'";
  const double fx = Positive(Member(json, "fx", kExpected), "fx");
  const double fy = Positive(Member(json, "fy", kExpected), "fy");
  const double cx = Number(Member(json, "cx", kExpected), "cx");
  const double cy = Number(Member(json, "cy", kExpected), "cy");
  *camera = Camera::Pinhole(fx, fy, cx, cy);
  if (known->num_coefficients == 0 && !json.contains("distortion")) return;
  const std::vector<double> d = Numbers(Member(json, "distortion", "its coefficients"),
                                        "distortion", known->num_coefficients);
  // A perspective lens without distortion is a pinhole, with which estimates are faster.
  const bool is_pinhole = known->model != CameraModel::kOpencvFisheye &&
                          std::all_of(d.begin(), d.end(), [](double x) { return x == 0; });
  if (is_pinhole) return;
  camera->model = known->model;
  for (size_t k = 0; k < d.size(); ++k) camera->parameters[4 + known->places[k]] = d[k];
}

// Degrees and metres, both positive.
void ReadSigma(const Json& value, RigCamera* camera) {
  constexpr char kName[] = "camera_sigma";
  Numbers(value, kName, 2);
  camera->rotation_sigma = DegToRad(Positive(value[0], kName));
  camera->position_sigma = Positive(value[1], kName);
}

RigCamera ReadCamera(const Json& json) {
  RigCamera camera;
  const std::string model = Text(Member(json, "model", "the name of a camera model"), "model");
  if (json.contains("parameters") && json.contains("fx")) {
    Fail("'parameters' and 'fx', expected one of them");
  }
  if (json.contains("parameters")) {
    ReadParameters(json, model, &camera.intrinsics);
  } else {
    ReadOlderKeys(json, model, &camera.intrinsics);
  }
  std::string what;
  if (!camera.intrinsics.IsValid(&what)) Fail(what);
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
      file->rig.cameras.push_back(ReadCamera(json));
      file->camera_names.push_back(name);
      file->camera_images.push_back(json.contains("images") ? Text(json["images"], "images") : "");
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

// "key": value, for the text of a file. Names may have any bytes.
std::string Entry(const char* key, const Json& value) {
  return std::string("\"") + key +
         "\": " + value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json Numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string CameraText(const RigCamera& camera, const std::string& name,
                       const std::string& images) {
  const Camera& lens = camera.intrinsics;
  const auto* const end = lens.parameters + NumCameraParameters(lens.model);
  const Eigen::Quaterniond q = Pose{camera.Q, camera.s}.Quaternion();
  std::string text =
      "  {" + Entry("name", name) + ", " + Entry("model", CameraModelName(lens.model)) + ",\n   " +
      Entry("parameters", std::vector<double>(lens.parameters, end)) + ",\n   " +
      Entry("width", lens.width) + ", " + Entry("height", lens.height) + ",\n   " +
      Entry("q", {q.w(), q.x(), q.y(), q.z()}) + ",\n   " + Entry("s", Numbers(camera.s));
  if (camera.rotation_sigma > 0 && camera.position_sigma > 0) {
    text +=
        ",\n   " + Entry("camera_sigma", {RadToDeg(camera.rotation_sigma), camera.position_sigma});
  }
  if (camera.time_offset != 0) text += ",\n   " + Entry("time_offset", camera.time_offset);
  if (!images.empty()) text += ",\n   " + Entry("images", images);
  return text + "}";
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

std::string RigFileText(const RigFile& rig) {
  std::string text = "{" + Entry("format", "rigel-rig 1");
  if (!rig.name.empty()) text += ",\n " + Entry("name", rig.name);
  if (rig.ground_m) text += ",\n " + Entry("ground_m", *rig.ground_m);
  if (rig.down) text += ",\n " + Entry("down", Numbers(*rig.down));
  if (rig.forward) text += ",\n " + Entry("forward", Numbers(*rig.forward));
  text += ",\n \"cameras\": [";
  for (size_t k = 0; k < rig.rig.cameras.size(); ++k) {
    const auto of_camera = [&](const std::vector<std::string>& texts, const std::string& other) {
      return k < texts.size() ? texts[k] : other;
    };
    text += std::string(k > 0 ? "," : "") + "\n" +
            CameraText(rig.rig.cameras[k], of_camera(rig.camera_names, std::to_string(k)),
                       of_camera(rig.camera_images, ""));
  }
  return PrintableJson(text + "]}\n");
}

bool WriteRigFile(const std::string& path, const RigFile& rig, std::string* error) {
  return WriteWholeFile(path, RigFileText(rig), error);
}

}  // namespace rigel
