// Where the motion prior of a frame pair comes from, and the errors added to it in experiments.
#ifndef RIGEL_PROBLEMS_PRIOR_SOURCE_H_
#define RIGEL_PROBLEMS_PRIOR_SOURCE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rigel/core/frame_pair.h"

namespace rigel {

enum class PriorSource {
  kFile,   // the pair's own
  kBody,   // gravity1 = gravity2 = axis = normal = body Y: no sensor at all
  kTruth,  // g1 from the pair or body Y, g2 = R g1; axis of R (body Y below 1e-6 rad); normal: the
           // unit vector perpendicular to t nearest to the axis
};

enum class PriorNoiseAxis { kPitch, kRoll, kRandom };  // about body X, body Z, a random axis

struct PriorSourceOptions {
  PriorSource source = PriorSource::kFile;
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

// Replaces and disturbs pair->prior; `index` is the pair's number, which fixes its random sign.
// False with a message if the source is the truth and the pair has none.
bool ApplyPriorSource(const PriorSourceOptions& options, int index, FramePair* pair,
                      std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_PRIOR_SOURCE_H_
