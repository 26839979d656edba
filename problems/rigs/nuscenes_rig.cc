#include "rigel/problems/rigs/nuscenes_rig.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"
#include "rigel/problems/rigs/json_members.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr ImageSize kImageSize = {1600, 900};  // of all cameras of nuScenes

// The channels of cameras by the tokens of their sensors.
using Channels = std::map<std::string, std::string>;

void ParseSensors(const std::string& text, Channels* channels) {
  for (const Json& sensor : ParseJsonArray(text)) {
    if (MemberText(sensor, "modality") != "camera") continue;
    (*channels)[MemberText(sensor, "token")] = MemberText(sensor, "channel");
  }
}

Camera LensOf(const Json& sensor, const ImageSize& size) {
  const char* const key = "camera_intrinsic";
  std::vector<double> K;
  if (HasMember(sensor, key) && sensor[key].is_array() && sensor[key].size() == 3) {
    for (size_t row = 0; row < 3; ++row) {
      const std::vector<double> numbers = MemberNumbers({{"row", sensor[key][row]}}, "row", 3);
      K.insert(K.end(), numbers.begin(), numbers.end());
    }
  }
  const std::vector<double> last = {0, 0, 1};
  if (K.size() != 9 || !std::equal(last.begin(), last.end(), K.begin() + 6) || K[3] != 0) {
    throw LineError(0, "camera_intrinsic: expected three rows FX 0 CX, 0 FY CY, 0 0 1");
  }
  return Camera::Pinhole(K[0], K[4], K[2], K[5], size.width, size.height);
}

// The cameras of one drive, channel and entry.
using Drive = std::vector<std::pair<std::string, const Json*>>;

std::vector<Drive> DrivesOf(const Json& table, const Channels& channels) {
  std::vector<Drive> drives(1);
  std::set<std::string> seen;  // sensors of the drive, of all kinds
  for (const Json& entry : table) {
    const std::string token = MemberText(entry, "sensor_token");
    if (!seen.insert(token).second) {
      drives.emplace_back();
      seen = {token};
    }
    const auto channel = channels.find(token);
    if (channel != channels.end()) drives.back().emplace_back(channel->second, &entry);
  }
  return drives;
}

void ParseTable(const std::string& text, const Channels& channels,
                const CalibrationOptions& options, Calibration* calibration) {
  const Json table = ParseJsonArray(text);
  const std::vector<Drive> drives = DrivesOf(table, channels);
  const auto index = static_cast<size_t>(options.index);
  if (index >= drives.size()) {
    throw LineError(0, "has " + std::to_string(drives.size()) + " rigs, expected an index below");
  }
  const Drive& drive = drives[index];
  if (drive.empty()) throw LineError(0, "no camera, expected sensors that sensor.json has");
  if (drives.size() > 1) {
    calibration->notes.push_back("rig " + std::to_string(index) + " of " +
                                 std::to_string(drives.size()));
  }
  const size_t most =
      std::max_element(drives.begin(), drives.end(), [](const auto& a, const auto& b) {
        return a.size() < b.size();
      })->size();
  if (drive.size() < most) {
    calibration->notes.push_back("this rig has " + std::to_string(drive.size()) +
                                 " cameras, others have " + std::to_string(most));
  }
  if (!options.size) calibration->notes.emplace_back("image size: 1600 x 900, as all of nuScenes");
  for (const auto& [channel, entry] : drive) {
    try {
      const Pose pose = PoseOfQuaternion(MemberNumbers(*entry, "rotation", 4),
                                         MemberNumbers(*entry, "translation", 3), "rotation", 0);
      AddCamera(channel, LensOf(*entry, options.size.value_or(kImageSize)), pose,
                &calibration->rig);
    } catch (const std::exception& exception) {
      throw LineError(0, channel + ": " + exception.what());
    }
  }
}

}  // namespace

bool ReadNuscenesRig(const std::string& path, const CalibrationOptions& options,
                     Calibration* calibration, std::string* error) {
  const fs::path table =
      IsDirectory(path) ? fs::path(path) / "calibrated_sensor.json" : fs::path(path);
  const std::string sensors = (table.parent_path() / "sensor.json").string();
  Channels channels;
  if (!ReadWith(
          sensors, [&](const std::string& text) { ParseSensors(text, &channels); }, error)) {
    return false;
  }
  calibration->body = "the ego vehicle, x forward, y left, z up";
  calibration->rig.down = -Eigen::Vector3d::UnitZ();
  calibration->rig.forward = Eigen::Vector3d::UnitX();
  return ReadWith(
      table.string(),
      [&](const std::string& text) { ParseTable(text, channels, options, calibration); }, error);
}

}  // namespace rigel
