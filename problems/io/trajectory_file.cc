#include "rigel/problems/io/trajectory_file.h"

#include <filesystem>

#include "rigel/problems/io/csv.h"

namespace rigel {

std::string FormatKittiTrajectory(const std::vector<Pose>& world_from_body) {
  std::string text;
  for (const Pose& pose : world_from_body) {
    for (int row = 0; row < 3; ++row) {
      for (int c = 0; c < 3; ++c) text += CsvNumber(pose.R(row, c)) + " ";
      text += CsvNumber(pose.t(row)) + (row < 2 ? " " : "\n");
    }
  }
  return text;
}

std::string FormatTumTrajectory(const std::vector<Pose>& world_from_body,
                                const std::vector<double>& times, const BodyAxes& axes) {
  std::string text = "# body: down " + DirectionText(axes.down) + ", forward " +
                     DirectionText(axes.forward) + "\n";
  if (times.empty()) text += "# no times that ascend in the match files: poses are numbered\n";
  for (size_t k = 0; k < world_from_body.size(); ++k) {
    const Pose& pose = world_from_body[k];
    const Eigen::Quaterniond q = pose.Quaternion();
    text += times.empty() ? std::to_string(k) : CsvNumber(times[k]);
    for (const double v : {pose.t.x(), pose.t.y(), pose.t.z(), q.x(), q.y(), q.z(), q.w()}) {
      text += " " + CsvNumber(v);
    }
    text += "\n";
  }
  return text;
}

std::string TrajectoryPath(const std::string& path, size_t index, size_t count, bool truth) {
  const std::filesystem::path file(path);
  std::string name = file.stem().string();
  if (truth) name += "_truth";
  if (count > 1) name += "_" + std::to_string(index);
  return (file.parent_path() / (name + file.extension().string())).string();
}

}  // namespace rigel
