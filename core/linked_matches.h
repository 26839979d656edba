// Matches whose errors are not independent: they have a key point in common.
#ifndef RIGEL_CORE_LINKED_MATCHES_H_
#define RIGEL_CORE_LINKED_MATCHES_H_

#include <cstdint>
#include <vector>

#include "rigel/core/match.h"

namespace rigel {

// A point of an image: that of a landmark, or the same pixel to the last bit.
struct ImagePoint {
  int camera;
  double u, v;  // of a landmark: 0
  int64_t landmark;

  bool operator==(const ImagePoint& other) const {
    return camera == other.camera && u == other.u && v == other.v && landmark == other.landmark;
  }
};

// The points of matches. `landmark` has a number for each of them, or is empty. Both must outlive
// this object.
class ImagePoints {
 public:
  ImagePoints(const std::vector<Match>& matches, const std::vector<int64_t>& landmark)
      : matches_(matches), landmark_(landmark) {}
  int size() const { return static_cast<int>(matches_.size()); }
  ImagePoint At(int k, bool at_time2) const;
  bool Share(int j, int k, bool at_time2) const { return At(j, at_time2) == At(k, at_time2); }

 private:
  const std::vector<Match>& matches_;
  const std::vector<int64_t>& landmark_;
};

// Sets of matches with the same point at one of the times, as chains from match to match.
class SamePoints {
 public:
  SamePoints(const ImagePoints& points, bool at_time2);

  // The first match of each set of at least two.
  const std::vector<int>& firsts() const { return firsts_; }
  // The match of the set after k, -1 at the end. Ascending.
  int Next(int k) const { return next_[k]; }

 private:
  std::vector<int> next_, last_, firsts_;
};

// Sets of numbers below n, each at first alone. The least of a set stands for it.
class DisjointSets {
 public:
  explicit DisjointSets(int n);
  int LeastOf(int k);
  void Join(int a, int b);

 private:
  std::vector<int> link_;  // to a lesser number of the set
};

// The positions of the matches with mask[k] != 0 in sets: two matches that share a point are in one
// set, so matches of different sets share none. Most sets have one match. Sets are in the order of
// their first match, and so are the matches in each.
std::vector<std::vector<int>> LinkedMatches(const ImagePoints& points,
                                            const std::vector<char>& mask);

}  // namespace rigel

#endif  // RIGEL_CORE_LINKED_MATCHES_H_
