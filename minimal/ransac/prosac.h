// PROSAC: samples from the matches of best score first, from all of them in the end.
//
// Chum and Matas 2005. Draw number t comes from the best n(t) matches, where n grows such that
// after as many draws as plain RANSAC would make, every n has had its share of them. Unlike in the
// paper the n-th match need not be in the sample, and RANSAC stops by its own rule. A score that is
// NaN counts as the worst.
#ifndef RIGEL_MINIMAL_RANSAC_PROSAC_H_
#define RIGEL_MINIMAL_RANSAC_PROSAC_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/random.h"
#include "rigel/minimal/ransac/sampler.h"

namespace rigel {

class ProsacSampler {
 public:
  // `total_draws`: as many as plain RANSAC would make, >= 1. Without `use_scores`, and where all
  // matches have one score, the samples are those of a Sampler.
  ProsacSampler(const GroupedMatches& matches, SampleKind kind, int sample_size, int total_draws,
                bool use_scores = true);

  // The next sample, grouped positions of distinct matches; false if there is none. No heap.
  bool Draw(Random* random, int* sample);

  bool CanDraw() const { return sampler_.CanDraw(); }

  // Of the best so many matches the last sample was drawn.
  int pool_size() const { return pool_size_; }

 private:
  void Grow();

  SampleKind kind_;
  int sample_size_;
  std::vector<int> by_score_;       // group of each match, best score first
  std::vector<MatchGroup> pool_;    // groups of the pool, one after the other
  std::vector<MatchGroup> groups_;  // of all
  std::vector<int> order_;          // within a group the best first: grouped positions
  Sampler sampler_;
  int pool_size_ = 0;
  double draws_of_pool_ = 0.0;  // T_n of the paper
  int last_draw_of_pool_ = 0;   // T'_n
  int draws_ = 0;
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_RANSAC_PROSAC_H_
