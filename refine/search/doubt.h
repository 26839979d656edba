// The result of a solver in a search, and the signs that its motion is wrong.
#ifndef RIGEL_REFINE_SEARCH_DOUBT_H_
#define RIGEL_REFINE_SEARCH_DOUBT_H_

#include <cstdint>
#include <string>

namespace rigel {

class GroupedMatches;
struct MotionPrior;
struct Pose;
struct SolverInfo;

// Signs that the motion of a solver is wrong.
inline constexpr double kDoubtfulInlierRatio = 0.5;
inline constexpr double kDoubtfulPriorDeg = 2.0;
inline constexpr double kDoubtfulGrowth = 1.1;
// Times PixelUnit(). The gate allows 3.
inline constexpr double kDoubtfulNoisePx = 2.9;
struct Doubt {
  // Less than kDoubtfulInlierRatio of the matches agree.
  bool few_inliers = false;
  // At twice the threshold there are more than kDoubtfulGrowth times as many inliers. With the
  // right motion nearly all inliers are below the threshold, and outliers are spread over the
  // image.
  bool loose_residuals = false;
  // The motion deviates from the solver's prior by more than kDoubtfulPriorDeg.
  bool leaves_prior = false;
  // The inliers are noisier than the matches of any matcher: kDoubtfulNoisePx.
  bool large_noise = false;

  int num_matches = 0;
  int num_inliers = 0;
  int num_loose_inliers = 0;
  double from_prior = 0.0;  // radians
  double noise_px = 0.0;    // of the inliers; 0: not known

  bool Any() const { return few_inliers || SaysWrong(); }
  // Few inliers alone do not count: the data may have many outliers.
  bool SaysWrong() const { return loose_residuals || leaves_prior || large_noise; }
  // One clause for each sign; empty if there is none.
  std::string Reason() const;
};

// `threshold_px` is meant to be three times the noise. A `noise_px` of 0 is not known.
Doubt FindDoubt(const MotionPrior& prior, const SolverInfo& solver, const Pose& pose,
                const GroupedMatches& matches, double threshold_px, double noise_px = 0.0);

// The result of one solver.
inline constexpr char kNotNeeded[] = "not needed";  // note of a solver that was not tried
struct SolverTrial {
  std::string solver;
  int iterations = 0;
  int64_t hypotheses = 0;
  int num_inliers = 0;  // of its best motion
  std::string note;     // why it was chosen, doubted or not tried
};

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_DOUBT_H_
