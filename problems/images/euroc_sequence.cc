#include "rigel/problems/images/euroc_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <system_error>

#include "rigel/problems/images/frame_stamps.h"
#include "rigel/problems/images/rig_sequence.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/rotation_check.h"
#include "rigel/problems/io/text_lines.h"
#include "rigel/problems/rigs/euroc_rig.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

// Nanoseconds: ten intervals of the truth at 200 Hz. In a longer gap linear interpolation is too
// inaccurate for the path of a drone.
constexpr int64_t kMaxTruthGap = 50'000'000;
constexpr double kSecondsPerNanosecond = 1e-9;

// Pixels of radial-tangential lenses are moved to those of pinholes. Others stay as they are.
bool ReadCamera(const std::string& path, ImageCamera* camera, std::string* error) {
  if (!ReadEurocSensor(path, &camera->camera, error)) return false;
  Camera& c = camera->camera.intrinsics;
  if (c.model != CameraModel::kOpencv) return true;
  camera->lens = c;
  c = Camera::Pinhole(c.fx(), c.fy(), c.cx(), c.cy(), c.width, c.height);
  return true;
}

// Whether a name from a file stays below the folder that it is joined to.
bool StaysInside(const fs::path& name) {
  return name.is_relative() && std::find(name.begin(), name.end(), "..") == name.end();
}

using Images = std::map<int64_t, std::string>;  // time stamp, path

bool ReadImageList(const fs::path& camera, Images* images, std::string* error) {
  const std::string path = (camera / "data.csv").string();
  std::vector<TextLine> lines;
  if (!ReadTextLines(path, &lines, error)) return false;
  for (const TextLine& line : lines) {
    const std::vector<std::string_view> words = SplitAtCommas(line.text);
    int64_t time;
    if (words.size() != 2 || !ParseInteger(words[0], int64_t{0}, &time) || words[1].empty()) {
      *error = Where(path, line) + ": " + Quoted(line.text) +
               ", expected a time stamp in nanoseconds, a comma and a file name";
      return false;
    }
    if (!StaysInside(words[1])) {
      *error = Where(path, line) + ": " + Quoted(words[1]) +
               " leads out of the folder, expected a file in " +
               Printable((camera / "data").string());
      return false;
    }
    if (!images->emplace(time, (camera / "data" / words[1]).string()).second) {
      *error = Where(path, line) + ": the time stamp " + std::to_string(time) + " occurs twice";
      return false;
    }
  }
  if (images->empty()) {
    *error = Printable(path) + ": there is no image in it";
    return false;
  }
  return true;
}

using Poses = std::map<int64_t, Pose>;

bool ReadTruth(const std::string& path, Poses* poses, std::string* error) {
  constexpr size_t kColumns = 8;  // those that are used
  std::vector<TextLine> lines;
  if (!ReadTextLines(path, &lines, error)) return false;
  for (const TextLine& line : lines) {
    const std::vector<std::string_view> words = SplitAtCommas(line.text);
    if (words.size() < kColumns) {
      *error = Where(path, line) + ": " + std::to_string(words.size()) +
               " columns, expected at least 8: time stamp, p x y z, q w x y z";
      return false;
    }
    int64_t time;
    if (!ParseInteger(words[0], int64_t{0}, &time)) {
      *error = Where(path, line) + ": " + Quoted(words[0]) + ", expected a time stamp in ns";
      return false;
    }
    double v[kColumns];
    for (size_t k = 1; k < kColumns; ++k) {
      if (!ParseFinite(words[k], &v[k])) {
        *error = Where(path, line) + ": column " + std::to_string(k + 1) + " is " +
                 Quoted(words[k]) + ", expected a finite number";
        return false;
      }
    }
    const Eigen::Quaterniond q(v[4], v[5], v[6], v[7]);
    if (!(std::abs(q.norm() - 1.0) <= kMaxRotationError)) {
      *error = Where(path, line) + ": the quaternion is not of unit length";
      return false;
    }
    (*poses)[time] = Pose::FromQuaternion(q, {v[1], v[2], v[3]});
  }
  return true;
}

