#include "rigel/problems/rigs/colmap_rig.h"

#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/json_text.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"
#include "rigel/problems/rigs/colmap_model.h"
#include "rigel/problems/rigs/json_members.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A camera of a rig, as far as the file of the rig says.
struct Sensor {
  std::optional<int> id;  // of cameras.txt
  std::string prefix;     // of its images' names
  std::optional<Camera> lens;
  std::optional<Pose> camera_from_rig;  // none where COLMAP shall find it
};

// Index `index` of the rigs of a file.
template <class T>
const T& Chosen(const std::vector<T>& rigs, int index, Calibration* calibration) {
  if (static_cast<size_t>(index) >= rigs.size()) {
    throw LineError(0, "has " + std::to_string(rigs.size()) + " rigs, expected an index below");
  }
  if (rigs.size() > 1) {
    calibration->notes.push_back("rig " + std::to_string(index) + " of " +
                                 std::to_string(rigs.size()));
  }
  return rigs[index];
}

std::optional<Pose> PoseOfMembers(const Json& camera, const char* rotation,
                                  const char* translation) {
  if (!HasMember(camera, rotation) && !HasMember(camera, translation)) return std::nullopt;
  return PoseOfQuaternion(MemberNumbers(camera, rotation, 4), MemberNumbers(camera, translation, 3),
                          rotation, 0);
}

Sensor SensorOf(const Json& camera) {
  Sensor sensor;
  if (HasMember(camera, "camera_id")) sensor.id = JsonInteger(camera["camera_id"], 0);
  sensor.prefix = MemberText(camera, "image_prefix");
  if (HasMember(camera, "ref_sensor") && camera["ref_sensor"] != false) {
    if (HasMember(camera, "cam_from_rig_rotation")) {
      throw LineError(0, "cam_from_rig_rotation of the ref_sensor, expected none");
    }
    sensor.camera_from_rig = Pose();
  } else {
    sensor.camera_from_rig =
        PoseOfMembers(camera, "cam_from_rig_rotation", "cam_from_rig_translation");
  }
  if (!sensor.camera_from_rig) {
    sensor.camera_from_rig = PoseOfMembers(camera, "rel_qvec", "rel_tvec");
  }
  if (HasMember(camera, "camera_model_name") && HasMember(camera, "camera_params")) {
    sensor.lens =
        ColmapLens(MemberText(camera, "camera_model_name"),
                   MemberNumbers(camera, "camera_params", camera["camera_params"].size()));
  }
  return sensor;
}

std::vector<Sensor> ParseConfig(const std::string& text, int index, Calibration* calibration) {
  const Json array = ParseJsonArray(text);
  const std::vector<Json> rigs(array.begin(), array.end());
  const Json& rig = Chosen(rigs, index, calibration);
  if (!HasMember(rig, "cameras") || !rig["cameras"].is_array()) {
    throw LineError(0, "rig " + std::to_string(index) + ": expected an array 'cameras'");
  }
  std::vector<Sensor> sensors;
  for (const Json& camera : rig["cameras"]) {
    try {
      sensors.push_back(SensorOf(camera));
      const bool is_reference = HasMember(rig, "ref_camera_id") && sensors.back().id &&
                                rig["ref_camera_id"] == *sensors.back().id;
      if (is_reference && !sensors.back().camera_from_rig) sensors.back().camera_from_rig = Pose();
    } catch (const std::exception& exception) {
      throw LineError(0, "rig " + std::to_string(index) + ", camera " +
                             std::to_string(sensors.size()) + ": " + exception.what());
    }
  }
  return sensors;
}

// The words of a line of rigs.txt, one after the other.
class Words {
 public:
  explicit Words(const TextLine& line) : words_(SplitAtBlanks(line.text)), line_(line.number) {}

  std::string_view Next(const char* what) {
    if (next_ == words_.size()) {
      throw LineError(line_, std::string("the line ends, expected ") + what);
    }
    return words_[next_++];
  }
  int Integer(const char* what) {
    const std::string_view word = Next(what);
    int number;
    if (!ParseInteger(word, 0, &number)) {
      throw LineError(line_, std::string(what) + " is " + Quoted(word) + ", expected a number");
    }
    return number;
  }
  std::vector<double> Numbers(const char* what, int count) {
    std::vector<double> numbers;
    for (int k = 0; k < count; ++k) numbers.push_back(NumberOf(Next(what), what, line_));
    return numbers;
  }
  bool AtEnd() const { return next_ == words_.size(); }

 private:
  std::vector<std::string_view> words_;
  size_t next_ = 0;
  int line_;
};

