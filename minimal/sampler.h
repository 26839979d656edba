// Random samples for RANSAC, spread over the cameras.
#ifndef RIGEL_MINIMAL_SAMPLER_H_
#define RIGEL_MINIMAL_SAMPLER_H_

#include <vector>

#include "rigel/core/random.h"
#include "rigel/minimal/grouped_matches.h"

namespace rigel {

// A sample from one camera pair says nothing about scale, so where there are several pairs the
// first two matches of a sample come from different ones; the rest are drawn from all. Every
// loop is bounded.
class Sampler {
 public:
  Sampler(const std::vector<MatchGroup>& groups, int num_matches)
      : groups_(groups), num_matches_(num_matches) {}

  // `size` distinct indices. False if there are fewer matches than that.
  bool Draw(int size, Random* random, int* sample) const;

 private:
  std::vector<MatchGroup> groups_;
  int num_matches_;
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SAMPLER_H_
