// The writer of match files: exact round trips, and nothing lost where writing fails.
#include "rigel/problems/io/match_file.h"

#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

TEST(WriteMatchFile, ByItsNameCompressed) {
  const TempDir dir;
  const FramePair pair = MustParse(kValid);
  FramePair read;
  std::string error;
  ASSERT_TRUE(WriteMatchFile(dir / "a.matches.gz", pair, &error)) << error;
  ASSERT_TRUE(ReadMatchFile(dir / "a.matches.gz", &read, &error)) << error;
  ExpectSame(read, pair);
  std::ifstream file(dir / "a.matches.gz", std::ios::binary);
  EXPECT_EQ(file.get(), 0x1f);
  EXPECT_EQ(file.get(), 0x8b);
}

TEST(MatchFile, NearlyAllDoublesSurviveWritingAndReading) {
  double worst_rotation = 0, worst_sigma = 0;
  for (uint64_t seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    FramePair pair = RandomPair(seed);
    const FramePair read = MustParse(FormatMatches(pair));
    // A sigma that never was a number of degrees may move by one unit in the last place.
    for (auto sigma :
         {&MotionPrior::gravity_sigma, &MotionPrior::axis_sigma, &MotionPrior::normal_sigma}) {
      std::optional<double>& original = pair.prior.*sigma;
      ASSERT_TRUE((read.prior.*sigma).has_value());
      const double now = *(read.prior.*sigma);
      worst_sigma = std::max(worst_sigma, std::abs(now / *original - 1));
      original = now;
    }
    worst_rotation =
        std::max(worst_rotation, (pair.truth->R - read.truth->R).cwiseAbs().maxCoeff());
    ExpectSame(read, pair);
    // From a file to a file nothing moves.
    ExpectSame(MustParse(FormatMatches(read)), read);
  }
  EXPECT_LT(worst_sigma, 2.3e-16);
  EXPECT_LT(worst_rotation, 1.5e-15);
}

TEST(MatchFile, ExtremeDoublesSurvive) {
  FramePair pair = MustParse(kValid);
  using Limits = std::numeric_limits<double>;
  Match& m = pair.matches[0];
  m.pixel1 = {Limits::max(), Limits::lowest()};
  m.pixel2 = {Limits::denorm_min(), -0.0};
  m.score = Limits::min();
  const FramePair read = MustParse(FormatMatches(pair));
  ExpectSame(read, pair);
  EXPECT_TRUE(std::signbit(read.matches[0].pixel2.y()));
}

TEST(MatchFile, WritesNumbersAsPeopleDo) {
  // Sorted as the writer sorts, this text must come back byte for byte: degrees that people
  // write (0.1, 0.7) are no other degrees after the way through radians.
  for (const char* degrees : {"0.1", "0.3", "0.7", "10", "100", "0.95", "1", "1.1", "1.9", "3.7",
                              "5", "15.1", "17.3", "29.3", "0.001", "1e-09"}) {
    SCOPED_TRACE(degrees);
    std::string text = std::string("format rigmatch 1\n") +
                       "camera 0 pinhole 400 400 320 240 640 480 1 0 0 0 -0.5 0 0\n" +
                       "time 0.1 0.2\ntruth 1 0 0 0 0 0 1\ngravity1 0 1 0\ngravity2 0 1 0\n" +
                       "gravity_sigma_deg " + degrees + "\naxis 0 1 0\naxis_sigma_deg " + degrees +
                       "\nnormal 0 1 0\nnormal_sigma_deg " + degrees +
                       "\ndistance 1 0.1\nnoise_px 0.5\nsequence a\nmatches 1\n" +
                       "0 0.1 0.2 0 0.3 1e+22 0.7\n";
    EXPECT_EQ(FormatMatches(MustParse(text)), text);
  }
}

TEST(MatchFile, WritesAndReadsAFile) {
  const TempDir dir;
  const std::string path = dir / "a.matches";
  FramePair pair = MustParse(kValid), read;
  std::string error;
  ASSERT_TRUE(WriteMatchFile(path, pair, &error)) << error;
  ASSERT_TRUE(ReadMatchFile(path, &read, &error)) << error;
  EXPECT_EQ(read.name, path);
  ExpectSame(read, pair);
  EXPECT_EQ(ReadText(path), FormatMatches(pair));

  // A second write takes the place of the first and leaves nothing else behind.
  pair.noise_px.reset();
  ASSERT_TRUE(WriteMatchFile(path, pair, &error)) << error;
  EXPECT_EQ(ReadText(path), FormatMatches(pair));
  EXPECT_EQ(dir.Names(), std::vector<std::string>{"a.matches"});
}

