#include "rigel/problems/rigs/rig_check.h"

#include <algorithm>
#include <cmath>

#include "rigel/core/angles.h"
#include "rigel/core/body_axes.h"
#include "rigel/core/pose.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/rigs/field_of_view.h"

namespace rigel {
namespace {

// Upright cameras of ten real rigs agree to 0.79 to 1; inverted or with the wrong order of their
// quaternions to at most 0.49, but for rigs that look one way.
constexpr double kUpright = 0.75;
constexpr double kMoreUpright = 0.2;  // than the rig as it was read

constexpr double kLongestBaseline = 10.0;  // metres: a vehicle is shorter
constexpr double kNoBaseline = 1e-3;       // metres: calibrations are no better

// The rotation of the quaternion x y z w whose numbers were read as w x y z.
Eigen::Matrix3d ReadAsXyzw(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q = Pose{R, Eigen::Vector3d::Zero()}.Quaternion();
  return Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
}

// The rig of such quaternions, of body_from_camera or of the inverse.
Rig XyzwRig(const Rig& rig, bool inverse) {
  Rig result = rig;
  for (RigCamera& camera : result.cameras) {
    if (inverse) {
      const Pose camera_from_body = Pose{camera.Q, camera.s}.Inverse();
      const Pose pose = Pose{ReadAsXyzw(camera_from_body.R), camera_from_body.t}.Inverse();
      camera.Q = pose.R;
      camera.s = pose.t;
    } else {
      camera.Q = ReadAsXyzw(camera.Q);
    }
  }
  return result;
}

void CheckReading(const Rig& rig, bool has_quaternions, std::vector<std::string>* warnings) {
  const RigLook as_read = LookOf(rig);
  const struct {
    Rig rig;
    const char* what;
    bool possible;
  } others[] = {
      {InvertedRig(rig), "poses look inverted: as the inverse of what the file says", true},
      {XyzwRig(rig, false), "quaternions look like x y z w: in that order", has_quaternions},
      {XyzwRig(rig, true), "quaternions look like x y z w: in that order", has_quaternions}};
  const char* found = nullptr;
  double best = 0.0;
  for (const auto& other : others) {
    const RigLook look = LookOf(other.rig);
    const bool is_better = other.possible && look.upright >= kUpright && look.outward > 0 &&
                           look.upright > as_read.upright + kMoreUpright;
    if (is_better && look.upright + look.outward > best) {
      best = look.upright + look.outward;
      found = other.what;
    }
  }
  if (found != nullptr) {
    warnings->push_back(std::string(found) + " the cameras stand upright and look outwards");
  }
  // A ring cannot look at its own middle; two cameras that look at each other might.
  constexpr double kInward = -0.5;
  if (found == nullptr && rig.size() > 2 && as_read.outward < kInward) {
    warnings->emplace_back("the cameras look at each other: positions look inverted");
  }
}

void CheckDown(const RigFile& file, std::vector<std::string>* warnings) {
  constexpr double kFarOff = 45.0;  // degrees: cameras of cars are tilted by less
  if (file.down) {
    const double off = RadToDeg(CamerasOffDown(file.rig, *file.down));
    if (off > kFarOff) {
      warnings->push_back("down of the cameras is " + FormatNumber(off, 0) +
                          " degrees from the body's down " + DirectionText(*file.down) +
                          ": poses look inverted or of another body frame");
    }
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const RigCamera& camera : file.rig.cameras) mean += camera.Q.col(1) / file.rig.size();
  for (int k = 0; k < file.rig.size(); ++k) {
    // Cosine, and the length below which cameras have no mean: half of them upside down.
    constexpr double kOnItsHead = -0.5, kNoMean = 0.1;
    if (mean.norm() > kNoMean && file.rig.cameras[k].Q.col(1).dot(mean.normalized()) < kOnItsHead) {
      warnings->push_back(Printable(file.camera_names[k]) + " is upside down, the others are not");
    }
  }
}

void CheckIdentity(const RigFile& file, std::vector<std::string>* warnings) {
  // 0 0 0 1 is no turn in the order x y z w, and half a turn in the order w x y z.
  const Eigen::Matrix3d half_turn = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  for (int k = 0; k < file.rig.size(); ++k) {
    if (file.rig.cameras[k].Q.isApprox(half_turn, 1e-12)) {
      warnings->push_back(Printable(file.camera_names[k]) +
                          " has the quaternion 0 0 0 1, which is no turn only as x y z w");
      return;
    }
  }
}

void CheckBaselines(const RigFile& file, std::vector<std::string>* warnings) {
  double longest = 0.0;
  for (const RigCamera& a : file.rig.cameras) {
    for (const RigCamera& b : file.rig.cameras) longest = std::max(longest, (a.s - b.s).norm());
  }
  if (longest > kLongestBaseline) {
    // Centimetres of a rig are wrong too, but shorter than a bus.
    constexpr double kMillimetres = 100.0;
    warnings->push_back("cameras are " + FormatNumber(longest, 1) + " m apart" +
                        (longest >= kMillimetres ? ": positions look like millimetres" : ""));
  }
  if (file.rig.size() > 1 && longest < kNoBaseline) {
    warnings->emplace_back(
        "all cameras are in one place: the length of a motion is not observable");
  }
}

void CheckLenses(const RigFile& file, std::vector<std::string>* warnings) {
  for (int k = 0; k < file.rig.size(); ++k) {
    const Camera& lens = file.rig.cameras[k].intrinsics;
    // Of the image, around its middle. Real principal points are nearer to it.
    constexpr double kMiddle = 0.25;
    const double u = lens.cx() / lens.width - 0.5, v = lens.cy() / lens.height - 0.5;
    if (std::abs(u) > kMiddle || std::abs(v) > kMiddle) {
      warnings->push_back(Printable(file.camera_names[k]) + ": the principal point (" +
                          FormatNumber(lens.cx(), 0) + ", " + FormatNumber(lens.cy(), 0) +
                          ") is far from the middle of the image: of another size?");
    }
    const double view = RadToDeg(HorizontalFieldOfView(lens));
    constexpr double kNarrow = 5.0, kWide = 300.0;  // degrees: no lens of a vehicle is beyond
    if (!(view > kNarrow && view < kWide)) {
      warnings->push_back(Printable(file.camera_names[k]) + ": a field of view of " +
                          FormatNumber(view, 1) + " degrees");
    }
  }
}

}  // namespace

RigLook LookOf(const Rig& rig) {
  if (rig.cameras.empty()) return {};
  Eigen::Vector3d down = Eigen::Vector3d::Zero(), middle = Eigen::Vector3d::Zero();
  for (const RigCamera& camera : rig.cameras) {
    down += camera.Q.col(1) / rig.size();
    middle += camera.s / rig.size();
  }
  double along = 0.0, all = 0.0;
  for (const RigCamera& camera : rig.cameras) {
    along += camera.Q.col(2).dot(camera.s - middle);
    all += (camera.s - middle).norm();
  }
  return {down.norm(), all > 0 ? along / all : 0.0};
}

Rig InvertedRig(const Rig& rig) {
  Rig inverted = rig;
  for (RigCamera& camera : inverted.cameras) {
    const Pose pose = Pose{camera.Q, camera.s}.Inverse();
    camera.Q = pose.R;
    camera.s = pose.t;
  }
  return inverted;
}

std::vector<std::string> RigWarnings(const RigFile& file, bool has_quaternions) {
  std::vector<std::string> warnings;
  CheckReading(file.rig, has_quaternions, &warnings);
  CheckDown(file, &warnings);
  if (has_quaternions) CheckIdentity(file, &warnings);
  CheckBaselines(file, &warnings);
  CheckLenses(file, &warnings);
  return warnings;
}

}  // namespace rigel
