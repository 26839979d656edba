#include "rigel/problems/images/landmark_tracks.h"

#include <algorithm>
#include <utility>

namespace rigel {

bool TrackBuilder::Before(int a, int b) const {
  const Place &x = points_[a], &y = points_[b];
  return std::tie(x.frame, x.camera) < std::tie(y.frame, y.camera);
}

int TrackBuilder::Point(int frame, int camera, const Pixel& pixel) {
  const int next = static_cast<int>(points_.size());
  const auto [known, is_new] =
      known_[frame].emplace(std::make_tuple(camera, pixel.x(), pixel.y()), next);
  if (!is_new) return known->second;
  points_.push_back({frame, camera, pixel});
  track_.push_back(next);
  members_.push_back({next});
  return next;
}

int TrackBuilder::Track(int point) const { return track_[point]; }

bool TrackBuilder::Join(int a, int b) {
  int to = track_[a], from = track_[b];
  if (to == from) return true;
  if (to > from) std::swap(to, from);
  std::vector<int> both;
  both.reserve(members_[to].size() + members_[from].size());
  std::merge(members_[to].begin(), members_[to].end(), members_[from].begin(), members_[from].end(),
             std::back_inserter(both), [this](int x, int y) { return Before(x, y); });
  const auto same_image = [this](int x, int y) { return SameImage(x, y); };
  if (std::adjacent_find(both.begin(), both.end(), same_image) != both.end()) return false;
  for (const int point : members_[from]) track_[point] = to;
  members_[from] = {};
  members_[to] = std::move(both);
  return true;
}

std::vector<Observation> TrackBuilder::Observations() const {
  std::vector<Observation> observations;
  int64_t landmark = 0;
  for (const std::vector<int>& members : members_) {
    if (members.size() < 2) continue;
    for (const int point : members) {
      const Place& place = points_[point];
      observations.push_back({landmark, place.frame, place.camera, place.pixel, {}});
    }
    ++landmark;
  }
  return observations;
}

std::vector<int64_t> LandmarkNumbers(const std::vector<Match>& matches,
                                     const std::vector<Match>& same_time1,
                                     const std::vector<Match>& same_time2) {
  struct Link {
    const Match* match;
    int frame1, frame2;
  };
  std::vector<Link> links;
  for (const Match& match : matches) links.push_back({&match, 1, 2});
  for (const Match& match : same_time1) links.push_back({&match, 1, 1});
  for (const Match& match : same_time2) links.push_back({&match, 2, 2});
  std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
    return std::make_pair(!a.match->IsIntra(), a.match->score) <
           std::make_pair(!b.match->IsIntra(), b.match->score);
  });
  TrackBuilder tracks;
  const auto points = [&](const Match& m, int frame1, int frame2) {
    return std::make_pair(tracks.Point(frame1, m.camera1, m.pixel1),
                          tracks.Point(frame2, m.camera2, m.pixel2));
  };
  for (const Link& link : links) {
    const auto [a, b] = points(*link.match, link.frame1, link.frame2);
    tracks.Join(a, b);
  }
  std::map<int, int64_t> numbers;  // of tracks
  std::vector<int64_t> result;
  int64_t next = 0;
  for (const Match& match : matches) {
    const auto [a, b] = points(match, 1, 2);
    if (tracks.Track(a) != tracks.Track(b)) {
      result.push_back(next++);
      continue;
    }
    const auto [known, is_new] = numbers.emplace(tracks.Track(a), next);
    if (is_new) ++next;
    result.push_back(known->second);
  }
  return result;
}

void AddPairToTracks(const FramePair& pair, int frame1, int frame2, TrackBuilder* tracks) {
  std::map<int64_t, int> first;  // a point of each landmark
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    const Match& m = pair.matches[k];
    const int a = tracks->Point(frame1, m.camera1, m.pixel1);
    const int b = tracks->Point(frame2, m.camera2, m.pixel2);
    tracks->Join(a, b);
    if (pair.columns.landmark.empty()) continue;
    const auto [known, is_new] = first.emplace(pair.columns.landmark[k], a);
    if (!is_new) tracks->Join(known->second, a);
  }
}

}  // namespace rigel
