// The points of an experiment and their frame pairs.
//
// A point is a motion (or, for the motions of real drives, a sequence) and a value of the variable.
// Pair number k has the same points, noise directions and random signs at all values, so that
// curves are smooth.
#ifndef RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_PLAN_H_
#define RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_PLAN_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/experiments/experiment_catalogue.h"
#include "rigel/problems/scenes/driven_motion.h"

namespace rigel {

struct ExperimentOptions {
  bool quick = false;
  int pairs = 0;  // a point; 0: kQuickPairs or kFullPairs
  uint64_t seed = 1;
  int num_threads = 1;
  std::string poses;  // directory of KITTI poses, for kNone
  int every = 0;      // of the motions of a drive take each n-th; 0: kQuickEvery or kEvery
};

// Pairs of a point, and every n-th motion of a drive: more pairs take longer and scatter less.
// docs/experiments.md has the times of these two sets.
inline constexpr int kQuickPairs = 30;
inline constexpr int kFullPairs = 500;
inline constexpr int kQuickEvery = 100;
inline constexpr int kEvery = 20;

// The options with their defaults filled in.
ExperimentOptions WithDefaults(ExperimentOptions options);

struct ExperimentPoint {
  std::string motion;       // "forward", "random", "sideways"; "driven" for kNone
  std::string sequence;     // of kNone, else empty
  std::optional<double> x;  // none for kNone

  bool operator==(const ExperimentPoint& other) const {
    return motion == other.motion && sequence == other.sequence && x == other.x;
  }
};

// An experiment with its options: what has to be run.
struct ExperimentPlan {
  const ExperimentSpec* spec = nullptr;
  ExperimentOptions options;  // with defaults
  std::vector<ExperimentPoint> points;
  std::vector<DrivenMotion> driven;  // of kNone: all motions, thinned or not
};

// False with a message if the poses of kNone cannot be read.
bool PlanExperiment(const ExperimentSpec& spec, const ExperimentOptions& options,
                    ExperimentPlan* plan, std::string* error);

// Pairs of a point.
int CountPairs(const ExperimentPlan& plan, const ExperimentPoint& point);

// Pair number `index` of a point with its disturbed prior. False with a message if the motion
// leaves hardly any point in view.
bool MakeExperimentPair(const ExperimentPlan& plan, const ExperimentPoint& point, int index,
                        FramePair* pair, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_PLAN_H_
