// Uniform random samples for RANSAC, spread over the camera pairs.
#ifndef RIGEL_MINIMAL_RANSAC_SAMPLER_H_
#define RIGEL_MINIMAL_RANSAC_SAMPLER_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/random.h"
#include "rigel/minimal/catalogue.h"

namespace rigel {

// Draws samples of the solver's kind (SampleKind of catalogue.h). Draws without retries, so every
// loop is bounded.
class Sampler {
 public:
  // `groups` are those of the grouped matches that the indices refer to.
  Sampler(const std::vector<MatchGroup>& groups, SampleKind kind, int sample_size);

  // The same for other groups, which may be empty. No heap if there are at most as many as before.
  void Set(const std::vector<MatchGroup>& groups, SampleKind kind, int sample_size);

  // False if the matches allow no sample at all.
  bool CanDraw() const { return can_draw_; }

  // Fills `sample` with sample_size distinct indices. False if there is no sample.
  bool Draw(Random* random, int* sample) const;

 private:
  std::vector<MatchGroup> groups_;   // those that are not empty
  std::vector<MatchGroup> allowed_;  // those with enough matches for the part of one camera pair
  int num_matches_ = 0;
  int num_allowed_ = 0;  // matches in them
  SampleKind kind_ = SampleKind::kSpread;
  int sample_size_ = 0;
  bool can_draw_ = false;
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_RANSAC_SAMPLER_H_