TEST(MatchFile, LargeFileSurvives) {
  const TempDir dir;
  FramePair pair = RandomPair(1), read;
  while (pair.matches.size() < 100000) {
    const std::vector<Match> copy = pair.matches;
    pair.matches.insert(pair.matches.end(), copy.begin(), copy.end());
  }
  pair.prior = {};
  std::string error;
  ASSERT_TRUE(WriteMatchFile(dir / "a.matches", pair, &error)) << error;
  ASSERT_TRUE(ReadMatchFile(dir / "a.matches", &read, &error)) << error;
  ExpectSame(read, pair);
}

TEST(MatchFile, FailedWritesLeaveTheOldFile) {
  const TempDir dir;
  const std::string path = dir / "a.matches";
  const FramePair pair = MustParse(kValid);
  std::string error;
  ASSERT_TRUE(WriteMatchFile(path, pair, &error)) << error;
  const std::string old = ReadText(path);

  EXPECT_FALSE(WriteMatchFile(dir / "none/a.matches", pair, &error));
  EXPECT_NE(error.find("none/a.matches: cannot be written: "), std::string::npos) << error;
  EXPECT_NE(error.find("/none does not exist"), std::string::npos) << error;
  EXPECT_EQ(error.find("temporary"), std::string::npos) << error;
  fs::create_directory(dir / "folder");
  EXPECT_FALSE(WriteMatchFile(dir / "folder", pair, &error));
  EXPECT_NE(error.find("is a directory"), std::string::npos) << error;
  fs::remove(dir / "folder");

  // A device that takes 300 bytes stands for a full disk: a short text fails when the buffer is
  // flushed at closing, a long one while it is written.
  FramePair large = pair;
  large.matches.resize(100000);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit, small;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  small = limit;
  small.rlim_cur = 300;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string short_error, long_error;
  const bool short_written = WriteMatchFile(path, pair, &short_error);
  const bool long_written = WriteMatchFile(path, large, &long_error);
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_GT(old.size(), 300u);
  EXPECT_FALSE(short_written);
  EXPECT_FALSE(long_written);
  for (const std::string& message : {short_error, long_error}) {
    EXPECT_EQ(message.rfind(path + ": cannot be written: ", 0), 0u) << message;
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  }
  EXPECT_EQ(ReadText(path), old);
  EXPECT_EQ(dir.Names(), std::vector<std::string>{"a.matches"});
}

TEST(MatchFile, WhatCannotBeReadBackIsNotWritten) {
  const TempDir dir;
  const std::string path = dir / "a.matches";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    const char* phrase;
    void (*spoil)(FramePair*, double);
  } cases[] = {
      {"V2 is 'nan'", [](FramePair* p, double x) { p->matches[1].pixel2.y() = x; }},
      {"SCORE is 'nan'", [](FramePair* p, double x) { p->matches[1].score = x; }},
      {"declared camera", [](FramePair* p, double) { p->matches[1].camera1 = 2; }},
      {"WIDTH is '0'", [](FramePair* p, double) { p->rig.cameras[1].intrinsics.width = 0; }},
      {"QW is 'nan'", [](FramePair* p, double x) { p->truth->R(0, 0) = x; }},
      {"direction has norm 2", [](FramePair* p, double) { *p->prior.axis *= 2; }},
      {"S is", [](FramePair* p, double) { p->prior.axis_sigma = 0; }},
      {"S is", [](FramePair* p, double x) { p->prior.axis_sigma = x; }},
      {"SIGMA is '0'", [](FramePair* p, double) { p->prior.distance_sigma = 0; }},
      {"POS_M is '0'", [](FramePair* p, double) { p->rig.cameras[1].rotation_sigma = 0.1; }},
      {"DT is 'nan'", [](FramePair* p, double x) { p->rig.cameras[1].time_offset = x; }},
      {"no 'camera'", [](FramePair* p, double) { p->rig.cameras.clear(); }},
      {"one time", [](FramePair* p, double) { p->time2.reset(); }},
      {"T1 is 'nan'", [](FramePair* p, double x) { p->time1 = x; }},
      {"sequence", [](FramePair* p, double) { p->sequence = "a b"; }},
      {"without blanks", [](FramePair* p, double) { p->sequence = "a\n# b"; }},
      {"1 column", [](FramePair* p, double) { p->sequence = " "; }},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.phrase);
    FramePair pair = MustParse(kValid);
    c.spoil(&pair, nan);
    std::string error;
    EXPECT_FALSE(WriteMatchFile(path, pair, &error));
    EXPECT_EQ(error.rfind(path + ": not written, ", 0), 0u) << error;
    EXPECT_NE(error.find(c.phrase), std::string::npos) << error;
    EXPECT_TRUE(IsOnePrintableLine(error)) << error;
  }
  EXPECT_TRUE(dir.Names().empty());
}

}  // namespace
}  // namespace rigel
