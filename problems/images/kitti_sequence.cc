#include "rigel/problems/images/kitti_sequence.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <set>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/kitti_poses.h"
#include "rigel/problems/io/kitti_projection.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/text_lines.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr int kDigits = 6;           // of an image's name
constexpr int kMaxFrame = 10000000;  // 11 days at 10 Hz

std::string ImageName(int frame) {
  char name[32];
  std::snprintf(name, sizeof(name), "%0*d.png", kDigits, frame);
  return name;
}

// -1 if it is not the name of an image, kMaxFrame + 1 if its number is beyond the bound.
int FrameOfImage(const std::string& name) {
  int64_t number = -1;
  std::from_chars(name.data(), name.data() + name.size(), number);
  if (number > kMaxFrame) {
    return name == std::to_string(number) + ".png" ? kMaxFrame + 1 : -1;
  }
  const int frame = static_cast<int>(number);
  return frame >= 0 && name == ImageName(frame) ? frame : -1;
}

// The numbers of the images in a camera's folder. False with a message if one is beyond the bound.
bool AddFrames(const fs::path& directory, std::set<int>* frames, std::string* error) {
  std::string too_large;  // the name of an image
  const auto add = [&](const std::string& name, bool /*is_directory*/) {
    const int frame = FrameOfImage(name);
    if (frame > kMaxFrame) too_large = name;
    if (frame >= 0 && frame <= kMaxFrame) frames->insert(frame);
  };
  if (!ListDirectory(directory, add, error)) return false;
  if (too_large.empty()) return true;
  *error = Printable((directory / too_large).string()) + ": expected an image number up to " +
           std::to_string(kMaxFrame);
  return false;
}

bool ReadCalibration(const std::string& path, const std::array<int, 2>& numbers,
                     std::vector<ImageCamera>* cameras, std::string* error) {
  std::vector<TextLine> lines;
  if (!ReadTextLines(path, &lines, error)) return false;
  for (const int number : numbers) {
    const std::string key = "P" + std::to_string(number) + ":";
    const auto line = std::find_if(lines.begin(), lines.end(), [&](const TextLine& candidate) {
      return candidate.text.compare(0, key.size(), key) == 0;
    });
    if (line == lines.end()) {
      *error = Printable(path) + ": no line '" + key + "', expected " + key +
               " and the 12 numbers of camera " + std::to_string(number) + "'s 3x4 projection";
      return false;
    }
    ImageCamera camera;
    std::string what;
    if (!ParseKittiProjection(std::string_view(line->text).substr(key.size()), &camera.camera,
                              &what)) {
      *error = Where(path, *line) + ": " + key + " " + what;
      return false;
    }
    cameras->push_back(camera);
  }
  return true;
}

bool ReadTimes(const std::string& path, std::vector<double>* times, std::string* error) {
  std::vector<TextLine> lines;
  if (!ReadFrameLines(path, &lines, error)) return false;
  for (const TextLine& line : lines) {
    double time;
    if (!ParseFinite(line.text, &time)) {
      *error = Where(path, line) + ": " + Quoted(line.text) + ", expected a time in seconds";
      return false;
    }
    times->push_back(time);
  }
  return true;
}

// The cameras' folders beside those that are used; empty if there are none.
std::string Unused(const fs::path& directory, const std::array<int, 2>& used) {
  constexpr int kCameras = 10;  // image_0 to image_9 are looked for; KITTI has four
  std::string names;
  for (int k = 0; k < kCameras; ++k) {
    const std::string name = "image_" + std::to_string(k);
    if (k == used[0] || k == used[1] || !IsDirectory(directory / name)) continue;
    names += (names.empty() ? "" : ", ") + name;
  }
  if (names.empty()) return "";
  return Printable(directory.string()) + ": not used: " + names + "; the rig is image_" +
         std::to_string(used[0]) + " and image_" + std::to_string(used[1]);
}

// The note for a file with fewer lines than the sequence has frames; empty if it has enough.
std::string TooShort(const std::string& path, size_t lines, size_t frames, const char* what) {
  if (lines >= frames) return "";
  return Printable(path) + ": " + std::to_string(lines) + " lines for " + std::to_string(frames) +
         " frames; those beyond get no " + what;
}

