// The RANSAC loop. It draws, solves and scores through the methods of a solver, and knows nothing
// of geometry.
//
// - Samples: as the solver draws them (PROSAC: prosac.h).
// - Score: see ScoreKind. Scoring stops early once a hypothesis can no longer win, or is too
//   unlikely to win.
// - Iterations: their number adapts to the share of inliers.
// - Local optimization: of the best hypothesis of the first min_iterations, and of each better one
//   after them. At the end also of the finalists, the best hypotheses by a loose threshold.
// The result depends on the input and the seed only.
#ifndef RIGEL_MINIMAL_RANSAC_RANSAC_H_
#define RIGEL_MINIMAL_RANSAC_RANSAC_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "rigel/core/random.h"
#include "rigel/core/stop.h"
#include "rigel/minimal/ransac/ransac_options.h"

namespace rigel {

template <class Model>
struct RansacResult {
  bool found = false;
  Model best;          // after local optimization
  double score = 0.0;  // of `best`
  int num_inliers = 0;
  // Optimized finalists that are not similar to `best` and have nearly its score: other minima.
  static constexpr int kMaxOthers = 2;
  std::array<Model, kMaxOthers> others;
  int num_others = 0;
  // The best-scoring minimal hypothesis of the run, before any optimization.
  Model best_minimal;
  double minimal_score = 0.0;
  int iterations = 0;
  int64_t hypotheses = 0;
  double work_us = 0.0;  // see RansacOptions::max_work_us
};

// What Ransac() asks of a solver. All methods are const; the solver owns the data.
//   Model, Solutions           a motion, and a list of them with size() and operator[]
//   num_data(), sample_size()
//   Draw(Random*, int*)        false if no sample can be drawn
//   MinimalSolver(sample, Solutions*)   number of solutions
//   Work(num_solutions)        nominal microseconds of a sample and of scoring its solutions
//   QuickScore(model, bound)   a lower bound of Score() after Admit(); may stop early above `bound`
//   BailsOut(model, best)      true if it is very unlikely that QuickScore() is below `best`
//   Admit(Model*)              false if physically impossible; may change the sign of t
//   Score(model, bound, int* inliers)   lower is better; may stop early above `bound`
//   LocalOptimize(Model*)      false: unchanged
//   LooseScore(model, bound)   lower is better, at a loose threshold, cheap; may stop above `bound`
//   OptimizeLoosely(Model*)    local optimization from far off the minimum; false: no model
//   Similar(model, model)      true if optimizing both is likely to give the same motion
template <class S, class = void>
struct IsRansacSolver : std::false_type {};
template <class S>
struct IsRansacSolver<
    S,
    std::void_t<
        typename S::Model, typename S::Solutions,
        decltype(double{
            std::declval<const S&>().LooseScore(std::declval<const typename S::Model&>(), 0.0)}),
        decltype(
            bool{std::declval<const S&>().OptimizeLoosely(std::declval<typename S::Model*>())}),
        decltype(bool{std::declval<const S&>().Similar(std::declval<const typename S::Model&>(),
                                                       std::declval<const typename S::Model&>())}),
        decltype(int{std::declval<const S&>().num_data()}),
        decltype(int{std::declval<const S&>().sample_size()}),
        decltype(
            bool{std::declval<const S&>().Draw(std::declval<Random*>(), std::declval<int*>())}),
        decltype(int{std::declval<const S&>().MinimalSolver(
            std::declval<const int*>(), std::declval<typename S::Solutions*>())}),
        decltype(double{std::declval<const S&>().Work(0)}),
        decltype(double{
            std::declval<const S&>().QuickScore(std::declval<const typename S::Model&>(), 0.0)}),
        decltype(
            bool{std::declval<const S&>().BailsOut(std::declval<const typename S::Model&>(), 0.0)}),
        decltype(double{std::declval<const S&>().Score(std::declval<const typename S::Model&>(),
                                                       0.0, std::declval<int*>())}),
        decltype(bool{std::declval<const S&>().Admit(std::declval<typename S::Model*>())}),
        decltype(bool{std::declval<const S&>().LocalOptimize(std::declval<typename S::Model*>())})>>
    : std::true_type {};

// Iterations after which, with probability `confidence`, a sample of inliers only has been drawn.
inline int IterationsNeeded(double inlier_ratio, int sample_size, double confidence,
                            int max_iterations) {
  const double good = std::pow(std::clamp(inlier_ratio, 0.0, 1.0), sample_size);
  if (!(good > 0.0)) return max_iterations;
  if (good >= 1.0) return 1;
  const double n = std::log1p(-confidence) / std::log1p(-good);
  return n < max_iterations ? std::max(1, static_cast<int>(std::ceil(n))) : max_iterations;
}

namespace ransac_internal {

// The best hypotheses so far of which no two are similar, best first.
template <class Model>
struct Finalists {
  struct Item {
    Model model;
    double score;
  };
  Item items[kMaxFinalists];
  int size = 0;

