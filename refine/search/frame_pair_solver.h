// A solver of the catalogue on the matches of a frame pair, as Ransac() takes it (ransac.h).
#ifndef RIGEL_REFINE_SEARCH_FRAME_PAIR_SOLVER_H_
#define RIGEL_REFINE_SEARCH_FRAME_PAIR_SOLVER_H_

#include <vector>

#include "rigel/core/alignment.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/random.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/ransac/prosac.h"
#include "rigel/minimal/ransac/ransac.h"
#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"
#include "rigel/refine/least_squares/small_engine.h"

namespace rigel {

class FramePairSolver {
 public:
  using Model = Solution;
  using Solutions = rigel::Solutions;

  // `matches` and `options` must outlive this object.
  FramePairSolver(const SolverInfo& solver, const GroupedMatches& matches,
                  const Alignment& alignment, const RansacOptions& options);
  FramePairSolver(const FramePairSolver&) = delete;
  FramePairSolver& operator=(const FramePairSolver&) = delete;

  // False if the matches allow no sample of the solver's kind.
  bool CanDraw() const { return sampler_.CanDraw(); }

  int num_data() const { return scored_.size(); }
  int sample_size() const { return solver_.sample_size; }
  bool Draw(Random* random, int* sample) const { return sampler_.Draw(random, sample); }
  int MinimalSolver(const int* sample, Solutions* solutions) const {
    prepared_.Prepare(sample, solver_.sample_size);
    return solver_.solve(prepared_, sample, solutions);
  }
  double Work(int num_solutions) const;
  // Without the depths, which only add to the score. It hardly depends on the sign of t.
  double QuickScore(const Model& model, double bound) const {
    return scored_.Score(model, threshold_px_, bound, nullptr);
  }
  bool BailsOut(const Model& model, double best) const;
  double Score(const Model& model, double bound, int* inliers) const {
    return scored_.ScoreInFront(model, threshold_px_, bound, inliers);
  }
  bool Admit(Model* model) const;
  bool Similar(const Model& a, const Model& b) const;
  double LooseScore(const Model& model, double bound) const {
    return subset_.Score(model, kLooseFactor * threshold_px_, bound, nullptr);
  }
  // In two steps: at the loose threshold, then at the threshold.
  bool OptimizeLoosely(Model* model) const;
  bool LocalOptimize(Model* model) const;

 private:
  // Times the threshold. A prior with an error of half a degree moves points by a few pixels.
  static constexpr double kLooseFactor = 4.0;

  // True if |t| of a minimal solution is mostly noise.
  bool ScaleIsNoise(const Model& model) const { return intra_only_ || !model.has_scale; }
  void ResolveSignAndMaybeScale(double threshold, Model* model) const;
  bool OptimizeOn(const GroupedMatches& matches, SmallEngine* engine, double threshold,
                  Model* model) const;

  const SolverInfo& solver_;
  const GroupedMatches& matches_;
  GroupedMatches scored_subset_;  // empty if all matches are scored
  const GroupedMatches& scored_;
  GroupedMatches subset_;
  GroupedMatches drawn_subset_;
  GroupedMatches sign_subset_;
  mutable PreparedMatches prepared_;
  mutable ProsacSampler sampler_;
  const RansacOptions& options_;
  GroupedMatches optimized_;
  mutable SmallEngine loose_engine_;
  mutable SmallEngine engine_;
  double threshold_px_;
  mutable std::vector<double> squared_errors_;
  mutable std::vector<char> inliers_;
  bool intra_only_ = true;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_FRAME_PAIR_SOLVER_H_
