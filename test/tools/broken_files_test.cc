// Directories with broken match files: each is told in one line, all others are reported.
#include <filesystem>

#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr char kCamera[] = "pinhole 400 400 320 240 640 480 1 0 0 0 0 0 0";

struct Broken {
  const char* name;
  std::string text;
  int line;              // where it breaks
  const char* expected;  // words of the message
};

// A header line put into a file that is right but for it: it becomes line 4.
std::string WithLine(const std::string& line) {
  return std::string("format rigmatch 1\ncamera 0 ") + kCamera + "\naxis 0 1 0\n" + line +
         "\nmatches 1\n0 1 2 0 3 4 0\n";
}

// Cameras at lines 2 and on.
std::string WithCameras(const std::string& cameras) {
  return "format rigmatch 1\n" + cameras + "\nmatches 1\n0 1 2 0 3 4 0\n";
}

// A row becomes line 5.
std::string WithRow(const std::string& row) {
  return std::string("format rigmatch 1\ncamera 0 ") + kCamera + "\nmatches 2\n0 1 2 0 3 4 0\n" +
         row + "\n";
}

// Every way in which DESIGN.md, section 7, lets a file be wrong.
std::vector<Broken> BrokenFiles() {
  const std::string camera0 = std::string("camera 0 ") + kCamera;
  return {
      {"empty", "", 0, "without a 'format' line"},
      {"not_the_format", "\n\nhello world\n", 3, "'hello'"},
      {"binary", std::string("format rigmatch 1\nab\0cd\n", 24), 2, "NUL"},
      {"no_format", camera0 + "\nmatches 0\n", 2, "no 'format' line"},
      {"other_version", "format rigmatch 2\n" + camera0 + "\nmatches 0\n", 1, "'2'"},
      {"other_format", "format colmap 1\n" + camera0 + "\nmatches 0\n", 1, "'colmap'"},
      {"no_matches", "format rigmatch 1\n" + camera0 + "\n", 2, "without a 'matches' line"},
      {"no_camera", "format rigmatch 1\nmatches 0\n", 2, "no 'camera' line"},
      {"unknown_keyword", WithLine("colour red"), 4, "unknown keyword 'colour'"},
      {"twice", WithLine("axis 0 1 0"), 4, "'axis' for the second time"},
      {"format_twice", WithLine("format rigmatch 1"), 4, "'format' for the second time"},
      {"camera_twice", WithLine(camera0), 4, "camera 0 for the second time"},
      {"camera_gap", WithCameras(camera0 + "\ncamera 2 " + kCamera), 3, "camera 2"},
      {"camera_from_1", WithCameras(std::string("camera 1 ") + kCamera), 2, "camera 1"},
      {"camera_negative", WithCameras(std::string("camera -1 ") + kCamera), 2, "K is '-1'"},
      {"camera_model", WithCameras("camera 0 fisheye 400 400 320 240 640 480 1 0 0 0 0 0 0"), 2,
       "'fisheye'"},
      {"focal_length", WithCameras("camera 0 pinhole 0 400 320 240 640 480 1 0 0 0 0 0 0"), 2,
       "FX is '0'"},
      {"focal_length_y", WithCameras("camera 0 pinhole 400 -4 320 240 640 480 1 0 0 0 0 0 0"), 2,
       "FY is '-4'"},
      {"width", WithCameras("camera 0 pinhole 400 400 320 240 0 480 1 0 0 0 0 0 0"), 2, "WIDTH"},
      {"height", WithCameras("camera 0 pinhole 400 400 320 240 640 -1 1 0 0 0 0 0 0"), 2, "HEIGHT"},
      {"size_not_integer", WithCameras("camera 0 pinhole 400 400 320 240 640.5 480 1 0 0 0 0 0 0"),
       2, "WIDTH"},
      {"quaternion", WithCameras("camera 0 pinhole 400 400 320 240 640 480 1 0.1 0 0 0 0 0"), 2,
       "norm"},
      {"camera_nan", WithCameras("camera 0 pinhole 400 400 nan 240 640 480 1 0 0 0 0 0 0"), 2,
       "CX is 'nan'"},
      {"camera_short", WithCameras("camera 0 pinhole 400 400 320 240 640 480 1 0 0 0 0 0"), 2,
       "15 columns"},
      {"truth_norm", WithLine("truth 0.9 0 0 0 0 0 1"), 4, "norm 0.9"},
      {"truth_inf", WithLine("truth 1 0 0 0 0 0 inf"), 4, "TZ is 'inf'"},
      {"direction_norm", WithLine("gravity1 0 1.1 0"), 4, "norm 1.1"},
      {"direction_zero", WithLine("normal 0 0 0"), 4, "norm 0"},
      {"direction_nan", WithLine("gravity2 0 nan 0"), 4, "GY is 'nan'"},
      {"sigma_zero", WithLine("gravity_sigma_deg 0"), 4, "positive"},
      {"sigma_negative", WithLine("normal_sigma_deg -1"), 4, "positive"},
      {"noise_zero", WithLine("noise_px 0"), 4, "positive"},
      {"distance_sigma", WithLine("distance 1 0"), 4, "SIGMA is '0'"},
      {"time_one", WithLine("time 1"), 4, "2 columns"},
      {"header_extra", WithLine("noise_px 1 2"), 4, "3 columns"},
      {"few_rows", WithRow(""), 5, "after 1 rows"},
      {"many_rows", WithRow("0 1 2 0 3 4 0\n0 1 2 0 3 4 0"), 6, "more rows"},
      {"huge_count", "format rigmatch 1\n" + camera0 + "\nmatches 2147483647\n", 3, "after 0 rows"},
      {"negative_count", "format rigmatch 1\n" + camera0 + "\nmatches -1\n", 3, "N is '-1'"},
      {"row_short", WithRow("0 1 2 0 3 4"), 5, "6 columns"},
      {"row_long", WithRow("0 1 2 0 3 4 0 9"), 5, "8 columns"},
      {"row_nan", WithRow("0 1 nan 0 3 4 0"), 5, "V is 'nan'"},
      {"row_inf", WithRow("0 1 2 0 -inf 4 0"), 5, "U2 is '-inf'"},
      {"row_overflow", WithRow("0 1e999 2 0 3 4 0"), 5, "U is '1e999'"},
      {"row_word", WithRow("0 1 2 0 3 4 good"), 5, "SCORE is 'good'"},
      {"row_camera", WithRow("0 1 2 1 3 4 0"), 5, "J is '1'"},
      {"row_camera_negative", WithRow("-1 1 2 0 3 4 0"), 5, "I is '-1'"},
      {"row_camera_fraction", WithRow("0.5 1 2 0 3 4 0"), 5, "I is '0.5'"},
      {"header_after_rows", WithRow("axis 0 1 0"), 5, "'axis' after 'matches'"},
  };
}

