#include "rigel/problems/trajectories/drift.h"

#include "rigel/core/metrics.h"

namespace rigel {
namespace {

// KITTI's metric: segments of 1 to 8 units of 100 m, from every 10th frame.
constexpr int kLengths = 8;
constexpr double kKittiUnit = 100.0;  // metres, the unit of a path that is long enough for it
constexpr int kKittiStartStep = 10;   // frames between the starts of two segments

// Distance along the path up to each pose.
std::vector<double> PathLengths(const std::vector<Pose>& poses) {
  std::vector<double> lengths = {0.0};
  for (size_t k = 1; k < poses.size(); ++k) {
    lengths.push_back(lengths.back() + (poses[k].t - poses[k - 1].t).norm());
  }
  return lengths;
}

// Of the motion from frame a to frame b.
Pose MotionError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate, size_t a,
                 size_t b) {
  const Pose true_motion = truth[a].Inverse() * truth[b];
  const Pose motion = estimate[a].Inverse() * estimate[b];
  return true_motion.Inverse() * motion;
}

double Angle(const Pose& pose) { return RotationError(Eigen::Matrix3d::Identity(), pose.R); }

}  // namespace

Drift ComputeDrift(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  Drift drift;
  const std::vector<double> path = PathLengths(truth);
  drift.path_length = path.back();
  double unit = kKittiUnit;
  while (unit > 1.0 && !(drift.path_length > unit)) unit /= 10.0;
  drift.start_step = unit < kKittiUnit ? 1 : kKittiStartStep;
  for (int n = 1; n <= kLengths; ++n) {
    SegmentDrift segments;
    segments.length = n * unit;
    for (size_t first = 0; first < path.size(); first += drift.start_step) {
      size_t last = first;
      while (last < path.size() && !(path[last] > path[first] + segments.length)) ++last;
      if (last == path.size()) break;  // the rest of the path is shorter for all later starts
      const Pose error = MotionError(truth, estimate, first, last);
      segments.translation += error.t.norm() / segments.length;
      segments.rotation += Angle(error) / segments.length;
      ++segments.segments;
    }
    if (segments.segments == 0) break;
    drift.all.segments += segments.segments;
    drift.all.translation += segments.translation;
    drift.all.rotation += segments.rotation;
    segments.translation /= segments.segments;
    segments.rotation /= segments.segments;
    drift.by_length.push_back(segments);
  }
  if (drift.all.segments > 0) {
    drift.all.translation /= drift.all.segments;
    drift.all.rotation /= drift.all.segments;
  }

  std::vector<double> translations, rotations;
  for (size_t k = 1; k < truth.size(); ++k) {
    const Pose error = MotionError(truth, estimate, k - 1, k);
    translations.push_back(error.t.norm());
    rotations.push_back(Angle(error));
  }
  drift.step_translation = ComputeStatistics(translations);
  drift.step_rotation = ComputeStatistics(rotations);
  drift.end_translation = (estimate.back().t - truth.back().t).norm();
  drift.end_rotation = RotationError(truth.back().R, estimate.back().R);
  drift.start_translation = (estimate.back().Inverse().t - truth.back().Inverse().t).norm();
  return drift;
}

}  // namespace rigel
