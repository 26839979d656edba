#include "rigel/refine/search/shared_pixels.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>

#include "rigel/core/linked_matches.h"

namespace rigel {
namespace {

// Among the matches of one point: repeats name the first of their kind, and if more than
// kMaxPartners different partners are in one image, those count for nothing.
void JudgePartners(const std::vector<Match>& matches, const std::vector<int>& rows, bool at_time2,
                   std::vector<int>* first_of) {
  std::vector<int> different;
  std::map<int, int> partners;  // by camera; not counted further than it matters
  for (const int row : rows) {
    const ImagePoint partner = ImagePointOf(matches[row], !at_time2);
    int& in_image = partners[partner.camera];
    if (in_image > kMaxPartners) continue;
    const auto same = std::find_if(different.begin(), different.end(), [&](int other) {
      return ImagePointOf(matches[other], !at_time2) == partner;
    });
    if (same == different.end()) {
      different.push_back(row);
      ++in_image;
    } else {
      (*first_of)[row] = (*first_of)[*same];
    }
  }
  for (const int row : rows) {
    if (partners[ImagePointOf(matches[row], !at_time2).camera] > kMaxPartners)
      (*first_of)[row] = -1;
  }
}

}  // namespace

std::vector<size_t> DistinctMatches(const std::vector<Match>& matches, std::vector<int>* first_of) {
  first_of->resize(matches.size());
  std::iota(first_of->begin(), first_of->end(), 0);
  std::vector<int> rows_of_point;
  for (const bool at_time2 : {false, true}) {
    const SamePoints same(matches, at_time2);
    for (const int first : same.firsts()) {
      rows_of_point.clear();
      for (int k = first; k >= 0; k = same.Next(k)) rows_of_point.push_back(k);
      JudgePartners(matches, rows_of_point, at_time2, first_of);
    }
  }
  std::vector<size_t> rows;
  rows.reserve(matches.size());
  for (size_t k = 0; k < matches.size(); ++k) {
    if ((*first_of)[k] == static_cast<int>(k)) rows.push_back(k);
  }
  return rows;
}

DistinctSet KeepDistinct(const std::vector<Match>& matches) {
  DistinctSet distinct;
  std::vector<int> first_of;
  const std::vector<size_t> rows = DistinctMatches(matches, &first_of);
  distinct.position.assign(matches.size(), -1);
  distinct.matches.reserve(rows.size());
  for (const size_t row : rows) {
    distinct.position[row] = static_cast<int>(distinct.matches.size());
    distinct.matches.push_back(matches[row]);
  }
  for (size_t k = 0; k < matches.size(); ++k) {
    if (first_of[k] >= 0) distinct.position[k] = distinct.position[first_of[k]];
  }
  return distinct;
}

std::vector<char> DistinctSet::OfAll(const std::vector<char>& of_distinct) const {
  std::vector<char> flags(position.size(), 0);
  for (size_t k = 0; k < position.size(); ++k) {
    if (position[k] >= 0) flags[k] = of_distinct[position[k]];
  }
  return flags;
}

std::vector<SharedPixel> FindSharedPixels(const GroupedMatches& matches) {
  std::vector<SharedPixel> shared;
  for (const bool at_time2 : {false, true}) {
    const SamePoints same(matches.matches(), at_time2);
    for (const int first : same.firsts()) {
      for (int j = first; j >= 0; j = same.Next(j)) {
        int linked = 0;
        for (int k = same.Next(j); k >= 0 && linked < kMaxLinked; k = same.Next(k), ++linked) {
          shared.push_back({j, k, at_time2});
        }
      }
    }
  }
  return shared;
}

std::vector<SharedPixel> SharedWithin(const std::vector<SharedPixel>& shared,
                                      const std::vector<char>& mask) {
  std::vector<SharedPixel> within;
  std::copy_if(shared.begin(), shared.end(), std::back_inserter(within),
               [&](const SharedPixel& pair) { return mask[pair.first] && mask[pair.second]; });
  return within;
}

int ResolveCompetition(const GroupedMatches& matches, const std::vector<SharedPixel>& shared,
                       const std::vector<double>& squared_errors, std::vector<char>* inliers) {
  int cleared = 0;
  for (const SharedPixel& pair : shared) {
    const Match& a = matches.matches()[pair.first];
    const Match& b = matches.matches()[pair.second];
    const bool one_image = pair.at_time2 ? a.camera1 == b.camera1 : a.camera2 == b.camera2;
    if (!one_image || !(*inliers)[pair.first] || !(*inliers)[pair.second]) continue;
    const bool first_is_worse = squared_errors[pair.first] > squared_errors[pair.second];
    (*inliers)[first_is_worse ? pair.first : pair.second] = 0;
    ++cleared;
  }
  return cleared;
}

int CountDistinctPixels(int num_matches, const std::vector<SharedPixel>& shared) {
  // Of k matches of one point k - 1 follow another.
  int following[2] = {0, 0};
  std::vector<char> seen[2];
  for (const SharedPixel& pair : shared) {
    std::vector<char>& at = seen[pair.at_time2 ? 1 : 0];
    if (at.size() <= static_cast<size_t>(pair.second)) at.resize(pair.second + 1, 0);
    following[pair.at_time2 ? 1 : 0] += at[pair.second] ? 0 : 1;
    at[pair.second] = 1;
  }
  return num_matches - std::max(following[0], following[1]);
}

}  // namespace rigel
