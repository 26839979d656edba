#include "rigel/minimal/ransac/sampler.h"

namespace rigel {
namespace {

// Capacity, matches of a sample; fixed, for no heap. The largest sample of the catalogue has 17.
constexpr int kMaxSample = 64;

// Draws distinct indices without a retry: the r-th free index is r plus the number of taken indices
// at or below it.
class DistinctDraw {
 public:
  // Draws from [begin, begin + size); at least one index must be free.
  int Draw(int begin, int size, Random* random) {
    int free = size;
    for (int k = 0; k < num_taken_; ++k) {
      free -= taken_[k] >= begin && taken_[k] < begin + size ? 1 : 0;
    }
    int index = begin + random->Index(free);
    for (int k = 0; k < num_taken_; ++k) {
      if (taken_[k] >= begin && taken_[k] <= index) ++index;
    }
    Take(index);
    return index;
  }

 private:
  void Take(int index) {
    int k = num_taken_++;
    for (; k > 0 && taken_[k - 1] > index; --k) taken_[k] = taken_[k - 1];
    taken_[k] = index;
  }

  int taken_[kMaxSample];  // ascending
  int num_taken_ = 0;
};

const MatchGroup& GroupOf(const std::vector<MatchGroup>& groups, int index) {
  size_t g = 0;
  while (index >= groups[g].begin + groups[g].size) ++g;
  return groups[g];
}

}  // namespace

Sampler::Sampler(const std::vector<MatchGroup>& groups, SampleKind kind, int sample_size) {
  groups_.reserve(groups.size());
  allowed_.reserve(groups.size());
  Set(groups, kind, sample_size);
}

void Sampler::Set(const std::vector<MatchGroup>& groups, SampleKind kind, int sample_size) {
  kind_ = kind;
  sample_size_ = sample_size;
  groups_.clear();
  allowed_.clear();
  num_matches_ = 0;
  num_allowed_ = 0;
  for (const MatchGroup& group : groups) {
    if (group.size == 0) continue;
    groups_.push_back(group);
    num_matches_ += group.size;
  }
  const int of_one_pair = kind == SampleKind::kOnePairPlusOne ? sample_size - 1 : sample_size;
  for (const MatchGroup& group : groups_) {
    if (kind == SampleKind::kOneCamera && group.camera1 != group.camera2) continue;
    if (group.size < of_one_pair) continue;
    allowed_.push_back(group);
    num_allowed_ += group.size;
  }
  can_draw_ = sample_size >= 1 && sample_size <= kMaxSample && num_matches_ >= sample_size &&
              (kind == SampleKind::kSpread || num_allowed_ > 0);
}

bool Sampler::Draw(Random* random, int* sample) const {
  if (!can_draw_) return false;
  DistinctDraw distinct;
  int drawn = 0;
  if (kind_ == SampleKind::kSpread) {
    sample[drawn++] = distinct.Draw(0, num_matches_, random);
    if (groups_.size() > 1 && sample_size_ > 1) {
      // Any match outside the first one's group.
      const MatchGroup& group = GroupOf(groups_, sample[0]);
      const int before = group.begin;
      const int after = num_matches_ - group.begin - group.size;
      sample[drawn++] = random->Index(before + after) < before
                            ? distinct.Draw(0, before, random)
                            : distinct.Draw(group.begin + group.size, after, random);
    }
  } else {
    // A camera pair, with a probability proportional to its number of matches.
    int index = random->Index(num_allowed_);
    size_t g = 0;
    while (index >= allowed_[g].size) index -= allowed_[g++].size;
    const MatchGroup& group = allowed_[g];
    const int of_one_pair = kind_ == SampleKind::kOnePairPlusOne ? sample_size_ - 1 : sample_size_;
    while (drawn < of_one_pair) sample[drawn++] = distinct.Draw(group.begin, group.size, random);
    const int before = group.begin;
    const int after = num_matches_ - group.begin - group.size;
    if (drawn < sample_size_ && before + after > 0) {
      sample[drawn++] = random->Index(before + after) < before
                            ? distinct.Draw(0, before, random)
                            : distinct.Draw(group.begin + group.size, after, random);
    }
  }
  while (drawn < sample_size_) sample[drawn++] = distinct.Draw(0, num_matches_, random);
  return true;
}

}  // namespace rigel
