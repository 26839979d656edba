// RANSAC over a solver concept: it knows how to draw, solve and score, and nothing of geometry.
//
// MSAC, MAGSAC++ or inlier-count score, samples as the solver draws them (PROSAC: prosac.h), the
// number of iterations adapts to the share of inliers, scoring stops early once a hypothesis can no
// longer win or is too unlikely to, the best hypothesis of the first min_iterations and each better
// one after them is locally optimized, and in the end the best ones of a looser score (finalists).
// Deterministic: the seed fixes the result.
#ifndef RIGEL_MINIMAL_RANSAC_H_
#define RIGEL_MINIMAL_RANSAC_H_

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "rigel/core/pixel_unit.h"
#include "rigel/core/random.h"

namespace rigel {

inline constexpr int kMaxFinalists = 16;
inline constexpr int kMaxRedraws = 10;

enum class ScoreKind {
  kMsac,    // sum min(r^2, threshold^2), Torr and Zisserman 2000
  kMagsac,  // MAGSAC++, Barath et al. 2020: the noise level marginalized up to the threshold
  // Number of matches that are no inliers, as of Fischler and Bolles 1981: of hypotheses with as
  // many inliers the first wins. For comparisons with published figures; it never stops early.
  kInlierCount,
};

struct RansacOptions {
  // In 1e-12 to 1e12; 3 sigma keeps the estimate efficient. kAutoThresholdPx: 1.5, or 1/300 of the
  // shortest focal length where that is less; for EstimateMotion(), which resolves it.
  double threshold_px = kAutoThresholdPx;
  double confidence = 0.9999;  // in (0, 1): that one sample of inliers was drawn
  int max_iterations = 10000;  // >= 1
  // At least so many: noise makes most samples of inliers poor hypotheses.
  int min_iterations = 100;  // >= 0
  bool local_optimization = true;
  // Samples from the matches of best score first, where they have scores.
  bool prosac = true;
  // Scoring stops where a hypothesis can no longer win. Changes the time alone.
  bool early_termination = true;
  // A hypothesis is left where some of the matches say that it can hardly win (bail-out test, Capel
  // 2005): of those that would, at most one in a thousand is lost. For scores that are sums.
  bool bail_out = true;
  ScoreKind score = ScoreKind::kMsac;
  // Draws again where two matches of a sample lie within min_sample_distance_px of one another:
  // such samples say little. At most kMaxRedraws times.
  bool spread_samples = false;
  double min_sample_distance_px = 30.0;  // >= 0
  // After the loop, so many hypotheses are locally optimized that do best at a loose threshold and
  // differ from one another and from the best: where the prior is off, no minimal hypothesis fits
  // well at the threshold, and the one that fits best may be far from the truth. 0 to
  // kMaxFinalists.
  int num_finalists = 4;
  uint64_t seed = 1;

