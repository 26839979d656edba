#include "rigel/problems/rigs/kitti_rig.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/kitti_projection.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxCameras = 100;  // XX has two digits

// The lines KEY: TEXT of a file, by their keys.
using Lines = std::map<std::string, TextLine>;

Lines KeyedLines(const std::string& text) {
  Lines lines;
  for (const TextLine& line : LinesOf(text)) {
    const size_t colon = line.text.find(':');
    if (colon == std::string::npos) continue;
    lines[line.text.substr(0, colon)] = {line.number, line.text.substr(colon + 1)};
  }
  return lines;
}

const TextLine& LineOf(const Lines& lines, const std::string& key) {
  const auto found = lines.find(key);
  if (found == lines.end()) throw LineError(0, "the line " + key + ": is missing");
  return found->second;
}

std::vector<double> NumbersOfKey(const Lines& lines, const std::string& key, size_t count) {
  const TextLine& line = LineOf(lines, key);
  const std::vector<std::string_view> words = SplitAtBlanks(line.text);
  if (words.size() != count) {
    throw LineError(line.number, key + ": " + std::to_string(words.size()) + " numbers, expected " +
                                     std::to_string(count));
  }
  return NumbersOf(words, key, line.number);
}

std::string TwoDigits(int k) { return (k < 10 ? "0" : "") + std::to_string(k); }

void AddProjection(const Lines& lines, const std::string& key, const std::string& name,
                   const ImageSize& size, RigFile* rig) {
  const TextLine& line = LineOf(lines, key);
  RigCamera camera;
  std::string what;
  if (!ParseKittiProjection(line.text, &camera, &what)) {
    throw LineError(line.number, key + ": " + what);
  }
  camera.intrinsics.width = size.width;
  camera.intrinsics.height = size.height;
  AddCamera(name, camera.intrinsics, {camera.Q, camera.s}, rig);
  rig->camera_images.back() = name;
}

// "S_00" or "S_rect_00".
ImageSize SizeOf(const Lines& lines, const std::string& key) {
  const std::vector<double> size = NumbersOfKey(lines, key, 2);
  const int line = LineOf(lines, key).number;
  return {PixelsOf(size[0], key, line), PixelsOf(size[1], key, line)};
}

void AddRawCamera(const Lines& lines, const std::string& number, RigFile* rig) {
  const std::vector<double> K = NumbersOfKey(lines, "K_" + number, 9);
  const std::vector<double> d = NumbersOfKey(lines, "D_" + number, 5);
  const std::vector<double> R = NumbersOfKey(lines, "R_" + number, 9);
  const std::vector<double> T = NumbersOfKey(lines, "T_" + number, 3);
  const std::vector<double> zeros_and_one = {K[1], K[3], K[6], K[7], K[8]};
  if (zeros_and_one != std::vector<double>{0, 0, 0, 0, 1}) {
    throw LineError(LineOf(lines, "K_" + number).number,
                    "K_" + number + ": expected FX 0 CX 0 FY CY 0 0 1");
  }
  const Pose camera_from_body =
      PoseOfRows({R[0], R[1], R[2], T[0], R[3], R[4], R[5], T[1], R[6], R[7], R[8], T[2]},
                 "R_" + number, LineOf(lines, "R_" + number).number);
  const ImageSize size = SizeOf(lines, "S_" + number);
  Camera lens = Camera::Pinhole(K[0], K[4], K[2], K[5], size.width, size.height);
  if (std::any_of(d.begin(), d.end(), [](double x) { return x != 0; })) {
    lens.model = CameraModel::kFullOpencv;  // k1 k2 p1 p2 k3 and zeros
    std::copy(d.begin(), d.end(), lens.parameters + 4);
  }
  AddCamera("image_" + number, lens, camera_from_body.Inverse(), rig);
  rig->camera_images.back() = "image_" + number + "/data";
}

bool ReadCamToCam(const std::string& path, bool rectified, Calibration* calibration,
                  std::string* error) {
  const std::string prefix = rectified ? "P_rect_" : "K_";
  const auto parse = [&](const std::string& text) {
    const Lines lines = KeyedLines(text);
    for (int k = 0; k < kMaxCameras; ++k) {
      const std::string number = TwoDigits(k);
      if (lines.count(prefix + number) == 0) continue;
      if (rectified) {
        AddProjection(lines, prefix + number, "image_" + number, SizeOf(lines, "S_rect_" + number),
                      &calibration->rig);
        calibration->rig.camera_images.back() += "/data";
      } else {
        AddRawCamera(lines, number, &calibration->rig);
      }
    }
    if (calibration->rig.rig.cameras.empty()) {
      throw LineError(0, "no line " + prefix + "00:, expected KITTI's calib_cam_to_cam.txt");
    }
  };
  calibration->body = rectified ? "camera 0, rectified" : "camera 0";
  calibration->rig.down = Eigen::Vector3d::UnitY();
  calibration->rig.forward = Eigen::Vector3d::UnitZ();
  calibration->notes.emplace_back(
      rectified ? "of the rectified (synced) images"
                : "of images that are not rectified; kitti_rectified is of the rectified (synced)");
  const std::string name = "calib_cam_to_cam.txt";
  return ReadWith(IsDirectory(path) ? (fs::path(path) / name).string() : path, parse, error);
}

}  // namespace

bool ReadKittiRig(const std::string& path, const CalibrationOptions& options,
                  Calibration* calibration, std::string* error) {
  const auto parse = [&](const std::string& text) {
    const Lines lines = KeyedLines(text);
    if (lines.count("P0") == 0) throw LineError(0, "no line P0:, expected KITTI's calib.txt");
    if (!options.size) {
      throw LineError(0, "states no image size, expected --size=1241x376 or as the images are");
    }
    for (int k = 0; k < kMaxCameras; ++k) {
      const std::string number = std::to_string(k);
      if (lines.count("P" + number) == 0) continue;
      AddProjection(lines, "P" + number, "image_" + number, *options.size, &calibration->rig);
    }
  };
  calibration->body = "camera 0, rectified";
  calibration->rig.down = Eigen::Vector3d::UnitY();
  calibration->rig.forward = Eigen::Vector3d::UnitZ();
  return ReadWith(IsDirectory(path) ? (fs::path(path) / "calib.txt").string() : path, parse, error);
}

bool ReadKittiRawRig(const std::string& path, const CalibrationOptions& /*options*/,
                     Calibration* calibration, std::string* error) {
  return ReadCamToCam(path, false, calibration, error);
}

bool ReadKittiRectifiedRig(const std::string& path, const CalibrationOptions& /*options*/,
                           Calibration* calibration, std::string* error) {
  return ReadCamToCam(path, true, calibration, error);
}

}  // namespace rigel