  template <class Solver>
  void Add(const Solver& solver, const Model& model, double score, int capacity) {
    // Not added if a similar one is at least as good. Similar ones that are worse are removed.
    int kept = 0;
    for (int k = 0; k < size; ++k) {
      const bool similar = solver.Similar(items[k].model, model);
      if (similar && items[k].score <= score) return;
      if (!similar) items[kept++] = items[k];
    }
    size = kept;
    if (size == capacity) {
      if (!(score < items[size - 1].score)) return;
      --size;
    }
    int k = size++;
    for (; k > 0 && items[k - 1].score > score; --k) items[k] = items[k - 1];
    items[k] = {model, score};
  }

  double Worst(int capacity) const {
    return size == capacity ? items[size - 1].score : std::numeric_limits<double>::infinity();
  }
};

}  // namespace ransac_internal

// A run that can be interrupted and continued, so that several runs can share one budget of
// iterations. The interruptions do not change the result. All arguments must outlive the run;
// `options` must be valid. `stop` (may be null) is asked before each iteration; if it stops the
// run, the result is the best motion by then. Only the solver's methods allocate memory.
template <class Solver>
class RansacRun {
 public:
  static_assert(IsRansacSolver<Solver>::value, "Solver lacks a method: see IsRansacSolver");
  using Model = typename Solver::Model;

  RansacRun(const Solver& solver, const RansacOptions& options,
            typename Solver::Solutions* solutions, Stop* stop = nullptr)
      : solver_(solver),
        options_(options),
        solutions_(solutions),
        stop_(stop),
        random_(options.seed),
        capacity_(options.local_optimization ? options.num_finalists : 0),
        needed_(options.max_iterations) {
    result_.score = kInfinity;
    result_.minimal_score = kInfinity;
  }

  // Makes at most `iterations` more. Returns how many it made: fewer if the run is done.
  int Advance(int iterations) {
    const int before = result_.iterations;
    const int end = before + std::min(iterations, options_.max_iterations - before);
    while (result_.iterations < end && !Done() && !Stopped()) Iterate();
    return result_.iterations - before;
  }

  // True if a sample of inliers was drawn with the confidence of the options, if there is no
  // sample, or if the iterations or the work are used up.
  bool Done() const {
    return exhausted_ || !(result_.work_us < options_.max_work_us) ||
           result_.iterations >=
               std::min(options_.max_iterations, std::max(needed_, options_.min_iterations));
  }

  // Locally optimizes the best hypothesis and the finalists: at the end, or to judge a run so far.
  void OptimizeFinalists() {
    OptimizeBest();
    if (Stopped()) return;
    // The best motion too: its threshold may exclude the few matches of large parallax.
    const Model best = result_.best;
    // After so many finalists without an improvement the rest is skipped. Half of the default
    // number of finalists: each takes the time of a local optimization, and one that fails says
    // little of the next. What finalists give and take: rigel_benchmark --ransac=ablation.
    constexpr int kMaxWorse = 2;
    // Scores of motions that fit the same inliers about as well differ by less.
    constexpr double kAlike = 1.2;
    int num_worse = 0;
    result_.num_others = 0;
    for (int k = capacity_ > 0 ? -1 : 0; k < finalists_.size && result_.found; ++k) {
      Model model = k < 0 ? best : finalists_.items[k].model;
      if ((k >= 0 && solver_.Similar(model, best)) || !solver_.OptimizeLoosely(&model)) continue;
      int inliers = 0;
      const double before = result_.score;
      const Model best_before = result_.best;
      const double score = FullScore(model, kAlike * before, &inliers);
      KeepBest(model, score, inliers);
      if (score <= kAlike * before && before <= kAlike * score) {
        KeepOther(score < before ? best_before : model);
      }
      // The finalists are in the order of their scores: the rest is unlikely to improve.
      if (k >= 0 && !(result_.score < before) && ++num_worse == kMaxWorse) break;
    }
  }

