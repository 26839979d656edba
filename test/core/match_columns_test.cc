#include "rigel/core/match_columns.h"

#include <limits>

#include <gtest/gtest.h>

#include "rigel/core/frame_pair.h"

namespace rigel {
namespace {

TEST(MatchColumns, EmptyOnesAreValid) {
  std::string error;
  EXPECT_TRUE(MatchColumns().IsValid(3, &error)) << error;
}

TEST(MatchColumns, EntriesOutOfRangeAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::string error;
  MatchColumns columns;
  columns.sigma1 = {1.0, 0.0};
  EXPECT_FALSE(columns.IsValid(2, &error));
  EXPECT_EQ(error, "match 1: sigma1 must be positive and finite");
  EXPECT_FALSE(columns.IsValid(3, &error));
  EXPECT_EQ(error, "column sigma1 has 2 entries for 3 matches");
  columns = MatchColumns();
  columns.depth1 = {0.0, -1.0};
  EXPECT_FALSE(columns.IsValid(2, &error));
  columns = MatchColumns();
  columns.affine = {{0, 0, 0, 0}, {1, 0, 0, -1}};
  EXPECT_FALSE(columns.IsValid(2, &error));
  columns.affine[1] = {1, 0, 0, 1};
  EXPECT_TRUE(columns.IsValid(2, &error)) << error;
  columns.exact = {{0, 0, 0, 0}, {0, nan, 0, 0}};
  EXPECT_FALSE(columns.IsValid(2, &error));
  columns.exact.clear();
  columns.inlier = {1, 2};
  EXPECT_FALSE(columns.IsValid(2, &error));
}

TEST(MatchColumns, ASubsetKeepsTheRows) {
  MatchColumns columns;
  columns.landmark = {7, 8, 9};
  columns.sigma2 = {1, 2, 3};
  const MatchColumns subset = columns.Subset({2, 0});
  EXPECT_EQ(subset.landmark, (std::vector<int64_t>{9, 7}));
  EXPECT_EQ(subset.sigma2, (std::vector<double>{3, 1}));
  EXPECT_TRUE(subset.exact.empty());
}

TEST(MatchColumns, APairWithColumnsOfAnotherSizeIsInvalid) {
  FramePair pair;
  pair.rig.cameras.resize(1);
  pair.matches.resize(2);
  std::string error;
  ASSERT_TRUE(pair.IsValid(&error)) << error;
  pair.columns.landmark = {1};
  EXPECT_FALSE(pair.IsValid(&error));
  EXPECT_EQ(error, "column landmark has 1 entries for 2 matches");
}

}  // namespace
}  // namespace rigel
