#include "rigel/problems/io/kitti_poses.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/rotation_check.h"
#include "rigel/problems/io/text_lines.h"

namespace rigel {
namespace {

// False with what is wrong.
bool ParsePose(std::string_view line, Pose* pose, std::string* error) {
  std::array<double, 12> m;
  const std::vector<std::string_view> words = SplitAtBlanks(line);
  for (size_t k = 0; k < std::min(words.size(), m.size()); ++k) {
    if (!ParseFinite(words[k], &m[k])) {
      *error = "number " + std::to_string(k + 1) + " is " + Quoted(words[k]) +
               ", expected a finite number";
      return false;
    }
  }
  if (words.size() != m.size()) {
    *error = std::to_string(words.size()) + " numbers, expected 12: the rows of a 3x4 matrix";
    return false;
  }
  Eigen::Matrix3d R;
  R << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  if (!IsNearRotation(R)) {
    *error = "the first three columns are not a rotation, expected R'R = I within 0.001";
    return false;
  }
  *pose = Pose::FromQuaternion(Eigen::Quaterniond(R), {m[3], m[7], m[11]});
  return true;
}

}  // namespace

bool ReadKittiPoses(const std::string& path, std::vector<Pose>* world_from_camera,
                    std::string* error) {
  std::vector<TextLine> lines;
  if (!ReadFrameLines(path, &lines, error)) return false;
  std::vector<Pose> poses;
  for (const TextLine& line : lines) {
    Pose pose;
    std::string what;
    if (!ParsePose(line.text, &pose, &what)) {
      *error = Where(path, line) + ": " + what;
      return false;
    }
    poses.push_back(pose);
  }
  if (poses.empty()) {
    *error = Printable(path) + ": there is no pose in it";
    return false;
  }
  *world_from_camera = std::move(poses);
  return true;
}

}  // namespace rigel