fs::path CameraFolder(const fs::path& directory, int camera) {
  return directory / ("image_" + std::to_string(camera));
}

// The grey stereo pair, or the colour pair where there is no grey one.
bool FindCameras(const fs::path& directory, std::array<int, 2>* cameras, std::string* error) {
  // Numbers of the folders image_N: those of KITTI's stereo pairs, grey before colour.
  constexpr std::array<int, 2> kPairs[] = {{0, 1}, {2, 3}};
  for (const std::array<int, 2>& pair : kPairs) {
    if (!IsDirectory(CameraFolder(directory, pair[0]))) continue;
    if (!IsDirectory(CameraFolder(directory, pair[1]))) continue;
    *cameras = pair;
    return true;
  }
  *error = Printable(directory.string()) +
           ": expected image_0 and image_1 in it, or image_2 and image_3";
  return false;
}

// The frames of which a camera has an image.
bool FindImages(const fs::path& directory, const std::array<int, 2>& cameras,
                ImageSequence* sequence, std::string* error) {
  const std::array<std::string, 2> folders = {CameraFolder(directory, cameras[0]).string(),
                                              CameraFolder(directory, cameras[1]).string()};
  std::set<int> frames;
  for (const std::string& folder : folders) {
    if (!AddFrames(folder, &frames, error)) return false;
  }
  if (frames.empty()) {
    *error = Printable(folders[0]) + ": no images (000000.png, ...) in it";
    return false;
  }
  sequence->image_path = [folders](int frame, int camera) {
    return (fs::path(folders[camera]) / ImageName(frame)).string();
  };
  for (const int k : frames) {
    sequence->frames.Add(k, {{sequence->image_path(k, 0), sequence->image_path(k, 1)}, {}, {}});
  }
  return true;
}

// The times of the frames, if the file is there.
bool AddTimes(const std::string& path, ImageSequence* sequence, std::string* error) {
  if (!Exists(path)) return true;
  std::vector<double> times;
  if (!ReadTimes(path, &times, error)) return false;
  ImageFrames& frames = sequence->frames;
  for (const size_t k : frames.numbers()) {
    if (k < times.size()) frames[k].time = times[k];
  }
  sequence->notes.push_back(TooShort(path, times.size(), frames.size(), "time"));
  return true;
}

// The poses of the frames, if the file is there.
bool AddTruth(const std::string& path, ImageSequence* sequence, std::string* error) {
  if (!Exists(path)) return true;
  std::vector<Pose> poses;
  if (!ReadKittiPoses(path, &poses, error)) return false;
  ImageFrames& frames = sequence->frames;
  for (const size_t k : frames.numbers()) {
    if (k < poses.size()) frames[k].world_from_body = poses[k];
  }
  sequence->notes.push_back(TooShort(path, poses.size(), frames.size(), "truth"));
  return true;
}

}  // namespace

bool ReadKittiSequence(const std::string& root, const std::string& name, ImageSequence* sequence,
                       std::string* error) {
  const fs::path directory = fs::path(root) / "sequences" / name;
  if (!IsDirectory(directory)) {
    *error = Printable(directory.string()) +
             ": no such directory, expected sequences/NAME of KITTI odometry below the root";
    return false;
  }
  ImageSequence result;
  result.name = name;
  result.camera_pairs = {{0, 1}};
  std::array<int, 2> cameras;
  if (!FindCameras(directory, &cameras, error) ||
      !ReadCalibration((directory / "calib.txt").string(), cameras, &result.cameras, error)) {
    return false;
  }
  result.notes.push_back(Unused(directory, cameras));
  if (!FindImages(directory, cameras, &result, error) ||
      !AddTimes((directory / "times.txt").string(), &result, error) ||
      !AddTruth((fs::path(root) / "poses" / (name + ".txt")).string(), &result, error)) {
    return false;
  }
  result.notes.erase(std::remove(result.notes.begin(), result.notes.end(), ""), result.notes.end());
  *sequence = std::move(result);
  return true;
}

}  // namespace rigel
