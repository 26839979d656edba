#include "rigel/minimal/sampler.h"

namespace rigel {

bool Sampler::Draw(int size, Random* random, int* sample) const {
  if (num_matches_ < size || size < 1) return false;
  // Sorted copies of what is taken, so that each draw from the remaining ones needs no retry: the
  // r-th free index is r plus the number of taken ones at or below it.
  int taken[64];
  int num_taken = 0;
  const auto take = [&](int index) {
    int k = num_taken++;
    for (; k > 0 && taken[k - 1] > index; --k) taken[k] = taken[k - 1];
    taken[k] = index;
  };

  sample[0] = random->Index(num_matches_);
  take(sample[0]);
  int drawn = 1;
  if (groups_.size() > 1 && size > 1) {
    for (const MatchGroup& group : groups_) {
      if (sample[0] < group.begin || sample[0] >= group.begin + group.size) continue;
      int r = random->Index(num_matches_ - group.size);
      if (r >= group.begin) r += group.size;
      sample[1] = r;
      take(r);
      drawn = 2;
      break;
    }
  }
  for (; drawn < size; ++drawn) {
    int r = random->Index(num_matches_ - num_taken);
    for (int k = 0; k < num_taken && taken[k] <= r; ++k) ++r;
    sample[drawn] = r;
    take(r);
  }
  return true;
}

}  // namespace rigel
