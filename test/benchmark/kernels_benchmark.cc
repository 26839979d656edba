// Google Benchmark of the hot kernels: each minimal solver, small linear systems, scoring,
// residuals, local optimization; and of the reader of match files.
//
//   build/release/bin/kernels_benchmark --benchmark_repetitions=9
//   --benchmark_report_aggregates_only
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <Eigen/LU>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/random.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/numerics/elimination.h"
#include "rigel/minimal/ransac/sampler.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/refine/least_squares/epipolar_residuals.h"
#include "rigel/refine/least_squares/small_engine.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/refine.h"

namespace rigel {
namespace {

FramePair ScenePair(int num_matches, double inter_share, double noise_px, MotionPattern motion,
                    int index = 0) {
  SceneOptions options;
  options.num_matches = num_matches;
  options.inter_share = inter_share;
  options.noise_px = noise_px;
  options.motion = motion;
  FramePair pair;
  std::string error;
  if (!MakeScenePair(options, index, &pair, &error)) std::abort();
  return pair;
}

// items_per_second: the clock that floors are counted in, by a chain of shifts and exclusive ors,
// two cycles a step.
void BM_Clock(benchmark::State& state) {
  constexpr int kSteps = 1000;
  uint64_t x = 0x9e3779b97f4a7c15;
  for (auto _ : state) {
    for (int k = 0; k < kSteps; ++k) x ^= x >> 7;
    benchmark::DoNotOptimize(x);
  }
  state.SetItemsProcessed(state.iterations() * 2 * kSteps);
}
BENCHMARK(BM_Clock);

void BM_Solver(benchmark::State& state, const SolverInfo* solver, double inter_share) {
  // Enough samples that the branch predictor cannot learn them.
  constexpr int kSamples = 256;
  const MotionPattern motion =
      solver->prior == PriorKind::kPlanar ? MotionPattern::kPlanar : MotionPattern::kRandom;
  std::vector<PreparedMatches> matches;
  std::vector<std::vector<int>> samples;
  for (int k = 0; k < kSamples; ++k) {
    const FramePair pair = ScenePair(4 * solver->sample_size, inter_share, 0.0, motion, k);
    Alignment alignment;
    std::string error;
    if (!MakeAlignment(pair.prior, solver->prior, &alignment, &error)) std::abort();
    const GroupedMatches grouped(pair.rig, pair.matches);
    const Sampler sampler(grouped.groups(), solver->sampling, solver->sample_size);
    std::vector<int> sample(solver->sample_size);
    Random random(k);
    if (!sampler.Draw(&random, sample.data())) continue;
    matches.emplace_back(pair.rig, grouped.matches(), alignment);
    samples.push_back(sample);
  }
  if (matches.empty()) {
    state.SkipWithError("takes no such samples");
    return;
  }
  Solutions solutions;
  size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(solver->solve(matches[k], samples[k].data(), &solutions));
    if (++k == matches.size()) k = 0;
  }
}

void BM_Score(benchmark::State& state) {
  const FramePair pair =
      ScenePair(static_cast<int>(state.range(0)), 0.5, 0.5, MotionPattern::kRandom);
  const GroupedMatches matches(pair.rig, pair.matches);
  int inliers = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(matches.Score(*pair.truth, 1.5, 1e300, &inliers));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_Score)->Arg(626)->Arg(2500);

// The rows below are of one group, Arg(0) on the baseline path and Arg(1) on the best.
struct OneGroup {
  explicit OneGroup(const benchmark::State& state)
      : pair(ScenePair(kSize, 0.0, 0.5, MotionPattern::kRandom)),
        path(state.range(0) == 0 ? CpuPath::kBaseline : BestCpuPath()) {
    for (Match& match : pair.matches) match.camera1 = match.camera2 = 0;
    matches = GroupedMatches(pair.rig, pair.matches);
    group = matches.groups()[0];
    F = matches.Fundamental(group, *pair.truth);
    motion = matches.MotionOf(group, *pair.truth, 1.5);
  }

  static constexpr int kSize = 1000;
  FramePair pair;
  CpuPath path;
  GroupedMatches matches;
  MatchGroup group;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F;
  GroupMotion motion;
};

void BM_TruncatedSum(benchmark::State& state) {
  const OneGroup g(state);
  int inliers = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(TruncatedSampsonSum(g.matches.Rows(g.group), g.F.data(), 2.25, 1e300,
                                                 0.0, &inliers, g.path));
  }
  state.SetItemsProcessed(state.iterations() * OneGroup::kSize);
}
BENCHMARK(BM_TruncatedSum)->Arg(0)->Arg(1);

