// What version 0.1 wrote is still read, and its command lines are still understood; the reports
// that they give have all that 0.1's had. See test/compatibility.
#include <filesystem>
#include <sstream>

#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string Old(const std::string& name) { return RIGEL_COMPATIBILITY "/v0.1/" + name; }

// Every member of `old` is in `now`, with a value of its kind. Options are those of 0.1 and what
// has come since; numbers and texts may have changed.
void ExpectHasAllOf(const Json& old, const Json& now, const std::string& where) {
  const bool numbers = old.is_number() && now.is_number();
  ASSERT_TRUE(numbers || old.type() == now.type()) << where << " is another kind of value";
  if (old.is_object()) {
    for (const auto& [key, value] : old.items()) {
      if (key == "estimate_noise") continue;  // removed: it is what is always done
      ASSERT_TRUE(now.contains(key)) << where << "/" << key << " is not there any more";
      ExpectHasAllOf(value, now[key], where + "/" + key);
    }
  } else if (old.is_array()) {
    EXPECT_GE(now.size(), old.size()) << where;
    for (size_t k = 0; k < std::min(old.size(), now.size()); ++k) {
      ExpectHasAllOf(old[k], now[k], where + "/" + std::to_string(k));
    }
  }
}

// The columns of an old CSV file are those of a new one, new ones come after them.
void ExpectSameColumns(const std::string& old, const std::string& now) {
  EXPECT_EQ(Lines(now)[0].substr(0, Lines(old)[0].size()), Lines(old)[0]);
}

class CompatibilityTest : public ToolsTest {
 protected:
  void CopyOld(const std::string& from, const std::string& to) {
    fs::copy(Old(from), Path(to), fs::copy_options::recursive);
  }
};

TEST_F(CompatibilityTest, MatchFilesWithEveryKeywordAreRead) {
  std::vector<std::string> errors;
  const std::vector<std::string> paths = ListMatchFiles(Old("matches"), &errors);
  ASSERT_EQ(paths.size(), 4u);
  for (const std::string& path : paths) {
    FramePair pair;
    std::string error;
    ASSERT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
    EXPECT_EQ(pair.rig.size(), 2);
    EXPECT_EQ(pair.matches.size(), 50u);
    EXPECT_GT(pair.matches[0].score, 0.0);
    EXPECT_TRUE(pair.truth && pair.time1 && pair.time2);
    EXPECT_EQ(pair.noise_px, 0.5);
    EXPECT_TRUE(pair.prior.axis && pair.prior.axis_sigma);
    EXPECT_TRUE(pair.prior.normal && pair.prior.normal_sigma);
    EXPECT_EQ(pair.prior.gravity1.has_value(), path != paths[2]);
    EXPECT_EQ(pair.prior.gravity_sigma.has_value(), path != paths[2]);
    EXPECT_EQ(pair.prior.distance, 1.0);
    EXPECT_EQ(pair.prior.distance_sigma, 0.02);
    EXPECT_THAT(pair.sequence, HasSubstr("drive"));
  }
}

TEST_F(CompatibilityTest, CommandLinesAreUnderstood) {
  for (const std::string& line : Lines(ReadText(Old("command_lines.txt")))) {
    if (line[0] == '#') continue;
    std::istringstream words(line);
    int code = -1;
    std::string tool;
    words >> code >> tool;
    Args args;
    for (std::string arg; words >> arg;) {
      for (const auto& [name, path] : {std::pair<std::string, std::string>{"IN", Old("")},
                                       std::pair<std::string, std::string>{"OUT", Path("")}}) {
        for (size_t place; (place = arg.find(name + "/")) != std::string::npos;) {
          arg.replace(place, name.size() + 1, path);
        }
      }
      args.push_back(arg);
    }
#ifndef RIGEL_HAS_MATCH
    if (tool == "match") continue;
#endif
    const Outcome run = RunTool(tool, args);
    EXPECT_EXIT_CODE(run, code) << line;
  }
}

