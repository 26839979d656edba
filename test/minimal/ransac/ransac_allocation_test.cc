// The promise of the hot path: solvers, sampling, scoring and the RANSAC loop do not touch the
// heap.
//
// This file replaces the program's allocation functions by counting ones; no other file of the
// program may. operator new sees the standard containers; Eigen's dynamic matrices call malloc,
// which is counted too where it can be replaced (glibc, no sanitizer).
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "rigel/core/grouped_matches.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/ransac/ransac.h"
#include "rigel/minimal/ransac/sampler.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/refine/estimate_motion.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RIGEL_COUNT_MALLOC 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define RIGEL_COUNT_MALLOC 0
#endif
#endif
#if !defined(RIGEL_COUNT_MALLOC) && defined(__GLIBC__)
#define RIGEL_COUNT_MALLOC 1
#endif
#ifndef RIGEL_COUNT_MALLOC
#define RIGEL_COUNT_MALLOC 0
#endif

namespace {

thread_local bool counting = false;
thread_local int num_allocations = 0;

void Count() {
  if (counting) ++num_allocations;
}

void* CountedNew(std::size_t size) {
  Count();
  void* p = std::malloc(size == 0 ? 1 : size);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}

void* CountedNew(std::size_t size, std::align_val_t alignment) {
  Count();
  void* p = nullptr;
  if (posix_memalign(&p, static_cast<std::size_t>(alignment), size == 0 ? 1 : size) != 0) {
    throw std::bad_alloc();
  }
  return p;
}

}  // namespace

void* operator new(std::size_t size) { return CountedNew(size); }
void* operator new[](std::size_t size) { return CountedNew(size); }
void* operator new(std::size_t size, std::align_val_t a) { return CountedNew(size, a); }
void* operator new[](std::size_t size, std::align_val_t a) { return CountedNew(size, a); }
// std::stable_sort allocates by these.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  Count();
  return std::malloc(size == 0 ? 1 : size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  Count();
  return std::malloc(size == 0 ? 1 : size);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { std::free(p); }
void operator delete[](void* p, const std::nothrow_t&) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

#if RIGEL_COUNT_MALLOC
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);

void* malloc(std::size_t size) {
  Count();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  Count();
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  Count();
  return __libc_realloc(p, size);
}
}
#endif

namespace rigel {
namespace {

// Allocations of this thread while `run` runs.
template <class Run>
int Allocations(const Run& run) {
  num_allocations = 0;
  counting = true;
  run();
  counting = false;
  return num_allocations;
}

FramePair MakePair(const SolverInfo* solver, bool inter, int num_matches) {
  SceneOptions options;
  options.num_matches = num_matches;
  options.noise_px = 0.1;
  options.inter_share = inter ? 0.5 : 0.0;
  options.outlier_share = 0.2;
  options.motion = MotionPattern::kPlanar;
  if (solver != nullptr && solver->prior == PriorKind::kVertical) {
    // Where the alignments differ.
    options.motion = MotionPattern::kRandom;
    options.rotation_axis = RotationAxisPattern::kRandom;
  }
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeScenePair(options, 1, &pair, &error)) << error;
  return pair;
}

PreparedMatches Prepare(const FramePair& pair, PriorKind kind) {
  Alignment alignment;
  std::string error;
  MotionPrior prior = pair.prior;
  prior.forward = Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(MakeAlignment(prior, kind, &alignment, &error)) << error;
  return PreparedMatches(pair.rig, pair.matches, alignment);
}

TEST(Allocation, TheCounterCounts) {
  std::vector<int>* leak_free = nullptr;
  EXPECT_GE(Allocations([&] { leak_free = new std::vector<int>(100); }), 2);
  delete leak_free;
  EXPECT_EQ(Allocations([] {}), 0);
#if RIGEL_COUNT_MALLOC
  Eigen::VectorXd v;
  EXPECT_GE(Allocations([&] { v = Eigen::VectorXd::Zero(100); }), 1) << "Eigen's heap is seen";
#endif
}

TEST(Allocation, SolversMakeNone) {
  for (const SolverInfo& solver : SolverCatalogue()) {
    for (const bool inter : {false, true}) {
      const FramePair pair = MakePair(&solver, inter, 60);
      const GroupedMatches grouped(pair.rig, pair.matches);
      // Indices into the matches in their grouped order.
      const PreparedMatches matches(pair.rig, grouped.matches(),
                                    Prepare(pair, solver.prior).alignment());
      const Sampler sampler(grouped.groups(), solver.sampling, solver.sample_size);
      ASSERT_TRUE(sampler.CanDraw()) << solver.name;
      Solutions solutions;
      Random random(1);
      int sample[64];
      int num_solutions = 0;
      EXPECT_EQ(Allocations([&] {
                  for (int k = 0; k < 20; ++k) {
                    sampler.Draw(&random, sample);
                    num_solutions += solver.solve(matches, sample, &solutions);
                  }
                }),
                0)
          << solver.name << (inter ? " inter" : " intra");
      // Else nothing was tested. Solvers of special sample shapes may find none here.
      if (solver.exact && solver.prior != PriorKind::kNone) {
        EXPECT_GT(num_solutions, 0) << solver.name;
      }
    }
  }
}

TEST(Allocation, SamplerMakesNone) {
  const FramePair pair = MakePair(nullptr, true, 100);
  const GroupedMatches grouped(pair.rig, pair.matches);
  Random random(1);
  int sample[64];
  for (const SampleKind kind :
       {SampleKind::kSpread, SampleKind::kOneCamera, SampleKind::kOnePairPlusOne}) {
    const Sampler sampler(grouped.groups(), kind, 17);
    ASSERT_TRUE(sampler.CanDraw());
    EXPECT_EQ(Allocations([&] {
                for (int k = 0; k < 20; ++k) sampler.Draw(&random, sample);
              }),
              0);
  }
}

TEST(Allocation, ScoreMakesNone) {
  const FramePair pair = MakePair(nullptr, true, 300);
  const GroupedMatches grouped(pair.rig, pair.matches);
  double score = 0.0;
  int inliers = 0;
  EXPECT_EQ(Allocations([&] {
              score = grouped.Score(*pair.truth, 1.5, std::numeric_limits<double>::infinity(),
                                    &inliers);
              grouped.Score(Pose(), 1.5, 0.1 * score, &inliers);
              grouped.ScoreInFront(*pair.truth, 1.5, score, &inliers);
            }),
            0);
  EXPECT_GT(score, 0.0);
  // The caller's buffers are grown once.
  std::vector<double> errors;
  grouped.SquaredErrors(Pose(), &errors);
  std::vector<char> selected;
  grouped.SelectInliers(Pose(), 1.5, &errors, &selected);
  EXPECT_EQ(Allocations([&] {
              grouped.SquaredErrors(*pair.truth, &errors);
              grouped.SelectInliers(*pair.truth, 1.5, &errors, &selected);
            }),
            0);
}

TEST(Allocation, PreparingTheNextFramePairKeepsTheMemory) {
  const FramePair pair = MakePair(nullptr, true, 100);
  PreparedMatches matches = Prepare(pair, PriorKind::kAxis);
  const Alignment alignment = matches.alignment();
  EXPECT_EQ(Allocations([&] { matches.Set(pair.rig, pair.matches, alignment); }), 0);
}

// The real thing without its optimizer, which lives in refine.
struct RigSolver {
  using Model = Pose;
  using Solutions = rigel::Solutions;

