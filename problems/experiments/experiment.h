// The experiments of the paper (Li, Liu, Han, Lv) and a few more on the same scene: what is
// simulated, which solvers are run and how.
//
// An experiment is a list of points: a motion (or, for the motions of real drives, a sequence) and
// a value of the variable. At each point all solvers run on the same frame pairs, in two loops:
//   paper   as the paper describes it: the hypothesis with the most inliers wins, no local
//           optimization; confidence 0.99, at least 100 and at most 1000 iterations
//   rigel   the defaults of EstimateMotion()
// both followed by the refinement. `raw` is the winning minimal hypothesis. Pair number k has the
// same points, noise directions and random signs at all values, so that curves are smooth.
#ifndef RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_H_
#define RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/scenes/driven_motion.h"

namespace rigel {

enum class ExperimentVariable {
  kImageNoise,  // px
  kPitch,       // error of the prior about body X, degrees
  kRoll,        // about body Z
  kVibration,   // 1-sigma of a translation along body Y, percent of |t|
  kRotation,    // degrees
  kOutliers,    // percent of the matches
  kMatchCount,
  kInterShare,  // percent of the matches
  kNone,        // the motions of real drives
};

struct ExperimentSpec {
  const char* name;
  const char* about;  // one line
  ExperimentVariable variable;
  const char* x_name;   // with its unit, as in reports; empty for kNone
  const char* x_label;  // of figures
  bool planar;          // planar motion: turns about body Y, no vertical translation
  std::vector<std::string> motions;
  std::vector<double> quick_values, values;  // of the variable; none for kNone
  std::vector<std::string> solvers;
};

// In the order of the paper, then Rigel's own.
const std::vector<ExperimentSpec>& ExperimentCatalogue();

// Null if there is none of that name.
const ExperimentSpec* FindExperiment(std::string_view name);

// "image-noise, pitch-noise, ...", for messages.
std::string ExperimentNames();

struct ExperimentOptions {
  bool quick = false;
  int pairs = 0;  // a point; 0: kQuickPairs or kFullPairs
  uint64_t seed = 1;
  int num_threads = 1;
  std::string poses;  // directory of KITTI poses, for kNone
  int every = 0;      // of the motions of a drive take each n-th; 0: kQuickEvery or kEvery
};

// Pairs of a point and, of a drive, each n-th motion: more take time and scatter less.
// docs/experiments.md has the times of both sets.
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

// What an experiment with its options comes to.
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

inline constexpr const char* kPaperLoop = "paper";
inline constexpr const char* kRigelLoop = "rigel";

// The threshold is three sigma of the image noise, at least 0.5 px: where it is far above the
// noise, many hypotheses have all matches as inliers and their count says little.
EstimateOptions ExperimentEstimate(const std::string& solver, const std::string& loop,
                                   double noise_px);

// What is said of one solver in one loop at one point.
struct ExperimentRow {
  ExperimentPoint point;
  std::string loop;
  SolverSummary summary;
};

// All solvers in both loops at a point; the same for any number of threads, but for the times.
// A solver without a prior does not see the error of one: where `earlier` (may be empty) has its
// rows of the same motion at another value of kPitch or kRoll, they are taken over. False with a
// message if a pair cannot be made. `progress` (may be empty) is called after each pair, from any
// thread.
bool RunExperimentPoint(const ExperimentPlan& plan, const ExperimentPoint& point,
                        const std::vector<ExperimentRow>& earlier,
                        const std::function<void()>& progress, std::vector<ExperimentRow>* rows,
                        std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_H_
