// The longest time of an estimate: pairs whose matches follow no motion.
#ifndef RIGEL_PROBLEMS_BENCHMARKS_HOSTILE_BENCHMARK_H_
#define RIGEL_PROBLEMS_BENCHMARKS_HOSTILE_BENCHMARK_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"

namespace rigel {

struct HostileBenchmarkOptions {
  std::vector<std::string> solvers;  // of the catalogue, or auto; empty: all
  int pairs = 200;                   // of 200 and of 2000 matches; of 200,000 one
  uint64_t seed = 1;
};

// One solver at default options on pairs of one size. Times are CPU times of the thread, on which
// other processes have little effect.
struct HostileBenchmarkRow {
  std::string solver;
  int num_matches = 0;
  int pairs = 0;
  int motions = 0;  // pairs with an estimated motion
  double median_ms = 0.0;
  double largest_ms = 0.0;
};

// Two cameras of the scene's kind; both points of a match anywhere in the image of a random camera.
FramePair MakeHostilePair(int num_matches, uint64_t seed);

// Calls `progress` (may be empty) after each row.
std::vector<HostileBenchmarkRow> BenchmarkHostile(const HostileBenchmarkOptions& options,
                                                  const std::function<void()>& progress);
int CountHostileRows(const HostileBenchmarkOptions& options);

std::string HostileBenchmarkTable(const std::vector<HostileBenchmarkRow>& rows);
// Format "rigel-ransac-benchmark 1", experiment "hostile": docs/formats.md.
std::string HostileBenchmarkJson(const std::vector<HostileBenchmarkRow>& rows,
                                 const HostileBenchmarkOptions& options);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_BENCHMARKS_HOSTILE_BENCHMARK_H_
