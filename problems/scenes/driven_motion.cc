#include "rigel/problems/scenes/driven_motion.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/kitti_poses.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

bool ListPoseFiles(const std::string& directory, std::vector<std::filesystem::path>* files,
                   std::string* error) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::is_regular_file(directory, ignored)) {
    files->emplace_back(directory);
    return true;
  }
  const auto add = [&](const std::string& name, bool is_directory) {
    const fs::path file = fs::path(directory) / name;
    if (file.extension() == ".txt" && !is_directory) files->push_back(file);
  };
  if (!ListDirectory(directory, add, error)) return false;
  if (files->empty()) {
    *error = Printable(directory) + ": no pose files (00.txt, ...) in this directory";
    return false;
  }
  std::sort(files->begin(), files->end(),
            [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
  return true;
}

// The sequence, and gravity: "down" is the Y of KITTI's first frame.
void StateDrive(const DrivenMotion& motion, const Eigen::Matrix3d& body_from_kitti,
                FramePair* pair) {
  const Eigen::Vector3d down = Eigen::Vector3d::UnitY();
  pair->sequence = motion.sequence;
  pair->prior.gravity1 = body_from_kitti * (motion.world_from_body1.R.transpose() * down);
  pair->prior.gravity2 = body_from_kitti * (motion.world_from_body2.R.transpose() * down);
}

}  // namespace

bool ReadDrivenMotions(const std::string& path, int every, std::vector<DrivenMotion>* motions,
                       std::string* error) {
  std::vector<std::filesystem::path> files;
  if (!ListPoseFiles(path, &files, error)) return false;
  std::vector<DrivenMotion> result;
  for (const std::filesystem::path& file : files) {
    std::vector<Pose> poses;
    if (!ReadKittiPoses(file.string(), &poses, error)) return false;
    for (size_t k = 1; k < poses.size(); k += static_cast<size_t>(every)) {
      result.push_back({file.stem().string(), poses[k - 1], poses[k]});
    }
  }
  if (result.empty()) {
    *error = Printable(path) + ": no motion: no file has two poses";
    return false;
  }
  *motions = std::move(result);
  return true;
}

bool MakeDrivenPair(const SceneOptions& options, int index, const DrivenMotion& motion,
                    FramePair* pair, std::string* error) {
  if (!MakeScenePair(options, index, motion.body2_from_body1(), pair, error)) return false;
  StateDrive(motion, Eigen::Matrix3d::Identity(), pair);
  return true;
}

bool MakeDrivenPair(const StreetOptions& options, int index, const DrivenMotion& motion,
                    FramePair* pair, std::string* error) {
  const Pose driven = motion.body2_from_body1();
  Eigen::Matrix3d body_from_kitti;  // x right, y down, z forward
  body_from_kitti << options.axes.Right(), options.axes.down, options.axes.forward;
  Pose truth;
  truth.R = body_from_kitti * driven.R * body_from_kitti.transpose();
  truth.t = body_from_kitti * driven.t;
  if (!MakeStreetPair(options, index, truth, pair, error)) return false;
  StateDrive(motion, body_from_kitti, pair);
  return true;
}

}  // namespace rigel