  const RansacResult<Model>& result() const { return result_; }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  bool Stopped() const { return stop_ != nullptr && stop_->Asked(); }

  double Bound(double score) const { return options_.early_termination ? score : kInfinity; }

  bool CountsInliers() const { return options_.score == ScoreKind::kInlierCount; }

  double FullScore(const Model& model, double limit, int* inliers) const {
    if (!CountsInliers()) return solver_.Score(model, limit, inliers);
    solver_.Score(model, kInfinity, inliers);
    return solver_.num_data() - *inliers;
  }

  void KeepBest(const Model& model, double score, int inliers) {
    if (!(score < result_.score)) return;
    result_.best = model;
    result_.score = score;
    result_.num_inliers = inliers;
    needed_ = IterationsNeeded(inliers / static_cast<double>(solver_.num_data()),
                               solver_.sample_size(), options_.confidence, options_.max_iterations);
  }

  void KeepOther(const Model& model) {
    if (result_.num_others == RansacResult<Model>::kMaxOthers) return;
    if (!solver_.Similar(model, result_.best)) result_.others[result_.num_others++] = model;
  }

  void OptimizeBest() {
    if (optimized_ || !options_.local_optimization) return;
    optimized_ = true;
    Model model = result_.best_minimal;
    if (!solver_.LocalOptimize(&model)) return;
    int inliers = 0;
    const double score = FullScore(model, result_.score, &inliers);
    KeepBest(model, score, inliers);
  }

  void Iterate() {
    ++result_.iterations;
    int sample[64];
    if (!solver_.Draw(&random_, sample)) {
      exhausted_ = true;
      return;
    }
    solver_.MinimalSolver(sample, solutions_);
    result_.work_us += solver_.Work(static_cast<int>(solutions_->size()));
    for (int k = 0; k < static_cast<int>(solutions_->size()); ++k) {
      ++result_.hypotheses;
      Judge((*solutions_)[k]);
    }
    // Not before: early in a run a better hypothesis follows soon.
    if (result_.iterations == options_.min_iterations) OptimizeBest();
  }

  void Judge(Model model) {
    if (capacity_ > 0) {
      const double loose = solver_.LooseScore(model, Bound(finalists_.Worst(capacity_)));
      if (loose < finalists_.Worst(capacity_)) finalists_.Add(solver_, model, loose, capacity_);
    }
    if (options_.bail_out && !CountsInliers() && result_.found &&
        solver_.BailsOut(model, result_.minimal_score)) {
      return;
    }
    // Also false for NaN. The quick score never rejects a winner. It does not bound a count.
    if (!CountsInliers() &&
        !(solver_.QuickScore(model, Bound(result_.minimal_score)) < result_.minimal_score)) {
      return;
    }
    if (!solver_.Admit(&model)) return;
    int inliers = 0;
    const double score = FullScore(model, Bound(result_.minimal_score), &inliers);
    if (!(score < result_.minimal_score)) return;
    result_.found = true;
    result_.best_minimal = model;
    result_.minimal_score = score;
    KeepBest(model, score, inliers);
    optimized_ = false;
    if (result_.iterations > options_.min_iterations) OptimizeBest();
  }

  const Solver& solver_;
  const RansacOptions& options_;
  typename Solver::Solutions* solutions_;
  Stop* stop_;
  Random random_;
  const int capacity_;  // of the finalists
  ransac_internal::Finalists<Model> finalists_;
  RansacResult<Model> result_;
  int needed_;              // iterations
  bool optimized_ = true;   // true if the best minimal hypothesis has been optimized
  bool exhausted_ = false;  // no sample could be drawn
};

// A whole run. `options` must be valid.
template <class Solver>
RansacResult<typename Solver::Model> Ransac(const Solver& solver, const RansacOptions& options,
                                            typename Solver::Solutions* solutions,
                                            Stop* stop = nullptr) {
  RansacRun<Solver> run(solver, options, solutions, stop);
  run.Advance(options.max_iterations);
  run.OptimizeFinalists();
  return run.result();
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_RANSAC_RANSAC_H_
