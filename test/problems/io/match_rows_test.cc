// Columns of match files beyond the default ones.
#include "rigel/problems/io/match_rows.h"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

constexpr char kHeader[] =
    "format rigmatch 1\n"
    "camera 0 pinhole 700 701 600 180 1226 370 1 0 0 0 0 0 0\n";

std::string File(const std::string& names, const std::vector<std::string>& rows) {
  std::string text = kHeader + ("columns " + names) + "\nmatches " + std::to_string(rows.size());
  for (const std::string& row : rows) text += "\n" + row;
  return text + "\n";
}

constexpr char kAll[] =
    "i u v j u2 v2 score landmark sigma1 sigma2 depth1 depth_sigma a11 a12 a21 a22 affine_sigma "
    "inlier u0 v0 u20 v20";

FramePair AllColumns() {
  return MustParse(File(kAll, {"0 1 2 0 3 4 0.5 -9223372036854775808 0.25 0.5 7.5 0.01 1 0.1 0.2 2 "
                               "0.05 1 1.5 2.5 3.5 4.5",
                               "0 5 6 0 7 8 0 9223372036854775807 1 2 0 0.02 0 0 0 0 0.1 0 5 6 7 "
                               "8"}));
}

TEST(MatchRows, EveryColumnIsReadAndComesBack) {
  const FramePair pair = AllColumns();
  const MatchColumns& c = pair.columns;
  EXPECT_EQ(c.landmark, (std::vector<int64_t>{std::numeric_limits<int64_t>::min(),
                                              std::numeric_limits<int64_t>::max()}));
  EXPECT_EQ(c.sigma1, (std::vector<double>{0.25, 1}));
  EXPECT_EQ(c.sigma2, (std::vector<double>{0.5, 2}));
  EXPECT_EQ(c.depth1, (std::vector<double>{7.5, 0}));
  EXPECT_EQ(c.depth_sigma, (std::vector<double>{0.01, 0.02}));
  EXPECT_EQ(c.affine, (std::vector<std::array<double, 4>>{{1, 0.1, 0.2, 2}, {0, 0, 0, 0}}));
  EXPECT_EQ(c.affine_sigma, (std::vector<double>{0.05, 0.1}));
  EXPECT_EQ(c.inlier, (std::vector<char>{1, 0}));
  EXPECT_EQ(c.exact, (std::vector<std::array<double, 4>>{{1.5, 2.5, 3.5, 4.5}, {5, 6, 7, 8}}));
  ExpectSame(MustParse(FormatMatches(pair)), pair);
  EXPECT_NE(FormatMatches(pair).find("\ncolumns " + std::string(kAll) + "\nmatches 2\n"),
            std::string::npos);
}

TEST(MatchRows, AnyOrderOfTheNames) {
  const FramePair pair =
      MustParse(File("inlier score v2 u2 j v u i sigma2", {"1 0.5 4 3 0 2 1 0 0.75"}));
  ASSERT_EQ(pair.matches.size(), 1u);
  EXPECT_EQ(pair.matches[0].pixel1, Eigen::Vector2d(1, 2));
  EXPECT_EQ(pair.matches[0].pixel2, Eigen::Vector2d(3, 4));
  EXPECT_EQ(pair.matches[0].score, 0.5);
  EXPECT_EQ(pair.columns.inlier, std::vector<char>{1});
  EXPECT_EQ(pair.columns.sigma2, std::vector<double>{0.75});
  EXPECT_TRUE(pair.columns.sigma1.empty());
}

TEST(MatchRows, TheDefaultMayBeStated) {
  const FramePair pair = MustParse(File("i u v j u2 v2 score", {"0 1 2 0 3 4 5"}));
  EXPECT_EQ(pair.matches[0].score, 5);
  EXPECT_EQ(FormatMatches(pair).find("columns"), std::string::npos);
}

TEST(MatchRows, WhatHasNoColumnsIsWrittenAsBefore) {
  const std::string text = FormatMatches(MustParse(kValid));
  EXPECT_EQ(text.find("columns"), std::string::npos);
}

