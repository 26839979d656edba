#include "rigel/problems/rigs/rig_table.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rigel/core/angles.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/rigs/field_of_view.h"

namespace rigel {
namespace {

// Characters, so that a row has at most 100.
constexpr size_t kNameWidth = 15, kModelWidth = 14;

std::string Degrees(double radians) {
  constexpr double kZero = 0.05;  // shown as 0.0, without a sign
  const double degrees = RadToDeg(radians);
  return FormatNumber(std::abs(degrees) < kZero ? 0.0 : degrees, 1);
}

std::string Metres(double metres) {
  constexpr double kZero = 5e-4;  // shown as 0.000, without a sign
  return FormatNumber(std::abs(metres) < kZero ? 0.0 : metres, 3);
}

void AddCamera(const RigCamera& camera, const std::string& name, const BodyAxes& axes,
               Table* table) {
  const Camera& lens = camera.intrinsics;
  // Rows: right, down, forward.
  Eigen::Matrix3d vehicle_from_body;
  vehicle_from_body << axes.Right().transpose(), axes.down.transpose(), axes.forward.transpose();
  const Eigen::Matrix3d R = vehicle_from_body * camera.Q;
  const double right = std::atan2(R(0, 2), R(2, 2));
  const double up = std::atan2(-R(1, 2), std::hypot(R(0, 2), R(2, 2)));
  // A camera that is turned clockwise has its right side lower.
  const double roll = std::atan2(R(1, 0), R(1, 1));
  table->AddRow({Shortened(name, kNameWidth), Shortened(CameraModelName(lens.model), kModelWidth),
                 std::to_string(lens.width) + "x" + std::to_string(lens.height),
                 Degrees(HorizontalFieldOfView(lens)), Degrees(right), Degrees(up), Degrees(roll),
                 Metres(camera.s.x()), Metres(camera.s.y()), Metres(camera.s.z())});
}

// ", 0.110 right" if there is something to say.
std::string Part(double metres, const char* positive, const char* negative) {
  const std::string text = Metres(std::abs(metres));
  return text == Metres(0) ? "" : ", " + text + " " + (metres > 0 ? positive : negative);
}

std::string Baselines(const RigFile& file, const BodyAxes& axes) {
  const std::vector<RigCamera>& cameras = file.rig.cameras;
  if (cameras.size() < 2) return "";
  if (cameras.size() == 2) {
    const Eigen::Vector3d b = cameras[1].s - cameras[0].s;
    return Printable(file.camera_names[1]) + " from " + Printable(file.camera_names[0]) + ": " +
           Metres(b.norm()) + " m" + Part(b.dot(axes.Right()), "right", "left") +
           Part(b.dot(axes.down), "down", "up") + Part(b.dot(axes.forward), "ahead", "behind") +
           "\n";
  }
  double shortest = INFINITY, longest = 0.0;
  for (size_t i = 0; i < cameras.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const double length = (cameras[i].s - cameras[j].s).norm();
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
  }
  return "baselines: " + Metres(shortest) + " to " + Metres(longest) + " m\n";
}

std::string TimeOffsets(const RigFile& file) {
  std::string text;
  for (int k = 0; k < file.rig.size(); ++k) {
    constexpr double kMillisecondsPerSecond = 1e3;
    const double offset = kMillisecondsPerSecond * file.rig.cameras[k].time_offset;
    if (offset == 0) continue;
    text += "time offset of " + Printable(file.camera_names[k]) + ": " + FormatNumber(offset, 3) +
            " ms\n";
  }
  return text;
}

}  // namespace

std::string RigTable(const RigFile& file, const BodyAxes& axes) {
  Table table;
  table.AddHeader({"", "", "pixels", "view", "right", "up", "roll", "x", "y", "z"});
  table.AddHeader({"camera", "model", "", "deg", "deg", "deg", "deg", "m", "m", "m"});
  for (int k = 0; k < file.rig.size(); ++k) {
    AddCamera(file.rig.cameras[k], file.camera_names[k], axes, &table);
  }
  return table.Format() + Baselines(file, axes) + TimeOffsets(file);
}

}  // namespace rigel