std::optional<Pose> Interpolate(const Poses& poses, int64_t time) {
  const auto after = poses.lower_bound(time);
  if (after == poses.end()) return std::nullopt;
  if (after->first == time) return after->second;
  if (after == poses.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const int64_t gap = after->first - before->first;
  if (gap > kMaxTruthGap) return std::nullopt;
  const double share = static_cast<double>(time - before->first) / static_cast<double>(gap);
  const Eigen::Quaterniond q = before->second.Quaternion().slerp(share, after->second.Quaternion());
  return Pose::FromQuaternion(q, (1 - share) * before->second.t + share * after->second.t);
}

// The name of the folder that holds mav0.
std::string NameOfFolder(const fs::path& mav) {
  std::error_code code;
  fs::path full = fs::canonical(mav, code);
  if (code) full = mav;
  std::string name = full.filename().string();
  if (name == "mav0") name = full.parent_path().filename().string();
  return name.empty() ? "euroc" : SequenceName(name);
}

// How many images of a camera have no partner; empty if none.
std::string LeftOut(const std::string& camera, size_t left_out, size_t all,
                    const std::string& other) {
  if (left_out == 0) return "";
  return camera + ": " + std::to_string(left_out) + " of " + std::to_string(all) +
         " images are left out: no image of " + other + " is of their time";
}

Stamps StampsOf(const Images& images) {
  Stamps stamps;
  for (const auto& [time, path] : images) stamps.push_back(time);
  return stamps;
}

// The frames of the images of both cameras. False, with what is wrong, if there are none.
bool PairImages(const Images (&images)[2], const EurocOptions& options, ImageSequence* sequence,
                Stamps* times, std::string* what) {
  const std::vector<Stamps> stamps = {StampsOf(images[0]), StampsOf(images[1])};
  const StampFrames grouped = GroupStamps(stamps, options.sync_tolerance_ms);
  for (const StampFrame& both : grouped.frames) {
    if (both.images[0] < 0 || both.images[1] < 0) continue;
    times->push_back(both.time);
    ImageFrame frame;
    frame.images = {images[0].at(both.time), images[1].at(stamps[1][both.images[1]])};
    frame.time = static_cast<double>(both.time) * kSecondsPerNanosecond;
    sequence->frames.push_back(std::move(frame));
  }
  if (times->empty()) {
    int64_t least = std::numeric_limits<int64_t>::max();
    for (const auto& [k, partner] : PairStamps(stamps[0], stamps[1], least)) {
      least = std::min(least, std::abs(stamps[1][partner] - stamps[0][k]));
    }
    *what = "no image of cam1 is of the time of one of cam0, within " + grouped.within +
            "; the nearest are " + Milliseconds(least) + " apart";
    return false;
  }
  if (grouped.largest > 0) {
    sequence->settings.push_back(grouped.setting);
    sequence->notes.push_back("time stamps of cam0 and cam1 differ by up to " +
                              Milliseconds(grouped.largest) + ", within " + grouped.within);
  }
  return true;
}

}  // namespace

bool EurocOptions::IsValid(std::string* error) const {
  return IsSyncTolerance(sync_tolerance_ms, error);
}

bool ReadEurocSequence(const std::string& root, const EurocOptions& options,
                       ImageSequence* sequence, std::string* error) {
  if (!options.IsValid(error)) return false;
  const fs::path mav =
      IsDirectory(fs::path(root) / "mav0") ? fs::path(root) / "mav0" : fs::path(root);
  const auto camera_folder = [&](int k) { return mav / ("cam" + std::to_string(k)); };
  if (!IsDirectory(camera_folder(0)) || !IsDirectory(camera_folder(1))) {
    *error = Printable(root) +
             ": expected EuRoC's folder mav0 with cam0 and cam1, or the folder that holds mav0";
    return false;
  }
  ImageSequence result;
  result.name = NameOfFolder(mav);
  result.world_down = -Eigen::Vector3d::UnitZ();
  result.camera_pairs = {{0, 1}};

  Images images[2];
  for (int k = 0; k < 2; ++k) {
    const fs::path camera = camera_folder(k);
    result.cameras.emplace_back();
    if (!ReadCamera((camera / "sensor.yaml").string(), &result.cameras.back(), error) ||
        !ReadImageList(camera, &images[k], error)) {
      return false;
    }
  }
  for (int k = 2; IsDirectory(camera_folder(k)); ++k) {
    result.notes.push_back(Printable(camera_folder(k).string()) +
                           ": not used; the rig is cam0 and cam1");
  }
  Stamps times;
  std::string what;
  if (!PairImages(images, options, &result, &times, &what)) {
    *error = Printable(mav.string()) + ": " + what;
    return false;
  }
  for (int k = 0; k < 2; ++k) {
    result.notes.push_back(LeftOut(Printable((camera_folder(k) / "data.csv").string()),
                                   images[k].size() - times.size(), images[k].size(),
                                   k == 0 ? "cam1" : "cam0"));
  }

  const std::string truth_path = (mav / "state_groundtruth_estimate0" / "data.csv").string();
  if (Exists(truth_path)) {
    Poses poses;
    if (!ReadTruth(truth_path, &poses, error)) return false;
    size_t without = 0;
    for (size_t k = 0; k < times.size(); ++k) {
      result.frames[k].world_from_body = Interpolate(poses, times[k]);
      if (!result.frames[k].world_from_body) ++without;
    }
    if (without > 0) {
      result.notes.push_back(Printable(truth_path) + ": " + std::to_string(without) + " of " +
                             std::to_string(times.size()) +
                             " frames lie outside it or in a gap of it and get no truth");
    }
  }
  result.notes.erase(std::remove(result.notes.begin(), result.notes.end(), ""), result.notes.end());
  *sequence = std::move(result);
  return true;
}

}  // namespace rigel
