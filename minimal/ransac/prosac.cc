#include "rigel/minimal/ransac/prosac.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rigel {
namespace {

// Matches of the first pool: enough that the first samples differ.
constexpr int kFirstPool = 20;

}  // namespace

ProsacSampler::ProsacSampler(const GroupedMatches& matches, SampleKind kind, int sample_size,
                             int total_draws, bool use_scores)
    : kind_(kind),
      sample_size_(sample_size),
      groups_(matches.groups()),
      sampler_(matches.groups(), kind, sample_size) {
  const int n = matches.size();
  const auto score = [&](int k) {
    const double s = matches.matches()[k].score;
    return std::isnan(s) ? std::numeric_limits<double>::infinity() : s;
  };
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0);
  pool_ = groups_;
  pool_size_ = n;
  const bool ranked = use_scores && std::any_of(order_.begin(), order_.end(),
                                                [&](int k) { return score(k) != score(0); });
  if (!ranked || n <= kFirstPool || n <= sample_size) return;

  std::vector<int> all = order_;
  const auto better = [&](int a, int b) { return score(a) < score(b); };
  std::stable_sort(all.begin(), all.end(), better);
  by_score_.reserve(n);
  size_t g = 0;
  std::vector<int> group_of(n);
  for (int k = 0; k < n; ++k) {
    while (k >= groups_[g].begin + groups_[g].size) ++g;
    group_of[k] = static_cast<int>(g);
  }
  for (const int k : all) by_score_.push_back(group_of[k]);
  for (const MatchGroup& group : groups_) {
    std::stable_sort(order_.begin() + group.begin, order_.begin() + group.begin + group.size,
                     better);
  }
  for (MatchGroup& group : pool_) group.size = 0;
  pool_size_ = 0;
  const int first = std::max(kFirstPool, sample_size);
  draws_of_pool_ = total_draws;
  for (int i = 0; i < sample_size; ++i) {
    draws_of_pool_ *= (first - i) / static_cast<double>(n - i);
  }
  last_draw_of_pool_ = 1;
  while (pool_size_ < first) ++pool_[by_score_[pool_size_++]].size;
  Grow();
}

// Sets the sampler to the pool. Adds matches to the pool until it allows a sample.
void ProsacSampler::Grow() {
  for (;;) {
    int begin = 0;
    for (MatchGroup& group : pool_) {
      group.begin = begin;
      begin += group.size;
    }
    sampler_.Set(pool_, kind_, sample_size_);
    if (sampler_.CanDraw() || pool_size_ == static_cast<int>(by_score_.size())) return;
    ++pool_[by_score_[pool_size_++]].size;
  }
}

bool ProsacSampler::Draw(Random* random, int* sample) {
  ++draws_;
  const int n = static_cast<int>(by_score_.size());
  if (draws_ > last_draw_of_pool_ && pool_size_ < n) {
    while (draws_ > last_draw_of_pool_ && pool_size_ < n) {
      const double next = draws_of_pool_ * (pool_size_ + 1) / (pool_size_ + 1 - sample_size_);
      last_draw_of_pool_ += static_cast<int>(std::ceil(next - draws_of_pool_));
      draws_of_pool_ = next;
      ++pool_[by_score_[pool_size_++]].size;
    }
    Grow();
  }
  if (!sampler_.Draw(random, sample)) return false;
  if (n == 0) return true;
  for (int k = 0; k < sample_size_; ++k) {
    size_t g = 0;
    while (sample[k] >= pool_[g].begin + pool_[g].size) ++g;
    sample[k] = order_[groups_[g].begin + sample[k] - pool_[g].begin];
  }
  return true;
}

}  // namespace rigel
