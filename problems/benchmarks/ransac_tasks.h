// What the RANSAC benchmark measures: one task for each row of its tables.
#ifndef RIGEL_PROBLEMS_BENCHMARKS_RANSAC_TASKS_H_
#define RIGEL_PROBLEMS_BENCHMARKS_RANSAC_TASKS_H_

#include <string>
#include <vector>

#include "rigel/problems/benchmarks/ransac_benchmark.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

struct RansacTask {
  SceneOptions scene;
  EstimateOptions estimate;
  std::string variant;  // of an ablation
  std::string opengv;   // the peer that estimates in place of Rigel; empty: Rigel
};

// The tasks of an experiment, in the order of its rows. options.solvers are of the catalogue.
std::vector<RansacTask> MakeRansacTasks(const RansacBenchmarkOptions& options);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_BENCHMARKS_RANSAC_TASKS_H_
