// Matches that share an image point: they are no independent evidence.
//
// Trackers list lost tracks as (0, 0), matchers repeat rows, and a point that is seen by two
// cameras stands in several rows.
#ifndef RIGEL_REFINE_SEARCH_SHARED_PIXELS_H_
#define RIGEL_REFINE_SEARCH_SHARED_PIXELS_H_

#include <cstddef>
#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/linked_matches.h"
#include "rigel/core/match.h"
#include "rigel/core/match_columns.h"

namespace rigel {

// A point of a landmark has one partner in another image, and errors of matchers make two or three.
// One with more is no point of a landmark but a mark such as (0, 0).
inline constexpr int kMaxPartners = 3;

// The matches that count, in order: without exact repeats of an earlier one, and without those of a
// point that has more than kMaxPartners partners in one image. `first_of[k]` is the position of the
// first match that is the same as match k, -1 if k does not count for its partners.
std::vector<size_t> DistinctMatches(const ImagePoints& points, std::vector<int>* first_of);

// Those matches, and where each of all matches is among them.
struct DistinctSet {
  std::vector<Match> matches;
  MatchColumns columns;       // landmark, sigma1, sigma2 of these
  std::vector<int> position;  // of each of all matches, a repeat that of its first; -1: none

  // Flags of the distinct matches as flags of all: 0 for those that do not count.
  std::vector<char> OfAll(const std::vector<char>& of_distinct) const;
};
// Points are the same by `columns.landmark` where that is known, else by their pixels.
DistinctSet KeepDistinct(const std::vector<Match>& matches, const MatchColumns& columns = {});

// Two matches (grouped order, first < second) with the same point at time 1 or at time 2.
struct SharedPixel {
  int first = 0;
  int second = 0;
  bool at_time2 = false;
};

// All such pairs; of a point with more than kMaxLinked matches, each with the next kMaxLinked
// alone.
inline constexpr int kMaxLinked = 64;
std::vector<SharedPixel> FindSharedPixels(const GroupedMatches& matches);

// Those between matches of the mask.
std::vector<SharedPixel> SharedWithin(const std::vector<SharedPixel>& shared,
                                      const std::vector<char>& mask);

// Sets of matches in which two that share a pixel are in one set: for each of `num_matches` the
// first match of its set.
std::vector<int> LinkedSets(const std::vector<SharedPixel>& shared, int num_matches);

// At most one of two matches of the same point is an inlier if their other points are in the same
// image. Clears that of the larger error. Returns how many were cleared.
int ResolveCompetition(const GroupedMatches& matches, const std::vector<SharedPixel>& shared,
                       const std::vector<double>& squared_errors, std::vector<char>* inliers);

// The number of different points at time 1 or, if there are fewer, at time 2.
int CountDistinctPixels(int num_matches, const std::vector<SharedPixel>& shared);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_SHARED_PIXELS_H_
