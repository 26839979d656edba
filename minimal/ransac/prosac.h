// PROSAC: draws samples from the matches of best score first, and in the end from all.
//
// Source: Chum and Matas, "Matching with PROSAC", CVPR 2005. Sample number t is drawn from the best
// n(t) matches. n grows with t, such that after `total_draws` samples it is the number of all
// matches. Two differences from the paper: the n-th match need not be in the sample, and RANSAC
// decides when to stop. A score that is NaN counts as the worst.
#ifndef RIGEL_MINIMAL_RANSAC_PROSAC_H_
#define RIGEL_MINIMAL_RANSAC_PROSAC_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/random.h"
#include "rigel/minimal/ransac/sampler.h"

namespace rigel {

class ProsacSampler {
 public:
  // `total_draws`: the number of samples that RANSAC draws at most, >= 1. Without `use_scores`, or
  // if all scores are equal, the samples are those of a Sampler.
  ProsacSampler(const GroupedMatches& matches, SampleKind kind, int sample_size, int total_draws,
                bool use_scores = true);

  // Draws the next sample: grouped positions of distinct matches. False if there is none. No heap.
  bool Draw(Random* random, int* sample);

  bool CanDraw() const { return sampler_.CanDraw(); }

  // Number of best matches from which the last sample was drawn.
  int pool_size() const { return pool_size_; }

 private:
  void Grow();

  SampleKind kind_;
  int sample_size_;
  std::vector<int> by_score_;       // group of each match, best score first
  std::vector<MatchGroup> pool_;    // groups of the pool, one after the other
  std::vector<MatchGroup> groups_;  // of all matches
  std::vector<int> order_;          // grouped positions, within each group by score, best first
  Sampler sampler_;
  int pool_size_ = 0;
  double draws_of_pool_ = 0.0;  // T_n of the paper
  int last_draw_of_pool_ = 0;   // T'_n
  int draws_ = 0;
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_RANSAC_PROSAC_H_