  bool IsValid(std::string* error) const;
};

template <class Model>
struct RansacResult {
  bool found = false;
  Model best;          // after local optimization
  double score = 0.0;  // of `best`
  int num_inliers = 0;
  // The best-scoring minimal hypothesis of the run, before any optimization.
  Model best_minimal;
  double minimal_score = 0.0;
  int iterations = 0;
  int64_t hypotheses = 0;
};

// What Ransac() asks of a solver. All methods are const; the solver owns the data.
//   Model, Solutions           a motion, and a list of them with size() and operator[]
//   num_data(), sample_size()
//   Draw(Random*, int*)        false if no sample can be drawn
//   MinimalSolver(sample, Solutions*)   number of solutions
//   QuickScore(model, bound)   not above Score() of the model Admit() makes of it; may stop early
//                              above `bound`
//   BailsOut(model, best)      true if it is very unlikely that QuickScore() is below `best`
//   Admit(Model*)              false if physically impossible; may change the sign of t
//   Score(model, bound, int* inliers)   lower is better; may stop early above `bound`
//   LocalOptimize(Model*)      false: unchanged
//   LooseScore(model, bound)   lower is better, at a loose threshold, cheap; may stop above `bound`
//   OptimizeLoosely(Model*)    local optimization from a model that is far off; false: no model
//   Similar(model, model)      true if optimizing both is likely to end in one place
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
    // A similar one that is better makes this one superfluous; similar ones that are worse go.
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

// `options` must be valid. No heap allocation but what the solver's methods make.
template <class Solver>
RansacResult<typename Solver::Model> Ransac(const Solver& solver, const RansacOptions& options,
                                            typename Solver::Solutions* solutions) {
  static_assert(IsRansacSolver<Solver>::value, "Solver lacks a method: see IsRansacSolver");
  using Model = typename Solver::Model;
  RansacResult<Model> result;
  result.score = std::numeric_limits<double>::infinity();
  result.minimal_score = std::numeric_limits<double>::infinity();
  Random random(options.seed);
  int sample[64];
  const int max_iterations = options.max_iterations;
  const int capacity = options.local_optimization ? options.num_finalists : 0;
  ransac_internal::Finalists<Model> finalists;
  int needed = max_iterations;

  const auto bound = [&](double score) {
    return options.early_termination ? score : std::numeric_limits<double>::infinity();
  };
  const bool count = options.score == ScoreKind::kInlierCount;
  const auto full_score = [&](const Model& model, double limit, int* inliers) -> double {
    if (!count) return solver.Score(model, limit, inliers);
    solver.Score(model, std::numeric_limits<double>::infinity(), inliers);
    return solver.num_data() - *inliers;
  };
  const auto keep_best = [&](const Model& model, double score, int inliers) {
    if (!(score < result.score)) return;
    result.best = model;
    result.score = score;
    result.num_inliers = inliers;
    needed = IterationsNeeded(inliers / static_cast<double>(solver.num_data()),
                              solver.sample_size(), options.confidence, max_iterations);
  };

  bool optimized = true;  // the best minimal hypothesis
  const auto optimize_best = [&] {
    if (optimized || !options.local_optimization) return;
    optimized = true;
    Model model = result.best_minimal;
    if (!solver.LocalOptimize(&model)) return;
    int inliers = 0;
    const double score = full_score(model, result.score, &inliers);
    keep_best(model, score, inliers);
  };

  while (result.iterations < std::min(max_iterations, std::max(needed, options.min_iterations))) {
    ++result.iterations;
    if (!solver.Draw(&random, sample)) break;
    solver.MinimalSolver(sample, solutions);
    for (int k = 0; k < static_cast<int>(solutions->size()); ++k) {
      ++result.hypotheses;
      Model model = (*solutions)[k];
      if (capacity > 0) {
        const double loose = solver.LooseScore(model, bound(finalists.Worst(capacity)));
        if (loose < finalists.Worst(capacity)) finalists.Add(solver, model, loose, capacity);
      }
      if (options.bail_out && !count && result.found &&
          solver.BailsOut(model, result.minimal_score)) {
        continue;
      }
      // Also false for NaN. The quick score never rejects a winner; of a count there is none.
      if (!count &&
          !(solver.QuickScore(model, bound(result.minimal_score)) < result.minimal_score)) {
        continue;
      }
      if (!solver.Admit(&model)) continue;
      int inliers = 0;
      const double score = full_score(model, bound(result.minimal_score), &inliers);
      if (!(score < result.minimal_score)) continue;
      result.found = true;
      result.best_minimal = model;
      result.minimal_score = score;
      keep_best(model, score, inliers);
      optimized = false;
      if (result.iterations > options.min_iterations) optimize_best();
    }
    // Before, a better hypothesis would soon make the optimization of this one superfluous.
    if (result.iterations == options.min_iterations) optimize_best();
  }
  optimize_best();
  // From the best one too: few matches of large parallax may be out of its reach.
  const Model best = result.best;
  constexpr int kMaxWorse = 2;
  int num_worse = 0;
  for (int k = capacity > 0 ? -1 : 0; k < finalists.size && result.found; ++k) {
    Model model = k < 0 ? best : finalists.items[k].model;
    if ((k >= 0 && solver.Similar(model, best)) || !solver.OptimizeLoosely(&model)) continue;
    int inliers = 0;
    const double before = result.score;
    const double score = full_score(model, result.score, &inliers);
    keep_best(model, score, inliers);
    // Where the best two finalists end no better, the others would not either.
    if (k >= 0 && !(result.score < before) && ++num_worse == kMaxWorse) break;
  }
  return result;
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_RANSAC_H_
