// Track files: what is read and written, and how broken ones are refused.
#include "rigel/problems/io/track_file.h"

#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

using testing::HasSubstr;

constexpr char kTracks[] =
    "# a comment\n"                                                              // 1
    "format rigtracks 1\n"                                                       // 2
    "camera 0 pinhole 700 701 600 180 1226 370 1 0 0 0 0 0 0\n"                  // 3
    "camera 1 simple_radial 700 600 180 0.01 1226 370 0.6 0.8 0 0 0.5 -0.1 2\n"  // 4
    "camera_sigma 1 0.5 0.02\n"                                                  // 5
    "camera_time 1 0.05\n"                                                       // 6
    "truth 3 0.8 0 -0.6 0 0.25 -0.5 1.25\n"                                      // 7
    "frame 3 1.5\n"                                                              // 8
    "frame 1\n"                                                                  // 9
    "gravity 1 0 0.6 0.8\n"                                                      // 10
    "gravity_sigma_deg 0.5\n"                                                    // 11
    "distance 1 3 1.5 0.125\n"                                                   // 12
    "noise_px 0.75\n"                                                            // 13
    "sequence loop-06\n"                                                         // 14
    "observations 3\n"                                                           // 15
    "-7 1 0 34.25 103.5\n"                                                       // 16
    "-7 3 0 -4.5 1e2\n"                                                          // 17
    "9 3 1 7 8\n";                                                               // 18

Tracks MustRead(const std::string& text) {
  Tracks tracks;
  std::string error;
  EXPECT_TRUE(ParseTracks(text, "x.tracks", &tracks, &error)) << error;
  return tracks;
}

void ExpectSame(const Tracks& a, const Tracks& b) {
  EXPECT_EQ(a.sequence, b.sequence);
  ASSERT_EQ(a.rig.size(), b.rig.size());
  for (int k = 0; k < a.rig.size(); ++k) {
    const RigCamera &x = a.rig.cameras[k], &y = b.rig.cameras[k];
    EXPECT_TRUE(SameLens(x.intrinsics, y.intrinsics));
    EXPECT_TRUE(x.Q.isApprox(y.Q, 1e-14));
    EXPECT_EQ(x.rotation_sigma, y.rotation_sigma);
    EXPECT_EQ(x.time_offset, y.time_offset);
  }
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (size_t k = 0; k < a.frames.size(); ++k) {
    const TrackFrame &x = a.frames[k], &y = b.frames[k];
    EXPECT_EQ(x.number, y.number);
    EXPECT_EQ(x.time, y.time);
    ASSERT_EQ(x.world_from_body.has_value(), y.world_from_body.has_value());
    if (x.world_from_body) {
      EXPECT_TRUE(x.world_from_body->R.isApprox(y.world_from_body->R, 1e-14));
      EXPECT_EQ(x.world_from_body->t, y.world_from_body->t);
    }
    EXPECT_EQ(x.gravity, y.gravity);
  }
  ASSERT_EQ(a.distances.size(), b.distances.size());
  for (size_t k = 0; k < a.distances.size(); ++k) {
    EXPECT_EQ(a.distances[k].frame1, b.distances[k].frame1);
    EXPECT_EQ(a.distances[k].frame2, b.distances[k].frame2);
    EXPECT_EQ(a.distances[k].distance, b.distances[k].distance);
    EXPECT_EQ(a.distances[k].sigma, b.distances[k].sigma);
  }
  EXPECT_EQ(a.gravity_sigma, b.gravity_sigma);
  EXPECT_EQ(a.noise_px, b.noise_px);
  ASSERT_EQ(a.observations.size(), b.observations.size());
  for (size_t k = 0; k < a.observations.size(); ++k) {
    const Observation &x = a.observations[k], &y = b.observations[k];
    EXPECT_EQ(x.landmark, y.landmark);
    EXPECT_EQ(x.frame, y.frame);
    EXPECT_EQ(x.camera, y.camera);
    EXPECT_EQ(x.pixel, y.pixel);
    EXPECT_EQ(x.sigma, y.sigma);
  }
}

