// The source of the motion prior of a frame pair, and errors added to it in experiments.
#ifndef RIGEL_PROBLEMS_SCENES_PRIOR_SOURCE_H_
#define RIGEL_PROBLEMS_SCENES_PRIOR_SOURCE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rigel/core/body_axes.h"
#include "rigel/core/frame_pair.h"

namespace rigel {

enum class PriorSource {
  kFile,   // the pair's own
  kBody,   // gravity1 = gravity2 = axis = normal = the body's down: no sensor is needed
  kTruth,  // g1 from the pair or the body's down, g2 = R g1; axis of R (the body's down below
           // 1e-6 rad); normal: the unit vector perpendicular to t nearest to the axis
};

// About the body's right, its forward, a random axis.
enum class PriorNoiseAxis { kPitch, kRoll, kRandom };

struct PriorSourceOptions {
  PriorSource source = PriorSource::kFile;
  // Axes of the body, unit vectors. By default forward is that of the pair; what is still open is
  // chosen by the rig (ResolveBodyAxes()).
  std::optional<Eigen::Vector3d> down, forward;
  // An error of exactly this angle, sign random per pair, on gravity2 and on axis and normal.
  double noise = 0.0;  // radians
  PriorNoiseAxis noise_axis = PriorNoiseAxis::kPitch;
  // Stated 1-sigma of all directions, radians; replaces what the pair says.
  std::optional<double> sigma;
  // With kTruth the true |t|, too, as the distance (without a sigma).
  bool true_distance = false;
  uint64_t seed = 1;
};

bool ParsePriorSource(std::string_view name, PriorSource* source);      // "file", "body", "truth"
bool ParsePriorNoiseAxis(std::string_view name, PriorNoiseAxis* axis);  // "pitch", "roll", "random"

// The axes of the body that a prior was made with.
struct AppliedAxes {
  BodyAxes axes;
  bool down_suggested =
      false;  // the prior uses it, and it is not stated: the rig's cameras chose it
  double cameras_off_down = 0.0;   // radians, CamerasOffDown()
  bool forward_suggested = false;  // it is not stated
};

// Replaces and disturbs pair->prior, and sets its forward direction. `index` is the pair's number,
// which selects its random sign. False with a message if the source is the truth and the pair has
// none, or if down and forward are parallel. `applied` may be null.
bool ApplyPriorSource(const PriorSourceOptions& options, int index, FramePair* pair,
                      std::string* error, AppliedAxes* applied = nullptr);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_PRIOR_SOURCE_H_
