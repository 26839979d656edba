// Time, accuracy and success of the whole estimate, RANSAC and refinement, in scenes with outliers.
#ifndef RIGEL_PROBLEMS_BENCHMARKS_RANSAC_BENCHMARK_H_
#define RIGEL_PROBLEMS_BENCHMARKS_RANSAC_BENCHMARK_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/statistics.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

// The scenes have random motion (planar for planar solvers), 1 degree, 0.5 px, no match between
// cameras and an exact prior.
enum class RansacExperiment {
  kSpeed,     // 626 matches, 30 percent outliers; the forms full and prior
  kOutliers,  // 300 inliers and 10 to 80 percent outliers
  kAblation,  // parts of the estimator removed or added, at 30 and 70 percent outliers
  kMoving,    // 626 matches, some of them on a car that moves by itself
  kFiles,     // given frame pairs
};

// "speed", "outliers", "ablation", "moving"; kFiles is not an experiment of its own to a user.
bool ParseRansacExperiment(std::string_view name, RansacExperiment* experiment);
const char* RansacExperimentName(RansacExperiment experiment);

struct RansacBenchmarkOptions {
  RansacExperiment experiment = RansacExperiment::kSpeed;
  std::vector<std::string> solvers;  // of the catalogue; empty: those that suit the experiment
  int pairs = 200;                   // random pairs of each scene (OpenGV: of them at most 5)
  uint64_t seed = 1;                 // of the scenes and of RANSAC
};

// Results of one estimator on one set of pairs. Errors are in degrees, over the pairs with an
// estimate. Values that do not exist are left out.
struct RansacBenchmarkRow {
  std::string solver;
  std::string form;     // of the refinement
  std::string variant;  // of an ablation
  double outlier_share = 0.0;
  double moving_share = 0.0;
  int num_matches = 0;  // rounded mean
  int pairs = 0;
  int failures = 0;  // pairs without an estimate

  // RANSAC and refinement together, the fastest of three runs of each pair (OpenGV: one run).
  std::optional<Statistics> time_ms;
  double time_spread_ms = 0.0;  // half the distance of the quartiles
  double ransac_ms = 0.0;       // medians
  double refine_ms = 0.0;
  double iterations = 0.0;
  double inlier_ratio = 0.0;

  std::optional<double> rotation_deg, direction_deg;                // medians
  std::optional<double> clean_rotation_deg, clean_direction_deg;    // of the same pairs' inliers
  std::optional<double> efficiency_rotation, efficiency_direction;  // of the pairs that succeed
  std::optional<double> success;      // share with a rotation within three bounds of the truth
  std::optional<double> static_wins;  // share with the motion of the static scene, not of the car
  std::optional<int> missed;          // failed pairs that succeed if refined from the truth
};

// Calls `progress` (may be empty) after each row.
std::vector<RansacBenchmarkRow> BenchmarkRansac(const RansacBenchmarkOptions& options,
                                                const std::function<void()>& progress);

// The number of rows that it makes.
int CountRansacRows(const RansacBenchmarkOptions& options);

// The same on given pairs, with each of `options.solvers`; if empty, with the solvers of the speed
// experiment whose prior all pairs have. Errors need the truth of the pairs, success their noise.
std::vector<RansacBenchmarkRow> BenchmarkRansacOnFiles(const RansacBenchmarkOptions& options,
                                                       const std::vector<FramePair>& pairs);

// 100 columns at most.
std::string RansacBenchmarkTable(const std::vector<RansacBenchmarkRow>& rows,
                                 RansacExperiment experiment);
// Format "rigel-ransac-benchmark 1": docs/formats.md.
std::string RansacBenchmarkJson(const std::vector<RansacBenchmarkRow>& rows,
                                const RansacBenchmarkOptions& options);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_BENCHMARKS_RANSAC_BENCHMARK_H_
