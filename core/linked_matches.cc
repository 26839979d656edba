#include "rigel/core/linked_matches.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>

namespace rigel {
namespace {

size_t Hash(const ImagePoint& p) {
  constexpr uint64_t kFactor = 0x9e3779b97f4a7c15;  // the golden ratio times 2^64: spreads bits
  // -0.0 and 0.0 are one place.
  const double u = p.u + 0.0, v = p.v + 0.0;
  uint64_t bits_u, bits_v;
  std::memcpy(&bits_u, &u, sizeof u);
  std::memcpy(&bits_v, &v, sizeof v);
  uint64_t h = (bits_u + static_cast<uint64_t>(p.camera)) * kFactor;
  h = (h ^ static_cast<uint64_t>(p.landmark)) * kFactor;
  h = ((h ^ (h >> 32)) + bits_v) * kFactor;
  return static_cast<size_t>(h ^ (h >> 29));
}

// Joins the matches of the mask that have the same point.
void JoinSame(const SamePoints& same, const std::vector<char>& mask, DisjointSets* sets) {
  for (const int first : same.firsts()) {
    int before = -1;
    for (int k = first; k >= 0; k = same.Next(k)) {
      if (!mask[k]) continue;
      if (before >= 0) sets->Join(before, k);
      before = k;
    }
  }
}

}  // namespace

ImagePoint ImagePoints::At(int k, bool at_time2) const {
  const Match& match = matches_[k];
  const int camera = at_time2 ? match.camera2 : match.camera1;
  if (!landmark_.empty()) return {camera, 0.0, 0.0, landmark_[k]};
  const Pixel& p = at_time2 ? match.pixel2 : match.pixel1;
  return {camera, p.x(), p.y(), 0};
}

SamePoints::SamePoints(const ImagePoints& points, bool at_time2)
    : next_(points.size(), -1), last_(points.size(), -1) {
  size_t size = 16;
  while (size < 2 * next_.size()) size *= 2;
  std::vector<int> table(size, -1);
  for (int row = 0; row < points.size(); ++row) {
    const ImagePoint point = points.At(row, at_time2);
    size_t place = Hash(point) & (size - 1);
    while (table[place] >= 0 && !(points.At(table[place], at_time2) == point)) {
      place = (place + 1) & (size - 1);
    }
    int& first = table[place];
    if (first < 0) {
      first = row;
    } else {
      if (last_[first] < 0) firsts_.push_back(first);
      next_[last_[first] < 0 ? first : last_[first]] = row;
      last_[first] = row;
    }
  }
}

DisjointSets::DisjointSets(int n) : link_(n) { std::iota(link_.begin(), link_.end(), 0); }

int DisjointSets::LeastOf(int k) {
  while (link_[k] != k) k = link_[k] = link_[link_[k]];
  return k;
}

void DisjointSets::Join(int a, int b) {
  a = LeastOf(a);
  b = LeastOf(b);
  link_[std::max(a, b)] = std::min(a, b);
}

std::vector<std::vector<int>> LinkedMatches(const ImagePoints& points,
                                            const std::vector<char>& mask) {
  DisjointSets linked(points.size());
  JoinSame(SamePoints(points, false), mask, &linked);
  JoinSame(SamePoints(points, true), mask, &linked);
  std::vector<std::vector<int>> sets;
  std::vector<size_t> set_of(points.size());
  for (int k = 0; k < points.size(); ++k) {
    if (!mask[k]) continue;
    const int root = linked.LeastOf(k);
    if (root == k) {
      set_of[k] = sets.size();
      sets.emplace_back();
    }
    sets[set_of[root]].push_back(k);
  }
  return sets;
}

}  // namespace rigel
