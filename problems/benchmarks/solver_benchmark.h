// Time and reliability of the minimal solvers on random problems of the scene.
#ifndef RIGEL_PROBLEMS_BENCHMARKS_SOLVER_BENCHMARK_H_
#define RIGEL_PROBLEMS_BENCHMARKS_SOLVER_BENCHMARK_H_

#include <cstdint>
#include <string>
#include <vector>

#include "rigel/minimal/catalogue.h"

namespace rigel {

struct SolverBenchmarkOptions {
  int num_cameras = 2;        // of the rig, 1 to 4
  int trials = 10000;         // noise-free random problems; >= 1
  double rotation_deg = 1.0;  // about the prior's direction
  bool random_axis = false;   // a random rotation axis instead of body Y (never for planar motion)
  uint64_t seed = 1;
};

// The truth counts as found if a solution's rotation is nearer than this, radians.
inline constexpr double kFoundRotation = 1e-6;
// Radians. At pure translation every solver finds the rotation: the direction has to be found too.
inline constexpr double kFoundDirection = 1e-4;

struct SolverBenchmarkRow {
  std::string solver;
  std::string matches;           // "intra" or "inter"
  double mean_us = 0.0;          // of one call: prepared matches to the list of (R, t)
  double median_us = 0.0;        // over batches of at least 50 us
  double spread_us = 0.0;        // half the distance of the quartiles
  double solutions = 0.0;        // mean number
  double failures = 0.0;         // share of problems without any solution
  double found_truth = 0.0;      // rotation; at rotation_deg = 0 the direction, too
  double found_direction = 0.0;  // rotation and direction in one solution
  // Medians of the errors of the best solution of a problem, degrees: the bias of a first-order
  // solver.
  double rotation_deg = 0.0;
  double translation_dir_deg = 0.0;
  double prepare_us = 0.0;  // a match
  double ratio = 0.0;       // median_us over the reference kernel's in the same run
};

// One row for intra- and one for inter-camera samples, where the solver takes both.
std::vector<SolverBenchmarkRow> BenchmarkSolver(const SolverInfo& solver,
                                                const SolverBenchmarkOptions& options);

// Median microseconds of a 4x4 LU solve by Eigen with partial pivoting: what ratios refer to.
double ReferenceKernelMicroseconds();

// The paper's Table 1 (mean and median, on its authors' machine) beside the medians of the same
// solvers here, intra-camera samples. Empty if none of them was run.
std::string PaperTable1(const std::vector<SolverBenchmarkRow>& rows);

std::string SolverBenchmarkTable(const std::vector<SolverBenchmarkRow>& rows);
// Format "rigel-benchmark 1": docs/formats.md.
std::string SolverBenchmarkJson(const std::vector<SolverBenchmarkRow>& rows,
                                const SolverBenchmarkOptions& options, double reference_us);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_BENCHMARKS_SOLVER_BENCHMARK_H_
