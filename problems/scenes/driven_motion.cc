#include "rigel/problems/scenes/driven_motion.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/kitti_poses.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

bool ListPoseFiles(const std::string& directory, std::vector<std::filesystem::path>* files,
                   std::string* error) {
  namespace fs = std::filesystem;
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

}  // namespace

bool ReadDrivenMotions(const std::string& directory, int every, std::vector<DrivenMotion>* motions,
                       std::string* error) {
  std::vector<std::filesystem::path> files;
  if (!ListPoseFiles(directory, &files, error)) return false;
  std::vector<DrivenMotion> result;
  for (const std::filesystem::path& file : files) {
    std::vector<Pose> poses;
    if (!ReadKittiPoses(file.string(), &poses, error)) return false;
    for (size_t k = 1; k < poses.size(); k += static_cast<size_t>(every)) {
      result.push_back({file.stem().string(), poses[k - 1], poses[k]});
    }
  }
  if (result.empty()) {
    *error = Printable(directory) + ": no motion: no file has two poses";
    return false;
  }
  *motions = std::move(result);
  return true;
}

bool MakeDrivenPair(const SceneOptions& options, int index, const DrivenMotion& motion,
                    FramePair* pair, std::string* error) {
  if (!MakeScenePair(options, index, motion.body2_from_body1(), pair, error)) return false;
  pair->sequence = motion.sequence;
  const Eigen::Vector3d down = Eigen::Vector3d::UnitY();
  pair->prior.gravity1 = motion.world_from_body1.R.transpose() * down;
  pair->prior.gravity2 = motion.world_from_body2.R.transpose() * down;
  return true;
}

}  // namespace rigel
