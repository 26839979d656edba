// Time and accuracy of the refinement alone: from a hypothesis near the motion to the minimum.
#ifndef RIGEL_PROBLEMS_BENCHMARKS_REFINE_BENCHMARK_H_
#define RIGEL_PROBLEMS_BENCHMARKS_REFINE_BENCHMARK_H_

#include <cstdint>
#include <string>
#include <vector>

namespace rigel {

struct RefineBenchmarkOptions {
  int problems = 200;         // random pairs of the scene: half of the matches inter-camera, 0.5 px
  int num_matches = 600;      // all inliers
  double rotation_deg = 1.0;  // of the motion
  double start_deg = 1.0;     // the hypothesis is off by this in rotation and in direction
  uint64_t seed = 1;
};

struct RefineBenchmarkRow {
  std::string engine;  // "small engine", "Refine() full", ...
  std::string loss;
  double median_us = 0.0;
  double spread_us = 0.0;            // half the distance of the quartiles
  double iterations = 0.0;           // mean; -1 where the engine does not say
  double rotation_deg = 0.0;         // RMS error
  double translation_dir_deg = 0.0;  // RMS error
  double failures = 0.0;             // share
};

// The small engine and Refine() with each form that needs no prior, squared and Cauchy loss.
std::vector<RefineBenchmarkRow> BenchmarkRefinement(const RefineBenchmarkOptions& options);

std::string RefineBenchmarkTable(const std::vector<RefineBenchmarkRow>& rows);
// Format "rigel-refine-benchmark 1": docs/formats.md.
std::string RefineBenchmarkJson(const std::vector<RefineBenchmarkRow>& rows,
                                const RefineBenchmarkOptions& options);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_BENCHMARKS_REFINE_BENCHMARK_H_
