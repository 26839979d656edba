// Matches whose errors are not independent: they have a key point in common.
#ifndef RIGEL_CORE_LINKED_MATCHES_H_
#define RIGEL_CORE_LINKED_MATCHES_H_

#include <vector>

#include "rigel/core/match.h"

namespace rigel {

// A point of an image. Equal to the last bit.
struct ImagePoint {
  int camera;
  double u, v;

  bool operator==(const ImagePoint& other) const {
    return camera == other.camera && u == other.u && v == other.v;
  }
};
ImagePoint ImagePointOf(const Match& match, bool at_time2);

// Sets of matches with the same point at one of the times, as chains from match to match.
class SamePoints {
 public:
  SamePoints(const std::vector<Match>& matches, bool at_time2);

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

// True if `a` and `b` are of one key point at time 1, or at time 2: the same pixel of the same
// camera, to the last bit.
bool SharePixel1(const Match& a, const Match& b);
bool SharePixel2(const Match& a, const Match& b);

// The positions of the matches with mask[k] != 0 in sets: two matches that share a pixel are in one
// set, so matches of different sets share none. Most sets have one match. Sets are in the order of
// their first match, and so are the matches in each.
std::vector<std::vector<int>> LinkedMatches(const std::vector<Match>& matches,
                                            const std::vector<char>& mask);

}  // namespace rigel

#endif  // RIGEL_CORE_LINKED_MATCHES_H_
