// What became of a solver, and what speaks against the motion that it led to.
#ifndef RIGEL_REFINE_SEARCH_DOUBT_H_
#define RIGEL_REFINE_SEARCH_DOUBT_H_

#include <cstdint>
#include <string>

namespace rigel {

class GroupedMatches;
struct MotionPrior;
struct Pose;
struct SolverInfo;

// What speaks against a motion that a solver led to.
inline constexpr double kDoubtfulInlierRatio = 0.5;
inline constexpr double kDoubtfulPriorDeg = 2.0;
inline constexpr double kDoubtfulGrowth = 1.1;
struct Doubt {
  // Less than kDoubtfulInlierRatio of the matches agree.
  bool few_inliers = false;
  // The threshold cuts through the residuals: at twice the threshold there are kDoubtfulGrowth
  // times as many inliers. Those of the right motion are nearly all below it, and outliers lie far
  // and wide.
  bool loose_residuals = false;
  // The motion turned away from the solver's prior by more than kDoubtfulPriorDeg.
  bool leaves_prior = false;

  int num_matches = 0;
  int num_inliers = 0;
  int num_loose_inliers = 0;
  double from_prior = 0.0;  // radians

  bool Any() const { return few_inliers || SaysWrong(); }
  // Few inliers alone may just be many outliers.
  bool SaysWrong() const { return loose_residuals || leaves_prior; }
  // One clause for each; empty if there is none.
  std::string Reason() const;
};

Doubt FindDoubt(const MotionPrior& prior, const SolverInfo& solver, const Pose& pose,
                const GroupedMatches& matches, double threshold_px);

// What became of one of the solvers.
inline constexpr char kNotNeeded[] = "not needed";  // the note where those before were enough
struct SolverTrial {
  std::string solver;
  int iterations = 0;
  int64_t hypotheses = 0;
  int num_inliers = 0;  // of the best motion that it led to
  std::string note;     // why it was chosen, doubted or not tried
};

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_DOUBT_H_
