// One row of the RANSAC benchmark: a task measured on frame pairs.
#ifndef RIGEL_PROBLEMS_BENCHMARKS_RANSAC_MEASUREMENT_H_
#define RIGEL_PROBLEMS_BENCHMARKS_RANSAC_MEASUREMENT_H_

#include <optional>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/benchmarks/ransac_benchmark.h"
#include "rigel/problems/benchmarks/ransac_tasks.h"

namespace rigel {

// A pair to estimate and, if it is of a scene, the pair with only the matches of the static scene.
struct RansacProblem {
  FramePair pair;
  std::optional<FramePair> clean;
};

// The first `pairs` pairs of a scene, without those that cannot be made.
std::vector<RansacProblem> MakeRansacProblems(const SceneOptions& scene, int pairs);

RansacBenchmarkRow MeasureRansac(const RansacTask& task,
                                 const std::vector<RansacProblem>& problems);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_BENCHMARKS_RANSAC_MEASUREMENT_H_
