#include "rigel/problems/rigs/rig_formats.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/argoverse_rig.h"
#include "rigel/problems/rigs/calibration_text.h"
#include "rigel/problems/rigs/colmap_rig.h"
#include "rigel/problems/rigs/euroc_rig.h"
#include "rigel/problems/rigs/kalibr_rig.h"
#include "rigel/problems/rigs/kitti_rig.h"
#include "rigel/problems/rigs/nuscenes_rig.h"
#include "rigel/problems/rigs/orbslam_rig.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

bool ReadRigelRig(const std::string& path, const CalibrationOptions& /*options*/,
                  Calibration* calibration, std::string* error) {
  calibration->body = "as the file has it";
  return ReadRigFile(path, &calibration->rig, error);
}

struct Format {
  const char* name;
  bool has_quaternions;
  bool (*read)(const std::string&, const CalibrationOptions&, Calibration*, std::string*);
};
constexpr Format kFormats[] = {{"rigel", true, ReadRigelRig},
                               {"kalibr", false, ReadKalibrRig},
                               {"openvins", false, ReadKalibrRig},
                               {"orbslam3", false, ReadOrbslamRig},
                               {"euroc", false, ReadEurocRig},
                               {"colmap", true, ReadColmapRig},
                               {"kitti", false, ReadKittiRig},
                               {"kitti_raw", false, ReadKittiRawRig},
                               {"kitti_rectified", false, ReadKittiRectifiedRig},
                               {"nuscenes", true, ReadNuscenesRig},
                               {"argoverse2", true, ReadArgoverseRig}};

const Format* Find(const std::string& name) {
  const auto* const found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                         [&](const Format& f) { return name == f.name; });
  return found == std::end(kFormats) ? nullptr : found;
}

// What a folder has in it, the first that is there.
constexpr std::pair<const char*, const char*> kOfFolders[] = {
    {"mav0/cam0/sensor.yaml", "euroc"},
    {"cam0/sensor.yaml", "euroc"},
    {"calibrated_sensor.json", "nuscenes"},
    {"intrinsics.csv", "argoverse2"},
    {"calibration/intrinsics.csv", "argoverse2"},
    {"rigs.txt", "colmap"},
    {"rig_config.json", "colmap"},
    {"calib_cam_to_cam.txt", "kitti_raw"},
    {"calib.txt", "kitti"}};

// How a line of a file begins, the first that is there.
constexpr std::pair<const char*, const char*> kOfLines[] = {
    {"T_BS:", "euroc"},          {"Camera.type:", "orbslam3"},
    {"cam0:", "kalibr"},         {"P0:", "kitti"},
    {"K_00:", "kitti_raw"},      {"P_rect_00:", "kitti_rectified"},
    {"calib_time:", "kitti_raw"}};

// What JSON has in it.
constexpr std::pair<const char*, const char*> kOfJson[] = {{"\"rigel-rig", "rigel"},
                                                           {"\"sensor_token\"", "nuscenes"},
                                                           {"\"image_prefix\"", "colmap"},
                                                           {"\"cameras\"", "rigel"}};

const char* FormatOfLines(const std::string& text) {
  const std::vector<TextLine> lines = LinesOf(text);
  for (const auto& [begin, format] : kOfLines) {
    const std::string_view start = begin;
    for (const TextLine& line : lines) {
      if (line.text.compare(0, start.size(), start) == 0) return format;
    }
  }
  if (lines.empty()) return nullptr;
  if (lines[0].text.find("sensor_name") != std::string::npos) return "argoverse2";
  const std::vector<std::string_view> words = SplitAtBlanks(lines[0].text);
  const bool is_rigs = words.size() >= 4 && (words[2] == "CAMERA" || words[2] == "IMU");
  return is_rigs ? "colmap" : nullptr;
}

const char* FormatOfText(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t\r\n");
  const bool is_json = begin != std::string::npos && (text[begin] == '[' || text[begin] == '{');
  if (!is_json) return FormatOfLines(text);
  for (const auto& [part, format] : kOfJson) {
    if (text.find(part) != std::string::npos) return format;
  }
  return nullptr;
}

// What Rig::IsValid() does not ask of a rig.
bool HasSizes(const RigFile& rig, std::string* error) {
  for (size_t k = 0; k < rig.rig.cameras.size(); ++k) {
    const Camera& lens = rig.rig.cameras[k].intrinsics;
    if (lens.width >= 1 && lens.height >= 1) continue;
    *error = rig.camera_names[k] + " has no image size";
    return false;
  }
  return true;
}

}  // namespace

std::string RigFormatNames() {
  std::string names;
  for (const Format& format : kFormats)
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

bool IsRigFormat(const std::string& name) { return Find(name) != nullptr; }

bool HasQuaternions(const std::string& format) {
  const Format* const found = Find(format);
  return found != nullptr && found->has_quaternions;
}

bool DetectRigFormat(const std::string& path, std::string* format, std::string* error) {
  const char* found = nullptr;
  if (IsDirectory(path)) {
    for (const auto& [name, candidate] : kOfFolders) {
      if (found == nullptr && Exists(fs::path(path) / name)) found = candidate;
    }
  } else if (!ReadWith(
                 path, [&](const std::string& text) { found = FormatOfText(text); }, error)) {
    return false;
  }
  if (found == nullptr) {
    *error = Printable(path) + ": not known as a calibration, expected one of " + RigFormatNames();
    return false;
  }
  *format = found;
  return true;
}

bool ReadRigCalibration(const std::string& path, const std::string& format,
                        const CalibrationOptions& options, Calibration* calibration,
                        std::string* error) {
  const Format* const known = Find(format);
  if (known == nullptr) {
    *error = "format " + Quoted(format) + ", expected one of " + RigFormatNames();
    return false;
  }
  try {
    Calibration result;
    if (!known->read(path, options, &result, error)) return false;
    std::string what;
    if (!HasSizes(result.rig, &what) || !result.rig.rig.IsValid(&what)) {
      *error = Printable(path + ": " + what);
      return false;
    }
    *calibration = std::move(result);
    return true;
  } catch (const std::exception& exception) {  // paths, memory
    *error = Printable(path) + ": " + ExceptionMessage(exception);
    return false;
  }
}

}  // namespace rigel
