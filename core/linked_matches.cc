#include "rigel/core/linked_matches.h"

#include <algorithm>
#include <numeric>

namespace rigel {
namespace {

struct KeyPoint {
  int camera;
  double u, v;
  int match;

  bool IsSame(const KeyPoint& other) const {
    return camera == other.camera && u == other.u && v == other.v;
  }
  bool operator<(const KeyPoint& other) const {
    if (camera != other.camera) return camera < other.camera;
    if (u != other.u) return u < other.u;
    return v != other.v ? v < other.v : match < other.match;
  }
};

// The least match of the set of match k; sets are trees of links to a lesser match.
int Root(std::vector<int>* link, int k) {
  while ((*link)[k] != k) k = (*link)[k] = (*link)[(*link)[k]];
  return k;
}

void LinkSame(std::vector<KeyPoint> points, std::vector<int>* link) {
  std::sort(points.begin(), points.end());
  for (size_t i = 1; i < points.size(); ++i) {
    if (!points[i].IsSame(points[i - 1])) continue;
    const int a = Root(link, points[i - 1].match);
    const int b = Root(link, points[i].match);
    (*link)[std::max(a, b)] = std::min(a, b);
  }
}

}  // namespace

bool SharePixel1(const Match& a, const Match& b) {
  return a.camera1 == b.camera1 && a.pixel1 == b.pixel1;
}

bool SharePixel2(const Match& a, const Match& b) {
  return a.camera2 == b.camera2 && a.pixel2 == b.pixel2;
}

std::vector<std::vector<int>> LinkedMatches(const std::vector<Match>& matches,
                                            const std::vector<char>& mask) {
  std::vector<KeyPoint> points1, points2;
  for (size_t k = 0; k < matches.size(); ++k) {
    if (!mask[k]) continue;
    const Match& m = matches[k];
    points1.push_back({m.camera1, m.pixel1.x(), m.pixel1.y(), static_cast<int>(k)});
    points2.push_back({m.camera2, m.pixel2.x(), m.pixel2.y(), static_cast<int>(k)});
  }
  std::vector<int> link(matches.size());
  std::iota(link.begin(), link.end(), 0);
  LinkSame(std::move(points1), &link);
  LinkSame(std::move(points2), &link);
  std::vector<std::vector<int>> sets;
  std::vector<size_t> set_of(matches.size());
  for (size_t k = 0; k < matches.size(); ++k) {
    if (!mask[k]) continue;
    const int root = Root(&link, static_cast<int>(k));
    if (root == static_cast<int>(k)) {
      set_of[k] = sets.size();
      sets.emplace_back();
    }
    sets[set_of[root]].push_back(static_cast<int>(k));
  }
  return sets;
}

}  // namespace rigel