std::vector<Sensor> ParseRigLine(const TextLine& line) {
  Words words(line);
  words.Integer("RIG_ID");
  const int count = words.Integer("NUM_SENSORS");
  std::vector<Sensor> sensors;
  for (int k = 0; k < count; ++k) {
    const std::string_view type = words.Next("a sensor's type");
    Sensor sensor;
    sensor.id = words.Integer("a sensor's ID");
    if (k == 0) {
      sensor.camera_from_rig = Pose();
    } else if (words.Integer("HAS_POSE") != 0) {
      const std::vector<double> q = words.Numbers("QW QX QY QZ", 4);
      sensor.camera_from_rig =
          PoseOfQuaternion(q, words.Numbers("TX TY TZ", 3), "QW QX QY QZ", line.number);
    }
    if (type == "CAMERA") sensors.push_back(sensor);
  }
  if (!words.AtEnd()) throw LineError(line.number, "more words than NUM_SENSORS sensors have");
  return sensors;
}

std::vector<Sensor> ParseRigs(const std::string& text, int index, Calibration* calibration) {
  const std::vector<TextLine> lines = LinesOf(text);
  if (lines.empty()) throw LineError(0, "no rig, expected COLMAP's rigs.txt");
  return ParseRigLine(Chosen(lines, index, calibration));
}

// The images of a camera: their folder if the prefix is one.
std::string FolderOf(const std::string& prefix) {
  const size_t slash = prefix.rfind('/');
  return slash == std::string::npos ? "" : prefix.substr(0, slash);
}

bool StartsWith(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

// The cameras of cameras.txt for sensors without a number: by the names of images if they are
// known, else in their order.
void FindIds(const std::map<int, Camera>& cameras, const std::map<int, std::string>& images,
             std::vector<Sensor>* sensors, Calibration* calibration) {
  size_t found = 0, without = 0;
  for (Sensor& sensor : *sensors) {
    if (sensor.id) continue;
    ++without;
    for (const auto& [id, name] : images) {
      if (!sensor.id && StartsWith(name, sensor.prefix)) sensor.id = id;
    }
    if (sensor.id) ++found;
  }
  if (found == without) return;
  if (found > 0 || without != sensors->size() || cameras.size() != sensors->size()) {
    throw LineError(0,
                    "which camera of cameras.txt has which image_prefix is not known, expected "
                    "images.txt with images of each, or as many cameras as the rig has");
  }
  auto camera = cameras.begin();
  for (Sensor& sensor : *sensors) sensor.id = (camera++)->first;
  calibration->notes.emplace_back("lenses are those of cameras.txt in its order: no images.txt");
}

void AddSensors(const std::vector<Sensor>& sensors, const std::map<int, Camera>& cameras,
                const std::map<int, std::string>& images, Calibration* calibration) {
  if (sensors.empty()) throw LineError(0, "a rig without cameras, expected at least one");
  for (size_t k = 0; k < sensors.size(); ++k) {
    const Sensor& sensor = sensors[k];
    const auto camera = cameras.find(*sensor.id);
    const auto image = images.find(*sensor.id);
    const std::string folder =
        FolderOf(!sensor.prefix.empty() || image == images.end() ? sensor.prefix : image->second);
    const std::string name = !folder.empty()          ? folder
                             : !sensor.prefix.empty() ? sensor.prefix
                                                      : "camera_" + std::to_string(*sensor.id);
    if (camera == cameras.end()) {
      throw LineError(0,
                      name + ": camera " + std::to_string(*sensor.id) + " is not in cameras.txt");
    }
    if (!sensor.camera_from_rig) {
      throw LineError(0, name +
                             " has no pose in the rig, expected cam_from_rig_rotation and "
                             "cam_from_rig_translation (rigs.txt of COLMAP's model has them)");
    }
    Camera lens = sensor.lens.value_or(camera->second);
    lens.width = camera->second.width;
    lens.height = camera->second.height;
    AddCamera(name, lens, sensor.camera_from_rig->Inverse(), &calibration->rig);
    calibration->rig.camera_images.back() = folder;
  }
}

}  // namespace

bool ReadColmapRig(const std::string& path, const CalibrationOptions& options,
                   Calibration* calibration, std::string* error) {
  fs::path file = path;
  if (IsDirectory(path)) {
    file = fs::path(path) / "rigs.txt";
    if (!Exists(file)) file = fs::path(path) / "rig_config.json";
  }
  const fs::path cameras_path =
      options.cameras.empty() ? file.parent_path() / "cameras.txt" : fs::path(options.cameras);
  std::map<int, Camera> cameras;
  std::map<int, std::string> images;
  const fs::path images_path = cameras_path.parent_path() / "images.txt";
  if (!ReadColmapCameras(cameras_path.string(), &cameras, error)) return false;
  if (Exists(images_path) && !ReadColmapImages(images_path.string(), &images, error)) return false;
  const auto parse = [&](const std::string& text) {
    const size_t begin = text.find_first_not_of(" \t\r\n");
    const bool is_json = begin != std::string::npos && (text[begin] == '[' || text[begin] == '{');
    std::vector<Sensor> sensors = is_json ? ParseConfig(text, options.index, calibration)
                                          : ParseRigs(text, options.index, calibration);
    FindIds(cameras, images, &sensors, calibration);
    AddSensors(sensors, cameras, images, calibration);
  };
  calibration->body = "the rig's frame, COLMAP's reference sensor";
  return ReadWith(file.string(), parse, error);
}

}  // namespace rigel
