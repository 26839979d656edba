#include "rigel/refine/search/shared_pixels.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "rigel/core/linked_matches.h"

namespace rigel {
namespace {

// Among the matches of one point: repeats name the first of their kind, and if more than
// kMaxPartners different partners are in one image, those count for nothing.
class PartnerJudge {
 public:
  PartnerJudge(const ImagePoints& points, bool at_time2) : points_(points), at_time2_(at_time2) {}

  void Judge(const std::vector<int>& rows, std::vector<int>* first_of) {
    partners_.clear();
    bool too_many = false;
    for (const int row : rows) {
      const ImagePoint point = points_.At(row, !at_time2_);
      const auto same = std::find_if(partners_.begin(), partners_.end(),
                                     [&](const Partner& other) { return other.point == point; });
      if (same != partners_.end()) {
        (*first_of)[row] = (*first_of)[same->row];
      } else if (NumIn(point.camera) <= kMaxPartners) {  // not counted further than it matters
        partners_.push_back({point, row});
        too_many = too_many || NumIn(point.camera) > kMaxPartners;
      }
    }
    if (!too_many) return;
    for (const int row : rows) {
      if (NumIn(points_.At(row, !at_time2_).camera) > kMaxPartners) {
        (*first_of)[row] = -1;
      }
    }
  }

 private:
  struct Partner {
    ImagePoint point;
    int row;
  };
  long NumIn(int camera) const {
    return std::count_if(partners_.begin(), partners_.end(),
                         [camera](const Partner& p) { return p.point.camera == camera; });
  }

  const ImagePoints& points_;
  const bool at_time2_;
  std::vector<Partner> partners_;  // the different ones
};

}  // namespace

std::vector<size_t> DistinctMatches(const ImagePoints& points, std::vector<int>* first_of) {
  first_of->resize(points.size());
  std::iota(first_of->begin(), first_of->end(), 0);
  std::vector<int> rows_of_point;
  for (const bool at_time2 : {false, true}) {
    const SamePoints same(points, at_time2);
    PartnerJudge judge(points, at_time2);
    for (const int first : same.firsts()) {
      rows_of_point.clear();
      for (int k = first; k >= 0; k = same.Next(k)) rows_of_point.push_back(k);
      judge.Judge(rows_of_point, first_of);
    }
  }
  std::vector<size_t> rows;
  rows.reserve(points.size());
  for (int k = 0; k < points.size(); ++k) {
    if ((*first_of)[k] == k) rows.push_back(k);
  }
  return rows;
}

DistinctSet KeepDistinct(const std::vector<Match>& matches, const MatchColumns& columns) {
  DistinctSet distinct;
  std::vector<int> first_of;
  const std::vector<size_t> rows =
      DistinctMatches(ImagePoints(matches, columns.landmark), &first_of);
  MatchColumns used;
  used.landmark = columns.landmark;
  used.sigma1 = columns.sigma1;
  used.sigma2 = columns.sigma2;
  distinct.columns = used.Subset(rows);
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
    const SamePoints same(ImagePoints(matches.matches(), matches.landmarks()), at_time2);
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

std::vector<int> LinkedSets(const std::vector<SharedPixel>& shared, int num_matches) {
  DisjointSets linked(num_matches);
  for (const SharedPixel& pair : shared) linked.Join(pair.first, pair.second);
  std::vector<int> first_of(num_matches);
  for (int k = 0; k < num_matches; ++k) first_of[k] = linked.LeastOf(k);
  return first_of;
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
  if (shared.empty()) return num_matches;
  // Of k matches of one point k - 1 follow another.
  int following[2] = {0, 0};
  int last = 0;
  for (const SharedPixel& pair : shared) last = std::max(last, pair.second);
  std::vector<char> seen[2];
  for (std::vector<char>& at : seen) at.resize(last + 1, 0);
  for (const SharedPixel& pair : shared) {
    char& at = seen[pair.at_time2 ? 1 : 0][pair.second];
    following[pair.at_time2 ? 1 : 0] += at ? 0 : 1;
    at = 1;
  }
  return num_matches - std::max(following[0], following[1]);
}

}  // namespace rigel
