#include "rigel/minimal/ransac/prosac.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

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
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0);
  pool_ = groups_;
  pool_size_ = n;
  if (!use_scores || n <= kFirstPool || n <= sample_size) return;
  std::vector<std::pair<double, int>> ranking(n);  // score, match
  for (int k = 0; k < n; ++k) {
    const double score = matches.matches()[k].score;
    ranking[k] = {std::isnan(score) ? std::numeric_limits<double>::infinity() : score, k};
  }
  const double first_score = ranking[0].first;
  if (std::all_of(ranking.begin(), ranking.end(),
                  [=](const auto& ranked) { return ranked.first == first_score; })) {
    return;
  }
  std::sort(ranking.begin(), ranking.end());
  std::vector<int> group_of(n), next;
  for (const MatchGroup& group : groups_) {
    std::fill_n(group_of.begin() + group.begin, group.size, static_cast<int>(next.size()));
    next.push_back(group.begin);
  }
  by_score_.reserve(n);
  for (const auto& [score, k] : ranking) {
    by_score_.push_back(group_of[k]);
    order_[next[group_of[k]]++] = k;
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