class BrokenFilesTest : public ToolsTest {
 protected:
  // Two good files in Path("in"), first and last in byte order: 000000 and zzz.
  void SetUp() override {
    ToolsTest::SetUp();
    directory_ = Simulate("in", {"--pairs=2", "--num_matches=30"});
    std::filesystem::rename(directory_ + "/000001.matches", directory_ + "/zzz.matches");
  }

  void ExpectGoodFilesReported(const std::string& tool) {
    const Outcome run = RunTool(tool, {"--matches=" + directory_, "--json=-"});
    EXPECT_EXIT_CODE(run, 1);
    const Json report = ParseReport(run.out);
    if (tool == "estimate") {
      ASSERT_EQ(report.at("pairs").size(), 2u);
      EXPECT_EQ(report["pairs"][0]["pair"], directory_ + "/000000.matches");
      EXPECT_EQ(report["pairs"][1]["pair"], directory_ + "/zzz.matches");
      for (const Json& pair : report["pairs"]) EXPECT_EQ(pair["status"], "ok");
    } else {
      EXPECT_EQ(report.at("pairs"), 2);
      for (const Json& entry : report["results"]) EXPECT_EQ(entry["pairs"], 2);
    }
  }

  std::string directory_;
};

TEST_F(BrokenFilesTest, EachIsToldInOneLineAndTheOthersAreReported) {
  const std::vector<Broken> files = BrokenFiles();
  for (const Broken& broken : files) {
    WriteText(directory_ + "/" + broken.name + ".matches", broken.text);
  }
  for (const std::string tool : {"estimate", "compare"}) {
    const Outcome run = RunTool(tool, {"--matches=" + directory_});
    EXPECT_EXIT_CODE(run, 1);
    const std::vector<std::string> lines = Lines(run.err);
    EXPECT_EQ(lines.size(), files.size()) << run.err;
    for (const Broken& broken : files) {
      const std::string path = directory_ + "/" + broken.name + ".matches";
      const std::string place =
          path + (broken.line > 0 ? ":" + std::to_string(broken.line) : "") + ": ";
      EXPECT_THAT(lines, Contains(testing::AllOf(StartsWith(place), HasSubstr(broken.expected),
                                                 HasSubstr("expected"))))
          << run.err;
    }
    ExpectGoodFilesReported(tool);
  }
}

