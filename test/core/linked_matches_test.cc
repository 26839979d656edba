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
  EXPECT_THAT(LinkedMatches(matches, std::vector<char>(7, 1)),
              ElementsAre(ElementsAre(0, 3, 5), ElementsAre(1), ElementsAre(2), ElementsAre(4, 6)));
  EXPECT_TRUE(SharePixel1(matches[0], matches[3]));
  EXPECT_FALSE(SharePixel2(matches[0], matches[3]));
  EXPECT_TRUE(SharePixel2(matches[3], matches[5]));
  // Matches that are left out link none.
  EXPECT_THAT(LinkedMatches(matches, {1, 0, 0, 0, 1, 1, 1}),
              ElementsAre(ElementsAre(0), ElementsAre(4, 6), ElementsAre(5)));
  EXPECT_THAT(LinkedMatches({}, {}), IsEmpty());
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
