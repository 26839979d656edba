#include "rigel/problems/scenes/scene_rig.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "rigel/core/angles.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

// Streams 2 k and 2 k + 1 are of pair k, and no pair has this one.
constexpr uint64_t kCalibrationStream = std::numeric_limits<uint64_t>::max();

// The error of the calibration. The draws of a camera do not depend on the sizes of the errors.
void Misplace(const SceneMatchOptions& options, Rig* rig) {
  if (options.calibration_sigma_deg == 0 && options.calibration_sigma_m == 0) return;
  Random random = Random::Stream(options.seed, kCalibrationStream);
  for (RigCamera& camera : rig->cameras) {
    const Eigen::Vector3d turn = random.NormalVector3();
    const Eigen::Vector3d shift = random.NormalVector3();
    camera.Q = ExpSO3(DegToRad(options.calibration_sigma_deg) * turn) * camera.Q;
    camera.s += options.calibration_sigma_m * shift;
  }
}

}  // namespace

double ShareOfTime(const SceneMatchOptions& options, const RigCamera& camera) {
  return camera.time_offset / options.interval_s;
}

Rig RigOfScene(const SceneMatchOptions& options, int index, FramePair* pair) {
  Rig& stated = pair->rig;
  for (size_t k = 0; k < options.camera_times.size(); ++k) {
    stated.cameras[k].time_offset = options.camera_times[k];
  }
  Rig rig = stated;
  Misplace(options, &rig);
  for (RigCamera& camera : stated.cameras) {
    if (!options.state_calibration_sigma) break;
    camera.rotation_sigma = DegToRad(options.calibration_sigma_deg);
    camera.position_sigma = options.calibration_sigma_m;
  }
  for (RigCamera& camera : rig.cameras) {
    if (camera.time_offset == 0) continue;
    const Pose later = PartOfMotion(*pair->truth, -ShareOfTime(options, camera));
    camera.Q = later.R * camera.Q;
    camera.s = later * camera.s;
    pair->time1 = index * options.interval_s;
    pair->time2 = (index + 1) * options.interval_s;
  }
  return rig;
}

}  // namespace rigel