TEST(MatchRows, BrokenOnesAreRefused) {
  const std::string row = "0 1 2 0 3 4 0";
  const std::string names = "i u v j u2 v2 score";
  const struct {
    std::string names, row;
    int line;
    const char* phrase;
  } cases[] = {
      {names + " colour", row + " 1", 3, "unknown column 'colour', expected names of i u v"},
      {"", row, 3, "no column 'i', expected all of i u v j u2 v2 score"},
      {"i u v j u2 v2", row, 3, "no column 'score', expected all of"},
      {names + " inlier inlier", row + " 1 1", 3,
       "'inlier' for the second time, expected each name once"},
      {names + " u", row + " 1", 3, "column 'u' for the second time"},
      {std::string(kAll) + " inlier", row, 3, "column 'inlier' for the second time"},
      {names + " a11 a12 a21", row + " 1 0 0", 3,
       "3 of the columns a11 a12 a21 a22, expected all four or none"},
      {names + " u0", row + " 1", 3, "1 of the columns u0 v0 u20 v20, expected all four"},
      {names + " inlier", row, 5, "7 columns, expected 8 (i u v j u2 v2 score inlier)"},
      {names + " inlier", row + " 1 1", 5, "9 columns, expected 8"},
      {names + " inlier", row + " 2", 5, "inlier is '2', expected 1 or 0"},
      {names + " inlier", row + " 1.0", 5, "inlier is '1.0', expected 1 or 0"},
      {names + " sigma1", row + " 0", 5, "sigma1 is '0', expected a positive number"},
      {names + " sigma2", row + " -1", 5, "sigma2 is '-1', expected a positive number"},
      {names + " depth1", row + " -1", 5, "depth1 is '-1', expected a number >= 0"},
      {names + " depth_sigma", row + " 0", 5, "depth_sigma is '0', expected a positive"},
      {names + " affine_sigma", row + " 0", 5, "affine_sigma is '0', expected a positive"},
      {names + " landmark", row + " 1.5", 5, "landmark is '1.5', expected an integer"},
      {names + " landmark", row + " 9223372036854775808", 5, "expected an integer of 64 bits"},
      {names + " u0 v0 u20 v20", row + " 1 2 3 nan", 5, "v20 is 'nan', expected a finite number"},
      {names + " a11 a12 a21 a22", row + " 1 2 2 1", 5,
       "a11 a12 a21 a22 have a determinant that is not positive, expected a positive one"},
      {"j u v i u2 v2 score", "1 1 2 0 3 4 0", 5, "j is '1', expected a declared camera (0 to 0)"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.phrase);
    FramePair pair;
    std::string error;
    EXPECT_FALSE(ParseMatches(File(c.names, {c.row}), "x.matches", &pair, &error));
    EXPECT_EQ(error.rfind("x.matches:" + std::to_string(c.line) + ": ", 0), 0u) << error;
    EXPECT_NE(error.find(c.phrase), std::string::npos) << error;
    EXPECT_TRUE(IsOnePrintableLine(error)) << error;
    EXPECT_TRUE(pair.matches.empty());
  }
}

TEST(MatchRows, TheNamesStandBeforeTheRowsAndOnce) {
  FramePair pair;
  std::string error;
  const std::string line = "columns i u v j u2 v2 score\n";
  EXPECT_FALSE(ParseMatches(kHeader + line + line + "matches 0\n", "x", &pair, &error));
  EXPECT_EQ(error, "x:4: 'columns' for the second time, expected once (line 3)");
  EXPECT_FALSE(ParseMatches(kHeader + ("matches 0\n" + line), "x", &pair, &error));
  EXPECT_EQ(error, "x:4: 'columns' after 'matches', expected header lines before it");
}

TEST(MatchRows, WhatCannotBeReadBackIsNotWritten) {
  const TempDir dir;
  FramePair pair = AllColumns();
  pair.columns.sigma1 = {1};
  std::string error;
  EXPECT_FALSE(WriteMatchFile(dir / "a.matches", pair, &error));
  EXPECT_NE(error.find("column sigma1 has 1 entries for 2 matches"), std::string::npos) << error;
  EXPECT_EQ(FormatMatches(pair).find("sigma1"), std::string::npos);
  pair = AllColumns();
  pair.columns.inlier[1] = 2;
  EXPECT_FALSE(WriteMatchFile(dir / "a.matches", pair, &error));
  EXPECT_NE(error.find("inlier is '2', expected 1 or 0"), std::string::npos) << error;
  EXPECT_TRUE(dir.Names().empty());
  ASSERT_TRUE(WriteMatchFile(dir / "a.matches", AllColumns(), &error)) << error;
}

}  // namespace
}  // namespace rigel
