// Tracks of key points, and the landmarks of a frame pair.
#include "rigel/problems/images/landmark_tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

using testing::ElementsAre;

// A point of an image is told by its u.
Match Of(int camera1, double u1, int camera2, double u2, double score = 0.5) {
  return {camera1, {u1, 0}, camera2, {u2, 0}, score};
}

TEST(TrackBuilder, ATrackHasOnePointInAnImage) {
  TrackBuilder tracks;
  const int a = tracks.Point(0, 0, {1, 0}), b = tracks.Point(1, 0, {2, 0});
  const int c = tracks.Point(1, 1, {3, 0}), d = tracks.Point(0, 0, {4, 0});
  EXPECT_EQ(tracks.Point(0, 0, {1, 0}), a);
  EXPECT_TRUE(tracks.Join(a, b));
  EXPECT_TRUE(tracks.Join(c, b));
  EXPECT_TRUE(tracks.Join(a, c));
  EXPECT_FALSE(tracks.Join(d, c));
  EXPECT_EQ(tracks.Track(c), a);
  EXPECT_EQ(tracks.Track(d), d);
  // d is alone: no landmark.
  const std::vector<Observation> rows = tracks.Observations();
  ASSERT_EQ(rows.size(), 3u);
  for (const Observation& row : rows) EXPECT_EQ(row.landmark, 0);
  EXPECT_EQ(rows[1].pixel, Pixel(2, 0));
  EXPECT_EQ(rows[2].camera, 1);
}

TEST(LandmarkNumbers, MatchesOfOnePointHaveOneNumber) {
  // Point 1 in both cameras at both times, point 2 in camera 0 only.
  EXPECT_THAT(LandmarkNumbers(
                  {Of(0, 10, 0, 11), Of(0, 20, 0, 21), Of(0, 10, 1, 12), Of(1, 13, 1, 12)}, {}, {}),
              ElementsAre(0, 1, 0, 0));
}

TEST(LandmarkNumbers, ImagesOfOneTimeJoinWhatNoMatchOfTwoTimesDoes) {
  const std::vector<Match> matches = {Of(0, 10, 0, 11), Of(1, 12, 1, 13)};
  EXPECT_THAT(LandmarkNumbers(matches, {}, {}), ElementsAre(0, 1));
  EXPECT_THAT(LandmarkNumbers(matches, {Of(0, 10, 1, 12)}, {}), ElementsAre(0, 0));
  EXPECT_THAT(LandmarkNumbers(matches, {}, {Of(0, 11, 1, 13)}), ElementsAre(0, 0));
}

TEST(LandmarkNumbers, AMatchThatContradictsBetterOnesIsAlone) {
  // The third would give landmark 0 the points 11 and 21 of one image; its score does not help
  // it against matches of a camera with itself.
  EXPECT_THAT(LandmarkNumbers({Of(0, 10, 0, 11), Of(0, 20, 0, 21), Of(0, 10, 1, 30, 0.1),
                               Of(1, 31, 1, 30), Of(1, 31, 0, 21, 0.2)},
                              {}, {}),
              ElementsAre(0, 1, 0, 0, 2));
}

TEST(AddPairToTracks, TracksGoOnFromPairToPair) {
  TrackBuilder tracks;
  FramePair pair;
  pair.matches = {Of(0, 10, 0, 11), Of(1, 20, 1, 21), Of(0, 50, 0, 51)};
  pair.columns.landmark = {7, 7, 8};
  AddPairToTracks(pair, 4, 5, &tracks);
  tracks.Forget(4);
  pair.matches = {Of(0, 11, 0, 12)};
  pair.columns.landmark.clear();
  AddPairToTracks(pair, 5, 6, &tracks);
  std::vector<std::string> rows;
  for (const Observation& o : tracks.Observations()) {
    rows.push_back(std::to_string(o.landmark) + " " + std::to_string(o.frame) + " " +
                   std::to_string(o.camera) + " " + std::to_string(static_cast<int>(o.pixel.x())));
  }
  EXPECT_THAT(rows, ElementsAre("0 4 0 10", "0 4 1 20", "0 5 0 11", "0 5 1 21", "0 6 0 12",
                                "1 4 0 50", "1 5 0 51"));
}

}  // namespace
}  // namespace rigel
