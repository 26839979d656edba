// Matches that share a pixel, directly or by way of others, are one set.
#include "rigel/core/linked_matches.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Match MatchOf(int camera1, double u1, int camera2, double u2) {
  Match m;
  m.camera1 = camera1;
  m.pixel1 = {u1, 7};
  m.camera2 = camera2;
  m.pixel2 = {u2, 7};
  return m;
}

TEST(LinkedMatches, SetsOfSharedPixels) {
  const std::vector<Match> matches = {
      MatchOf(0, 1, 0, 1),  // 0: with 3 at time 1, by it with 5
      MatchOf(0, 2, 0, 2),  // 1: alone
      MatchOf(1, 1, 1, 3),  // 2: the pixel of 0, but of another camera; alone
      MatchOf(0, 1, 1, 4),  // 3
      MatchOf(0, 4, 1, 5),  // 4: repeated as 6
      MatchOf(1, 9, 1, 4),  // 5
      MatchOf(0, 4, 1, 5),  // 6
  };
  const std::vector<int64_t> unknown;
  const ImagePoints points(matches, unknown);
  EXPECT_THAT(LinkedMatches(points, std::vector<char>(7, 1)),
              ElementsAre(ElementsAre(0, 3, 5), ElementsAre(1), ElementsAre(2), ElementsAre(4, 6)));
  EXPECT_TRUE(points.Share(0, 3, false));
  EXPECT_FALSE(points.Share(0, 3, true));
  EXPECT_TRUE(points.Share(3, 5, true));
  // Matches that are left out link none.
  EXPECT_THAT(LinkedMatches(points, {1, 0, 0, 0, 1, 1, 1}),
              ElementsAre(ElementsAre(0), ElementsAre(4, 6), ElementsAre(5)));
  EXPECT_THAT(LinkedMatches(ImagePoints({}, unknown), {}), IsEmpty());
  // Landmarks decide where they are known: 1 and 2 see one point, but with different cameras.
  const std::vector<int64_t> landmark = {1, 2, 2, 4, 5, 6, 7};
  EXPECT_THAT(LinkedMatches(ImagePoints(matches, landmark), std::vector<char>(7, 1)),
              ElementsAre(ElementsAre(0), ElementsAre(1), ElementsAre(2), ElementsAre(3),
                          ElementsAre(4), ElementsAre(5), ElementsAre(6)));
  EXPECT_THAT(LinkedMatches(ImagePoints(matches, {1, 1, 2, 3, 4, 5, 6}), std::vector<char>(7, 1)),
              ElementsAre(ElementsAre(0, 1), ElementsAre(2), ElementsAre(3), ElementsAre(4),
                          ElementsAre(5), ElementsAre(6)));
}

TEST(DisjointSets, TheLeastOfASetStandsForIt) {
  DisjointSets sets(6);
  sets.Join(4, 2);
  sets.Join(5, 4);
  sets.Join(1, 3);
  std::vector<int> least;
  for (int k = 0; k < 6; ++k) least.push_back(sets.LeastOf(k));
  EXPECT_THAT(least, ElementsAre(0, 1, 2, 1, 2, 2));
}

}  // namespace
}  // namespace rigel