TEST_F(CompatibilityTest, ReportsHaveWhatTheyHad) {
  const std::string matches = "--matches=" + Old("matches");
  const std::string json = Path("r.json"), csv = Path("r.csv");
  const Args outputs = {"--json=" + json, "--csv=" + csv};
  EXPECT_EXIT_CODE(
      RunTool("compare",
              Args{matches, "--solvers=4pt-axis,3pt", "--by=sequence", "--per_pair"} + outputs),
      0);
  ExpectHasAllOf(ParseReport(ReadText(Old("report.json"))), ParseReport(ReadText(json)), "report");
  ExpectSameColumns(ReadText(Old("report.csv")), ReadText(csv));

  EXPECT_EXIT_CODE(
      RunTool("estimate",
              Args{matches, "--solver=auto", "--drift", "--kitti_trajectory=" + Path("kitti.txt"),
                   "--tum_trajectory=" + Path("tum.txt"), "--g2o=" + Path("e.g2o")} +
                  outputs),
      0);
  ExpectHasAllOf(ParseReport(ReadText(Old("estimate.json"))), ParseReport(ReadText(json)),
                 "estimate");
  ExpectSameColumns(ReadText(Old("estimate.csv")), ReadText(csv));
  // Each line begins with the same words, and has as many.
  for (const auto& [old, now] : {std::pair<std::string, std::string>{"kitti_0.txt", "kitti_0.txt"},
                                 std::pair<std::string, std::string>{"tum_0.txt", "tum_0.txt"},
                                 std::pair<std::string, std::string>{"estimate.g2o", "e.g2o"}}) {
    // Comments may be added.
    const auto without_comments = [](std::vector<std::string> lines) {
      lines.erase(std::remove_if(lines.begin(), lines.end(),
                                 [](const std::string& line) { return line[0] == '#'; }),
                  lines.end());
      return lines;
    };
    const std::vector<std::string> before = without_comments(Lines(ReadText(Old(old))));
    const std::vector<std::string> after = without_comments(Lines(ReadText(Path(now))));
    ASSERT_EQ(before.size(), after.size()) << old;
    for (size_t k = 0; k < before.size(); ++k) {
      EXPECT_EQ(std::count(before[k].begin(), before[k].end(), ' '),
                std::count(after[k].begin(), after[k].end(), ' '));
    }
  }

  const std::string clip = Simulate("clip", {"--pairs=12", "--num_matches=40", "--inter_share=0.4",
                                             "--motion=planar", "--rotation_deg=4"});
  EXPECT_EXIT_CODE(
      RunTool("calibrate_prior", {"--matches=" + clip, "--lines=normal,gravity", "--json=" + json}),
      0);
  ExpectHasAllOf(ParseReport(ReadText(Old("calibration.json"))), ParseReport(ReadText(json)),
                 "calibration");
  EXPECT_EXIT_CODE(RunTool("benchmark", {"--solvers=4pt,3pt", "--trials=20", "--json=" + json}), 0);
  ExpectHasAllOf(ParseReport(ReadText(Old("benchmark.json"))), ParseReport(ReadText(json)),
                 "benchmark");
  EXPECT_EXIT_CODE(
      RunTool("benchmark", {"--ransac=speed", matches, "--solvers=4pt-axis,3pt", "--json=" + json}),
      0);
  ExpectHasAllOf(ParseReport(ReadText(Old("ransac_benchmark.json"))), ParseReport(ReadText(json)),
                 "ransac benchmark");
}

TEST_F(CompatibilityTest, ReportsOfShardsAreMergedToWhatTheyWere) {
  const Outcome run = RunTool(
      "compare",
      {"--merge=" + Old("shard1.json") + "," + Old("shard0.json"), "--per_pair", "--json=-"});
  EXPECT_EXIT_CODE(run, 0);
  ExpectHasAllOf(ParseReport(ReadText(Old("whole.json"))), ParseReport(run.out), "whole");
}

TEST_F(CompatibilityTest, ReportsAreBaselines) {
  // 0.1's estimates are no bound for ever; that they are found is seen by a wide tolerance.
  const Args args = {"--matches=" + Old("matches"), "--baseline=" + Old("report.json")};
  EXPECT_EXIT_CODE(RunTool("compare", args + Args{"--solvers=4pt-axis,3pt", "--tolerance=1"}), 0);
  const Outcome run = RunTool("compare", args + Args{"--solvers=4pt-axis", "--tolerance=1"});
  EXPECT_EXIT_CODE(run, 3);
  EXPECT_THAT(run.err, HasSubstr("3pt: is missing"));
}

TEST_F(CompatibilityTest, CalibratedFilesAreKnownAsSuch) {
  CopyOld("calibrated", "files");
  for (const char* name : {"000000", "000001"}) {
    fs::copy(Old("matches/") + name + ".matches", Path("files/new_") + name + ".matches");
  }
  const Outcome run =
      RunTool("calibrate_prior", {"--matches=" + Path("files"), "--lines=normal", "--in_place"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("2 of 4 files are calibrated already"));
}

TEST_F(CompatibilityTest, AnInterruptedExperimentIsFinished) {
  CopyOld("experiment", "x");
  const std::string points = ReadText(Path("x/kitti-motions.points.jsonl"));
  const Outcome run =
      RunTool("experiment", {"--name=kitti-motions", "--quick", "--resume", "--nofigures",
                             "--poses=" + Old("poses"), "--output=" + Path("x")});
  EXPECT_EXIT_CODE(run, 0);
  const std::string after = ReadText(Path("x/kitti-motions.points.jsonl"));
  EXPECT_THAT(after, HasSubstr(points.substr(points.find('\n') + 1))) << "the point is kept";
  EXPECT_EQ(Lines(after).size(), Lines(points).size() + 1);
  ExpectHasAllOf(ParseReport(ReadText(Old("results/kitti-motions.json"))),
                 ParseReport(ReadText(Path("x/kitti-motions.json"))), "experiment");
  ExpectHasAllOf(ParseReport(ReadText(Old("results/claims.json"))),
                 ParseReport(ReadText(Path("x/claims.json"))), "claims");
}

TEST_F(CompatibilityTest, ResultsOfExperimentsAreAmongTheClaims) {
  CopyOld("results", "x");
  const Outcome run = RunTool("experiment", {"--name=match-count", "--quick", "--pairs=1",
                                             "--nofigures", "--output=" + Path("x")});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, Not(HasSubstr("not among the claims")));
  EXPECT_THAT(run.out, HasSubstr("kitti-motions"));
}

TEST_F(CompatibilityTest, ReportsAreDrawn) {
  const Outcome run = RunTool("plot.py", {Old("report.json"), Old("benchmark.json"), Old("results"),
                                          "--output=" + Path("figures")});
  if (run.err.find("matplotlib") != std::string::npos) GTEST_SKIP() << "there is no matplotlib";
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, AllOf(HasSubstr("figures"), Not(HasSubstr("left out"))));
}

}  // namespace
}  // namespace rigel