void BM_TruncatedSumInFront(benchmark::State& state) {
  const OneGroup g(state);
  int inliers = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        TruncatedSampsonSumInFront(g.matches.Rows(g.group), g.matches.Directions(g.group),
                                   g.F.data(), g.motion, 2.25, 1e300, 0.0, &inliers, g.path));
  }
  state.SetItemsProcessed(state.iterations() * OneGroup::kSize);
}
BENCHMARK(BM_TruncatedSumInFront)->Arg(0)->Arg(1);

void BM_SquaredErrors(benchmark::State& state) {
  const OneGroup g(state);
  std::vector<double> errors(OneGroup::kSize);
  for (auto _ : state) {
    SquaredSampsonErrors(g.matches.Rows(g.group), g.F.data(), errors.data(), g.path);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * OneGroup::kSize);
}
BENCHMARK(BM_SquaredErrors)->Arg(0)->Arg(1);

void BM_SelectInFront(benchmark::State& state) {
  const OneGroup g(state);
  std::vector<double> errors(OneGroup::kSize);
  std::vector<char> inliers(OneGroup::kSize);
  for (auto _ : state) {
    benchmark::DoNotOptimize(SelectInFront(g.matches.Rows(g.group), g.matches.Directions(g.group),
                                           g.F.data(), g.motion, 2.25, errors.data(),
                                           inliers.data(), g.path));
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * OneGroup::kSize);
}
BENCHMARK(BM_SelectInFront)->Arg(0)->Arg(1);

void BM_ScoreInFront(benchmark::State& state) {
  const FramePair pair =
      ScenePair(static_cast<int>(state.range(0)), 0.5, 0.5, MotionPattern::kRandom);
  const GroupedMatches matches(pair.rig, pair.matches);
  int inliers = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(matches.ScoreInFront(*pair.truth, 1.5, 1e300, &inliers));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_ScoreInFront)->Arg(626)->Arg(2500);