  int num_data() const { return grouped->size(); }
  int sample_size() const { return info->sample_size; }
  bool Draw(Random* random, int* sample) const { return sampler->Draw(random, sample); }
  double Work(int num_solutions) const { return 1.0 + num_solutions; }
  int MinimalSolver(const int* sample, Solutions* solutions) const {
    return info->solve(*matches, sample, solutions);
  }
  double QuickScore(const Model& model, double bound) const {
    int inliers = 0;
    return grouped->Score(model, 1.5, bound, &inliers);
  }
  double Score(const Model& model, double bound, int* inliers) const {
    return grouped->ScoreInFront(model, 1.5, bound, inliers);
  }
  bool Admit(Model*) const { return true; }
  bool LocalOptimize(Model*) const { return false; }
  bool Similar(const Model&, const Model&) const { return false; }
  bool BailsOut(const Model&, double) const { return false; }
  double LooseScore(const Model& model, double bound) const { return QuickScore(model, bound); }
  bool OptimizeLoosely(Model*) const { return false; }

  const SolverInfo* info;
  const GroupedMatches* grouped;
  const PreparedMatches* matches;
  const Sampler* sampler;
};

TEST(Allocation, RansacLoopMakesNone) {
  const SolverInfo* info = FindSolver("4pt-axis");
  ASSERT_NE(info, nullptr);
  const FramePair pair = MakePair(info, true, 200);
  const GroupedMatches grouped(pair.rig, pair.matches);
  const PreparedMatches matches(pair.rig, grouped.matches(),
                                Prepare(pair, info->prior).alignment());
  const Sampler sampler(grouped.groups(), info->sampling, info->sample_size);
  const RigSolver solver = {info, &grouped, &matches, &sampler};
  RigSolver::Solutions solutions;
  RansacResult<RigSolver::Model> result;
  const RansacOptions options;
  EXPECT_EQ(Allocations([&] { result = Ransac(solver, options, &solutions); }), 0);
  EXPECT_TRUE(result.found);
  EXPECT_GE(result.num_inliers, 140) << "of 160";
  EXPECT_GE(result.iterations, options.min_iterations);
}

// The whole estimate, local optimization and PROSAC included: a longer loop allocates no more.
TEST(Allocation, TheLoopOfAnEstimateMakesNone) {
  for (const char* solver : {"4pt-approx", "5pt+1"}) {
    FramePair pair = MakePair(FindSolver(solver), true, 300);
    Random random(5);
    for (size_t k = 0; k < pair.matches.size(); ++k) {
      pair.matches[k].score = random.Uniform();
      // Outliers, so that better hypotheses keep coming.
      if (k % 2 == 0) pair.matches[k].pixel2.x() += random.Uniform(-100, 100);
    }
    const auto count = [&](int iterations) {
      EstimateOptions options;
      options.solver = solver;
      options.refine_motion = false;
      options.ransac.min_iterations = 50;
      options.ransac.max_iterations = iterations;
      options.ransac.confidence = 1.0 - 1e-15;
      MotionEstimate estimate;
      const auto allocations = Allocations([&] { estimate = EstimateMotion(options, pair); });
      EXPECT_EQ(estimate.iterations, iterations);
      return allocations;
    };
    EXPECT_EQ(count(100), count(200)) << solver;
  }
}

}  // namespace
}  // namespace rigel
