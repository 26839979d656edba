// Prints the inliers of seeded RANSAC runs of each minimal solver, a line a run: solver, pair, the
// number of inliers, and 1 or 0 for each match. What one processor prints, another has to print.
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "rigel/core/alignment.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/ransac/ransac.h"
#include "rigel/minimal/ransac/sampler.h"
#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {
namespace {

constexpr int kPairs = 3;
constexpr double kThresholdPx = 2.0;  // 4 sigma of the scene's noise
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// The solver concept of ransac.h without any optimization, which is refine's.
class MinimalOnly {
 public:
  using Model = Solution;
  using Solutions = rigel::Solutions;

  MinimalOnly(const SolverInfo& solver, const GroupedMatches& matches, const Alignment& alignment)
      : solver_(solver),
        matches_(matches),
        prepared_(matches.rig(), matches.matches(), alignment),
        sampler_(matches.groups(), solver.sampling, solver.sample_size) {}

  int num_data() const { return matches_.size(); }
  int sample_size() const { return solver_.sample_size; }
  bool Draw(Random* random, int* sample) const { return sampler_.Draw(random, sample); }
  int MinimalSolver(const int* sample, Solutions* solutions) const {
    return solver_.solve(prepared_, sample, solutions);
  }
  double Work(int) const { return solver_.nominal_us; }
  double QuickScore(const Model& model, double bound) const {
    return matches_.Score(model, kThresholdPx, bound, nullptr);
  }
  double Score(const Model& model, double bound, int* inliers) const {
    return matches_.ScoreInFront(model, kThresholdPx, bound, inliers);
  }
  bool Admit(Model* model) const {
    Model flipped = *model;
    flipped.t = -model->t;
    const double score = Score(*model, kUnbounded, nullptr);
    if (Score(flipped, score, nullptr) < score) *model = flipped;
    return model->AllFinite();
  }
  bool BailsOut(const Model&, double) const { return false; }
  double LooseScore(const Model& model, double bound) const { return QuickScore(model, bound); }
  bool LocalOptimize(Model*) const { return false; }
  bool OptimizeLoosely(Model*) const { return false; }
  bool Similar(const Model&, const Model&) const { return false; }

 private:
  const SolverInfo& solver_;
  const GroupedMatches& matches_;
  PreparedMatches prepared_;
  Sampler sampler_;
};

bool PrintInliers(const SolverInfo& solver, int index) {
  SceneOptions scene;
  scene.num_matches = 120;
  scene.inter_share = 0.5;
  scene.outlier_share = 0.3;
  scene.motion = MotionPattern::kPlanar;  // which all priors allow
  FramePair pair;
  Alignment alignment;
  std::string error;
  if (!MakeScenePair(scene, index, &pair, &error) ||
      !MakeAlignment(pair.prior, solver.prior, &alignment, &error)) {
    std::fprintf(stderr, "%s: %s\n", solver.name, error.c_str());
    return false;
  }

  RansacOptions options;
  options.threshold_px = kThresholdPx;
  options.max_iterations = 300;
  options.local_optimization = false;
  const GroupedMatches matches(pair.rig, pair.matches);
  const MinimalOnly concept_of_solver(solver, matches, alignment);
  Solutions solutions;
  const RansacResult<Solution> result = Ransac(concept_of_solver, options, &solutions);

  std::vector<double> errors;
  std::vector<char> inliers(matches.size(), 0);
  int count = 0;
  if (result.found) count = matches.SelectInliers(result.best, kThresholdPx, &errors, &inliers);
  std::string bits;
  for (const char inlier : inliers) bits += inlier != 0 ? '1' : '0';
  std::printf("%-24s %d %4d %s\n", solver.name, index, count, bits.c_str());
  return true;
}

}  // namespace
}  // namespace rigel

int main() {
  for (const rigel::SolverInfo& solver : rigel::SolverCatalogue()) {
    for (int index = 0; index < rigel::kPairs; ++index) {
      if (!rigel::PrintInliers(solver, index)) return 1;
    }
  }
  return 0;
}