void BM_SelectInliers(benchmark::State& state) {
  const FramePair pair =
      ScenePair(static_cast<int>(state.range(0)), 0.5, 0.5, MotionPattern::kRandom);
  const GroupedMatches matches(pair.rig, pair.matches);
  std::vector<double> errors;
  std::vector<char> inliers;
  for (auto _ : state) {
    benchmark::DoNotOptimize(matches.SelectInliers(*pair.truth, 1.5, &errors, &inliers));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_SelectInliers)->Arg(626)->Arg(2500);

void BM_GroupMatches(benchmark::State& state) {
  const FramePair pair =
      ScenePair(static_cast<int>(state.range(0)), 0.5, 0.5, MotionPattern::kRandom);
  for (auto _ : state) {
    benchmark::DoNotOptimize(GroupedMatches(pair.rig, pair.matches).size());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_GroupMatches)->Arg(626)->Arg(2500);

// Of each hypothesis, whatever the number of matches.
void BM_Fundamental(benchmark::State& state) {
  const FramePair pair = ScenePair(100, 0.5, 0.5, MotionPattern::kRandom);
  const GroupedMatches matches(pair.rig, pair.matches);
  for (auto _ : state) {
    for (const MatchGroup& group : matches.groups()) {
      benchmark::DoNotOptimize(matches.Fundamental(group, *pair.truth));
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(matches.groups().size()));
}
BENCHMARK(BM_Fundamental);

void BM_SampsonJacobian(benchmark::State& state) {
  const FramePair pair = ScenePair(600, 0.5, 0.5, MotionPattern::kRandom);
  const GroupedMatches matches(pair.rig, pair.matches);
  const EpipolarResiduals residuals(matches, ResidualKind::kSampson);
  const MotionBasis basis = FullBasis(*pair.truth, true);
  std::vector<GroupLinearization> groups;
  double row[6];
  for (auto _ : state) {
    residuals.Linearize(*pair.truth, &basis, &groups);
    for (int k = 0; k < residuals.size(); ++k) {
      benchmark::DoNotOptimize(residuals.Evaluate(groups, k, 6, row));
    }
  }
  state.SetItemsProcessed(state.iterations() * 600);
}
BENCHMARK(BM_SampsonJacobian);

// What elimination.h is for, and the same by Eigen. Many systems, so that the branch predictor
// cannot learn their pivots.
constexpr int kSystems = 256;

std::vector<Eigen::Matrix<double, 6, 8>> RandomSystems() {
  std::vector<Eigen::Matrix<double, 6, 8>> systems(kSystems);
  Random random(1);
  for (auto& system : systems) {
    for (double& value : system.reshaped()) value = random.Normal();
  }
  return systems;
}

void BM_SixEquations(benchmark::State& state) {
  const auto systems = RandomSystems();
  size_t k = 0;
  for (auto _ : state) {
    Eigen::Matrix<double, 6, 8, Eigen::RowMajor> rows = systems[k];
    double x[6];
    SolveSixBySix(reinterpret_cast<double(*)[8]>(rows.data()), x);
    benchmark::DoNotOptimize(x);
    k = (k + 1) % kSystems;
  }
}
BENCHMARK(BM_SixEquations);

void BM_SixEquationsByEigen(benchmark::State& state) {
  const auto systems = RandomSystems();
  size_t k = 0;
  for (auto _ : state) {
    Eigen::Matrix<double, 6, 1> x =
        systems[k].leftCols<6>().partialPivLu().solve(systems[k].col(6));
    benchmark::DoNotOptimize(x);
    k = (k + 1) % kSystems;
  }
}
BENCHMARK(BM_SixEquationsByEigen);

void BM_SmallEngine(benchmark::State& state) {
  const FramePair pair = ScenePair(600, 0.5, 0.5, MotionPattern::kRandom);
  const GroupedMatches matches(pair.rig, pair.matches);
  const std::vector<char> mask(600, 1);
  SmallEngine engine(matches);
  for (auto _ : state) {
    Pose pose = *pair.truth;
    pose.R = ExpSO3({0.01, -0.01, 0.01}) * pose.R;
    LeastSquaresOptions options;
    options.loss = LossKind::kCauchy;
    benchmark::DoNotOptimize(engine.Minimize(options, mask, PriorResiduals(), 1.0, &pose));
  }
}
BENCHMARK(BM_SmallEngine)->Unit(benchmark::kMicrosecond);

void BM_Refine(benchmark::State& state) {
  const FramePair pair = ScenePair(600, 0.5, 0.5, MotionPattern::kRandom);
  const GroupedMatches matches(pair.rig, pair.matches);
  for (auto _ : state) {
    Pose pose = *pair.truth;
    pose.R = ExpSO3({0.001, -0.001, 0.001}) * pose.R;
    benchmark::DoNotOptimize(Refine(RefineOptions(), matches, pair.prior, &pose).num_inliers);
  }
}
BENCHMARK(BM_Refine)->Unit(benchmark::kMicrosecond);

// items_per_second: matches.
void BM_ParseMatches(benchmark::State& state) {
  const FramePair pair =
      ScenePair(static_cast<int>(state.range(0)), 0.5, 0.5, MotionPattern::kRandom);
  const std::string text = FormatMatches(pair);
  FramePair read;
  std::string error;
  for (auto _ : state) {
    if (!ParseMatches(text, "text", &read, &error)) std::abort();
    benchmark::DoNotOptimize(read.matches.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(text.size()));
}
BENCHMARK(BM_ParseMatches)->Arg(300)->Arg(2500)->Unit(benchmark::kMicrosecond);

// The same with the file, which is in the page cache.
void BM_ReadMatchFile(benchmark::State& state) {
  const FramePair pair =
      ScenePair(static_cast<int>(state.range(0)), 0.5, 0.5, MotionPattern::kRandom);
  const std::string path =
      (std::filesystem::temp_directory_path() / "rigel_kernels_benchmark.matches").string();
  FramePair read;
  std::string error;
  if (!WriteMatchFile(path, pair, &error)) {
    state.SkipWithError(error.c_str());
    return;
  }
  for (auto _ : state) {
    if (!ReadMatchFile(path, &read, &error)) std::abort();
    benchmark::DoNotOptimize(read.matches.data());
  }
  std::filesystem::remove(path);
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_ReadMatchFile)->Arg(300)->Arg(2500)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  for (const rigel::SolverInfo& solver : rigel::SolverCatalogue()) {
    const std::string name = std::string("BM_Solver/") + solver.name;
    benchmark::RegisterBenchmark((name + "/intra").c_str(), rigel::BM_Solver, &solver, 0.0);
    if (solver.sampling != rigel::SampleKind::kOneCamera) {
      benchmark::RegisterBenchmark((name + "/inter").c_str(), rigel::BM_Solver, &solver, 1.0);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