TEST_F(BrokenFilesTest, WhatCannotBeOpenedIsToldToo) {
  std::filesystem::create_symlink("/proc/nonexistent/of/rigel", directory_ + "/dangling.matches");
  for (const std::string tool : {"estimate", "compare"}) {
    const Outcome run = RunTool(tool, {"--matches=" + directory_});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(
        Lines(run.err),
        testing::ElementsAre(StartsWith(directory_ + "/dangling.matches: cannot be opened")));
    ExpectGoodFilesReported(tool);
  }
}

TEST_F(BrokenFilesTest, OtherNamesAndFoldersBelowAreNotLookedAt) {
  WriteText(directory_ + "/README.txt", "not a match file");
  WriteText(directory_ + "/000000.matches.bak", "not a match file");
  WriteText(directory_ + "/below/x.matches", "not a match file");
  WriteText(directory_ + "/folder.matches/x", "not a match file");
  for (const std::string tool : {"estimate", "compare"}) {
    EXPECT_EXIT_CODE(RunTool(tool, {"--matches=" + directory_}), 0);
  }
}

TEST_F(BrokenFilesTest, MissingFilesAndEmptyDirectories) {
  std::filesystem::create_directory(Path("empty"));
  for (const std::string tool : {"estimate", "compare"}) {
    const Outcome missing = RunTool(tool, {"--matches=" + Path("missing")});
    EXPECT_EXIT_CODE(missing, 1);
    EXPECT_THAT(missing.err, HasSubstr(Path("missing") + ": cannot be opened: No such file"));
    EXPECT_THAT(missing.out, IsEmpty());

    const Outcome empty = RunTool(tool, {"--matches=" + Path("empty")});
    EXPECT_EXIT_CODE(empty, 1);
    EXPECT_THAT(empty.err, HasSubstr(Path("empty") + ": no .matches files"));
    EXPECT_THAT(empty.out, IsEmpty());

    const Outcome commas = RunTool(tool, {"--matches=,,"});
    EXPECT_EXIT_CODE(commas, 1);
    EXPECT_THAT(commas.err, HasSubstr("nothing to read"));

    // Beside something that is there.
    const Outcome both = RunTool(
        tool, {"--matches=" + Path("missing") + "," + directory_ + "/zzz.matches", "--csv=-"});
    EXPECT_EXIT_CODE(both, 1);
    EXPECT_EQ(Lines(both.err).size(), 1u) << both.err;
    EXPECT_THAT(both.out, HasSubstr("zzz.matches"));
  }
}

}  // namespace
}  // namespace rigel
