// Everything known about one pair of frames: the unit that is read, estimated and reported.
#ifndef RIGEL_CORE_FRAME_PAIR_H_
#define RIGEL_CORE_FRAME_PAIR_H_

#include <optional>
#include <string>
#include <vector>

#include "rigel/core/match.h"
#include "rigel/core/match_columns.h"
#include "rigel/core/pose.h"
#include "rigel/core/prior.h"
#include "rigel/core/rig.h"

namespace rigel {

struct FramePair {
  std::string name;      // for messages and reports; a match file's path
  std::string sequence;  // groups pairs in reports; may be empty
  Rig rig;
  std::vector<Match> matches;
  MatchColumns columns;  // more about the matches
  MotionPrior prior;
  std::optional<double> time1, time2;  // seconds
  std::optional<Pose> truth;           // f2_from_f1
  // 1-sigma image noise if it is known. EstimateMotion() does not read it: bounds on its
  // errors do.
  std::optional<double> noise_px;

  // Seconds between the times; 0 if they are not known.
  double Interval() const { return time1 && time2 ? *time2 - *time1 : 0.0; }

  // False with a message if the rig, the prior or a column is invalid or a match names a camera
  // that is not there. Cameras that fire at other times need a time2 that is after time1. Pixels,
  // times, truth and noise_px must be finite, noise_px also positive. The score of a match may be
  // NaN: it is then the worst.
  bool IsValid(std::string* error) const;
};

}  // namespace rigel

#endif  // RIGEL_CORE_FRAME_PAIR_H_