TEST(TrackFile, ReadsEveryLine) {
  const Tracks tracks = MustRead(kTracks);
  EXPECT_EQ(tracks.name, "x.tracks");
  EXPECT_EQ(tracks.sequence, "loop-06");
  ASSERT_EQ(tracks.rig.size(), 2);
  EXPECT_EQ(tracks.rig.cameras[1].intrinsics.model, CameraModel::kSimpleRadial);
  EXPECT_EQ(tracks.rig.cameras[1].position_sigma, 0.02);
  EXPECT_EQ(tracks.rig.cameras[1].time_offset, 0.05);
  ASSERT_EQ(tracks.frames.size(), 2u);
  EXPECT_EQ(tracks.frames[0].number, 1);
  EXPECT_FALSE(tracks.frames[0].time.has_value());
  EXPECT_EQ(tracks.frames[0].gravity, Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_EQ(tracks.frames[1].time, 1.5);
  ASSERT_TRUE(tracks.frames[1].world_from_body.has_value());
  EXPECT_EQ(tracks.frames[1].world_from_body->t, Eigen::Vector3d(0.25, -0.5, 1.25));
  EXPECT_DOUBLE_EQ(*tracks.gravity_sigma, DegToRad(0.5));
  ASSERT_EQ(tracks.distances.size(), 1u);
  EXPECT_EQ(tracks.distances[0].frame2, 3);
  EXPECT_EQ(tracks.distances[0].distance, 1.5);
  EXPECT_EQ(tracks.noise_px, 0.75);
  ASSERT_EQ(tracks.observations.size(), 3u);
  EXPECT_EQ(tracks.observations[1].landmark, -7);
  EXPECT_EQ(tracks.observations[1].frame, 3);
  EXPECT_EQ(tracks.observations[1].pixel, Pixel(-4.5, 100));
  EXPECT_FALSE(tracks.observations[1].sigma.has_value());
  EXPECT_EQ(tracks.observations[2].camera, 1);
}

TEST(TrackFile, ComesBackAsItWasWritten) {
  const TempDir directory;
  Tracks tracks = MustRead(kTracks);
  for (const char* name : {"a.tracks", "a.tracks.gz"}) {
    for (const bool has_sigmas : {false, true}) {
      tracks.observations[0].sigma = 0.5;  // one alone is left out
      if (has_sigmas) tracks.observations[1].sigma = tracks.observations[2].sigma = 1.0 / 3;
      std::string error;
      Tracks again;
      ASSERT_TRUE(WriteTrackFile(directory / name, tracks, &error)) << error;
      ASSERT_TRUE(ReadTrackFile(directory / name, &again, &error)) << error;
      if (!has_sigmas) tracks.observations[0].sigma.reset();
      ExpectSame(tracks, again);
      for (Observation& row : tracks.observations) row.sigma.reset();
    }
  }
  // No row, no frame, no prior.
  const std::string least = std::string("format rigtracks 1\n") +
                            "camera 0 pinhole 1 1 0 0 1 1 1 0 0 0 0 0 0\nobservations 0\n";
  EXPECT_EQ(FormatTracks(MustRead(least)), least);
}

TEST(TrackFile, WhatCouldNotBeReadIsNotWritten) {
  const TempDir directory;
  Tracks tracks = MustRead(kTracks);
  tracks.observations[1].frame = 2;
  std::string error;
  EXPECT_FALSE(WriteTrackFile(directory / "a.tracks", tracks, &error));
  EXPECT_THAT(error, HasSubstr("a.tracks: not written, it could not be read back"));
  EXPECT_TRUE(directory.Names().empty());
}

struct BrokenTracks {
  const char* what;
  std::string from, to;  // replaced in kTracks
  int line;
  const char* phrase;  // of the message
};

void PrintTo(const BrokenTracks& broken, std::ostream* out) { *out << broken.what; }

class BrokenTrackFile : public testing::TestWithParam<BrokenTracks> {};

TEST_P(BrokenTrackFile, IsRefused) {
  const BrokenTracks& c = GetParam();
  Tracks tracks;
  tracks.name = "untouched";
  std::string error;
  ASSERT_FALSE(ParseTracks(Replace(kTracks, c.from, c.to), "x.tracks", &tracks, &error));
  EXPECT_EQ(error.rfind("x.tracks:" + std::to_string(c.line) + ": ", 0), 0u) << error;
  EXPECT_THAT(error, HasSubstr(c.phrase));
  EXPECT_THAT(error, HasSubstr("expected"));
  EXPECT_TRUE(IsOnePrintableLine(error)) << error;
  EXPECT_EQ(tracks.name, "untouched");
  EXPECT_TRUE(tracks.observations.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Lines, BrokenTrackFile,
    testing::ValuesIn(std::vector<BrokenTracks>{
        {"a match file", "rigtracks", "rigmatch", 2, "expected 'format rigtracks 1'"},
        {"no format", "format rigtracks 1\n", "", 14, "no 'format' line before 'observations'"},
        {"not text", "# a comment", std::string("\0", 1), 1, "expected a track file"},
        {"another file", "# a comment", "hello", 1, "expected a track file with a line 'format"},
        {"a keyword of match files", "noise_px 0.75", "time 1 2", 13, "unknown keyword 'time'"},
        {"twice", "noise_px 0.75", "sequence a", 14, "'sequence' for the second time"},
        {"no camera", "camera 0", "camera 2", 4, "camera 1 without a camera 0"},
        {"camera model", "pinhole", "pinhall", 3, "camera model 'pinhall'"},
        {"frame twice", "frame 3 1.5", "frame 1 1.5", 9, "frame 1 for the second time"},
        {"frame negative", "frame 3 1.5", "frame -3", 8, "F is '-3'"},
        {"frame time", "frame 3 1.5", "frame 3 nan", 8, "'nan', expected a finite number"},
        {"frame long", "frame 3 1.5", "frame 3 1 2", 8, "4 columns, expected 3 (frame F [TIME])"},
        {"truth of no frame", "truth 3", "truth 2", 7, "frame '2', expected one of a line 'frame"},
        {"truth twice", "noise_px 0.75", "truth 3 1 0 0 0 0 0 0", 13, "truth 3 for the second"},
        {"truth not a rotation", "0.8 0 -0.6", "0.8 0 -0.7", 7, "the quaternion has norm"},
        {"gravity of no frame", "gravity 1", "gravity 4", 10, "frame '4', expected one of a line"},
        {"gravity not unit", "gravity 1 0 0.6", "gravity 1 1 0.6", 10, "the direction has norm"},
        {"gravity twice", "noise_px 0.75", "gravity 1 0 1 0", 13, "gravity 1 for the second time"},
        {"gravity sigma", "deg 0.5", "deg 0", 11, "expected a positive number"},
        {"distance of no frame", "distance 1 3", "distance 1 2", 12, "frame '2', expected one of"},
        {"distance to itself", "distance 1 3", "distance 1 1", 12, "G is '1', expected another"},
        {"distance negative", "1.5 0.125", "-1.5 0.125", 12, "D is '-1.5', expected a number >= 0"},
        {"distance exact", "1.5 0.125", "1.5 0", 12, "SIGMA is '0', expected a positive number"},
        {"fewer rows", "observations 3", "observations 4", 18, "ends after 3 rows, expected 4"},
        {"more rows", "observations 3", "observations 2", 18, "more rows than 'observations 2'"},
        {"no rows line", "observations 3\n-7 1 0 34.25 103.5\n-7 3 0 -4.5 1e2\n9 3 1 7 8\n", "", 14,
         "ends without a 'observations' line"},
        {"header after rows", "9 3 1 7 8", "noise_px 1", 18, "'noise_px' after 'observations'"},
        {"short row", "9 3 1 7 8", "9 3 1 7", 18, "4 columns, expected 5"},
        {"long row", "9 3 1 7 8", "9 3 1 7 8 1 1", 18, "7 columns, expected 5"},
        {"sigma in one row", "9 3 1 7 8", "9 3 1 7 8 1", 18, "a SIGMA, expected none as in"},
        {"no sigma in one row", "34.25 103.5", "34.25 103.5 1", 17, "no SIGMA, expected one as in"},
        {"sigma zero", "34.25 103.5", "34.25 103.5 0", 16, "'0', expected a positive number"},
        {"landmark", "9 3 1 7 8", "9.5 3 1 7 8", 18, "LANDMARK is '9.5', expected an integer"},
        {"row of no frame", "9 3 1 7 8", "9 2 1 7 8", 18, "FRAME is '2', expected a declared fr"},
        {"row of no camera", "9 3 1 7 8", "9 3 2 7 8", 18, "CAMERA is '2', expected a declared"},
        {"pixel", "9 3 1 7 8", "9 3 1 inf 8", 18, "U is 'inf', expected a finite number"},
        {"seen twice", "9 3 1 7 8", "-7 3 0 7 8", 18,
         "landmark -7 is twice in the image of camera 0 in frame 3"},
    }));

}  // namespace
}  // namespace rigel
