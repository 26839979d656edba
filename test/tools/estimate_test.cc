// rigel_estimate: what it says of pairs of all kinds.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include "rigel/core/angles.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;
using testing::UnorderedElementsAre;

constexpr char kHeader[] =
    "format rigmatch 1\n"
    "camera 0 pinhole 400 400 320 240 640 480 1 0 0 0 -0.5 0 0\n"
    "camera 1 pinhole 400 400 320 240 640 480 1 0 0 0 0.5 0 0\n";

std::string Matches(const std::vector<std::string>& rows) {
  std::string text = "matches " + std::to_string(rows.size()) + "\n";
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

class EstimateTest : public ToolsTest {
 protected:
  // The one pair of a run that reads one file.
  Json OnlyPair(const Args& args) {
    const Outcome run = RunTool("estimate", args + Args{"--json=-"});
    EXPECT_EXIT_CODE(run, 0);
    const Json report = ParseReport(run.out);
    if (!report.is_object() || report["pairs"].size() != 1) {
      ADD_FAILURE() << "not one pair: " << run.out;
      return Json::object();
    }
    return report["pairs"][0];
  }
};

TEST_F(EstimateTest, JsonHasTheMotionsInFull) {
  const std::string matches =
      Simulate("in", {"--pairs=3", "--inter_share=0.5", "--outlier_share=0.2"});
  const Outcome run = RunTool("estimate", {"--matches=" + matches, "--json=-"});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, IsEmpty());
  const Json report = ParseReport(run.out);
  EXPECT_THAT(Keys(report),
              UnorderedElementsAre("format", "rigel_version", "options", "pairs", "rig_test"));
  EXPECT_EQ(report["format"], "rigel-estimate 1");
  EXPECT_EQ(report["options"]["solver"], "auto");
  EXPECT_EQ(report["options"]["confidence"], "0.9999");
  ASSERT_EQ(report["pairs"].size(), 3u);
  for (const Json& pair : report["pairs"]) {
    EXPECT_THAT(Keys(pair),
                UnorderedElementsAre(
                    "pair", "status", "matches", "solver", "inliers", "iterations", "time_ms",
                    "raw", "refined", "median_residual_px", "noise_px", "rotation_observable",
                    "translation_observable", "scale_observable", "rotation_sd_deg",
                    "translation_dir_sd_deg", "rig_direction", "rig_direction_sd_deg", "rig_center",
                    "length_sd", "covariance", "covariance_valid", "camera_pairs",
                    "relative_scale_sd", "weakest_direction", "auto", "doubtful", "rig_test"));
    EXPECT_THAT(Keys(pair["rig_test"]), UnorderedElementsAre("pairs", "chi2", "degrees_of_freedom",
                                                             "p", "p_with_calibration", "cameras"));
    for (const Json& cameras : pair["camera_pairs"]) {
      EXPECT_LT(std::abs(cameras["median_residual_px"].get<double>()), 0.5);
    }
    EXPECT_FALSE(pair["doubtful"].get<bool>());
    EXPECT_EQ(pair["status"], "ok");
    EXPECT_EQ(pair["matches"], 200);
    EXPECT_GE(pair["inliers"], 150);
    EXPECT_LE(pair["inliers"], 170);
    EXPECT_NEAR(pair["noise_px"].get<double>(), 0.5, 0.15);
    for (const char* motion : {"raw", "refined"}) {
      ASSERT_EQ(pair[motion]["q_wxyz"].size(), 4u);
      ASSERT_EQ(pair[motion]["t"].size(), 3u);
      // One degree about Y, one metre along Z.
      const double y = pair[motion]["q_wxyz"][2];
      EXPECT_NEAR(2 * std::asin(y) * 180 / M_PI, 1.0, 0.3);
      EXPECT_NEAR(pair[motion]["t"][2], 1.0, 0.1);
    }
    ASSERT_EQ(pair["covariance"].size(), 6u);
    for (const Json& row : pair["covariance"]) EXPECT_EQ(row.size(), 6u);
    EXPECT_LT(pair["rotation_sd_deg"], 0.1);
    EXPECT_LT(pair["translation_dir_sd_deg"], 2.0);
    EXPECT_TRUE(pair["scale_observable"].get<bool>());
  }
}

// Nothing is found in a nanosecond; an hour changes nothing.
TEST_F(EstimateTest, ATimeLimitIsSaidWhereItEndedTheSearch) {
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=2000"});
  const Outcome run =
      RunTool("estimate", {"--matches=" + matches, "--time_limit_ms=1e-6", "--json=-"});
  const Json pair = ParseReport(run.out)["pairs"][0];
  EXPECT_EQ(pair["stopped"], "time limit");
  EXPECT_THAT(pair["message"].get<std::string>(), HasSubstr("time limit of 1e-06 ms"));
  EXPECT_THAT(run.err, HasSubstr("time limit"));

  const Args args = {"--matches=" + matches, "--no_times"};
  Json plain = OnlyPair(args);
  EXPECT_EQ(OnlyPair(args + Args{"--time_limit_ms=3600000"}), plain);
  EXPECT_FALSE(plain.contains("stopped"));
}

TEST_F(EstimateTest, WithoutRefinementOnlyTheRawMotion) {
  const std::string matches = Simulate("in", {"--pairs=1", "--inter_share=0.5"});
  const Json pair = OnlyPair({"--matches=" + matches, "--refine=none"});
  EXPECT_THAT(Keys(pair), UnorderedElementsAre("pair", "status", "matches", "solver", "inliers",
                                               "iterations", "time_ms", "raw", "auto", "doubtful"));
  EXPECT_EQ(pair["status"], "ok");
}

// The cells of the first row of a table, whose names hold no blank.
std::vector<std::string> FirstRow(const std::string& table) {
  const std::vector<std::string> lines = Lines(table);
  std::istringstream row(lines.size() > 3 ? lines[3] : "");
  return {std::istream_iterator<std::string>(row), std::istream_iterator<std::string>()};
}

TEST_F(EstimateTest, WithoutRefinementTheLengthNeedsMatchesBetweenCameras) {
  constexpr size_t kLength = 8;  // pair status angle sd x y z sd |t|
  const Args raw = {"--refine=none", "--matches=" + Simulate("intra", {"--pairs=1"})};
  const Outcome intra = RunTool("estimate", raw);
  ASSERT_THAT(FirstRow(intra.out), SizeIs(12)) << intra.out;
  EXPECT_EQ(FirstRow(intra.out)[kLength], "-");
  EXPECT_NE(FirstRow(intra.out)[kLength - 2], "-");  // z of the direction
  EXPECT_THAT(intra.out, HasSubstr("not computed"));
  EXPECT_THAT(intra.out, Not(HasSubstr("not observable")));

  const std::string matches = Simulate("inter", {"--pairs=1", "--inter_share=0.5"});
  const Outcome inter = RunTool("estimate", {"--refine=none", "--matches=" + matches});
  ASSERT_THAT(FirstRow(inter.out), SizeIs(12)) << inter.out;
  EXPECT_NEAR(std::atof(FirstRow(inter.out)[kLength].c_str()), 1.0, 0.1);
  EXPECT_THAT(RunTool("estimate", {"--matches=" + matches}).out, Not(HasSubstr("not computed")));
}

TEST_F(EstimateTest, LineBreakInAFileNameBreaksNeitherTableNorMessages) {
  WriteText(Path("in/a\nb.matches"), kHeader + std::string("matches 0\n"));
  const Outcome run = RunTool("estimate", {"--matches=" + Path("in")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("a\\x0ab.matches: "), "no pair has a motion"));
  EXPECT_THAT(Lines(run.out), testing::Contains(StartsWith("a\\x0ab too few matches")));
  const Outcome prior = RunTool("estimate", {"--matches=" + Path("in"), "--prior=truth"});
  EXPECT_THAT(Lines(prior.err)[0], HasSubstr("a\\x0ab.matches: no truth"));
}

TEST_F(EstimateTest, PriorThatCannotBeWeighedIsToldOnce) {
  const std::string matches = Simulate("in", {"--pairs=3", "--num_matches=40"});
  const std::string text = ReadText(matches + "/000000.matches");
  WriteText(matches + "/000000.matches",
            "format rigmatch 1\naxis_sigma_deg 0.1\n" + text.substr(text.find('\n') + 1));
  const Args args = {"--matches=" + matches, "--use_prior_in_refine"};
  const auto errors = [&](const Args& more) {
    const Outcome run = RunTool("estimate", args + more);
    EXPECT_EXIT_CODE(run, 0);
    return Lines(run.err);
  };
  EXPECT_THAT(
      errors({"--solver=4pt-axis"}),
      ElementsAre(AllOf(StartsWith("--use_prior_in_refine: "), HasSubstr("in 2 of 3 pairs"))));
  EXPECT_THAT(errors({"--solver=4pt"}), ElementsAre(HasSubstr("in 3 of 3 pairs")));
  EXPECT_THAT(errors({"--solver=17pt-li"}), ElementsAre(StartsWith("--use_prior_in_refine: ")));
  EXPECT_THAT(errors({"--prior_sigma_deg=0.1"}), IsEmpty());
  EXPECT_THAT(errors({"--nouse_prior_in_refine"}), IsEmpty());
}

TEST_F(EstimateTest, UnreadableFileLeavesThePriorNoiseOfTheOthers) {
  const std::string matches = Simulate("in", {"--pairs=8", "--num_matches=40"});
  const Args args = {"--matches=" + matches, "--prior_noise_deg=1", "--refine=none", "--json=-"};
  const Json all = WithoutTimes(ParseReport(RunTool("estimate", args).out))["pairs"];
  WriteText(matches + "/000000.matches", "rubbish\n");
  const Outcome run = RunTool("estimate", args);
  EXPECT_EXIT_CODE(run, 1);
  const Json others = WithoutTimes(ParseReport(run.out))["pairs"];
  ASSERT_EQ(others.size(), 7u);
  for (size_t k = 0; k < others.size(); ++k) EXPECT_EQ(others[k], all[k + 1]) << k;
}

TEST_F(EstimateTest, ScaleOfIntraMatchesIsNotReportedAsIfItWereKnown) {
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=100"});
  const Json pair = OnlyPair({"--matches=" + matches});
  EXPECT_TRUE(pair["translation_observable"].get<bool>());
  EXPECT_FALSE(pair["scale_observable"].get<bool>());
  const Outcome run = RunTool("estimate", {"--matches=" + matches});
  EXPECT_THAT(run.out, HasSubstr("not observable"));
  EXPECT_THAT(run.out, HasSubstr("Rt-"));
}

TEST_F(EstimateTest, SwappedCamerasAreToldOnceAndCountedInTheJson) {
  const std::string matches = Simulate(
      "in", {"--pairs=2", "--num_matches=200", "--inter_share=0.5", "--outlier_share=0.1"});
  for (const char* name : {"/000000.matches", "/000001.matches"}) {
    std::vector<std::string> lines = Lines(ReadText(matches + name));
    std::string text;
    for (std::string& line : lines) {
      if (line.rfind("camera 0 ", 0) == 0) {
        line[7] = '1';
      } else if (line.rfind("camera 1 ", 0) == 0) {
        line[7] = '0';
      }
      text += line + "\n";
    }
    WriteText(matches + name, text);
  }
  const Outcome run = RunTool("estimate", {"--matches=" + matches, "--json=-"});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, HasSubstr("with cameras 0 and 1 swapped 1"));
  EXPECT_THAT(run.err, HasSubstr("(2 files alike)"));
  const Json report = ParseReport(run.out);
  for (const Json& pair : report["pairs"]) {
    int rows = 0, inliers = 0;
    for (const Json& cameras : pair["camera_pairs"]) {
      rows += cameras["rows"].get<int>();
      inliers += cameras["inliers"].get<int>();
    }
    EXPECT_EQ(rows, 200);
    EXPECT_EQ(inliers, pair["inliers"].get<int>());
    ASSERT_FALSE(pair["rig_doubts"].empty());
  }
}

// The files state camera 1 with a pitch that it does not have.
TEST_F(EstimateTest, ARigThatIsOffIsTold) {
  const std::string rig = Path("rig.json");
  const std::string camera = R"("model": "pinhole", "parameters": [718, 718, 620, 188],
      "width": 1241, "height": 376, "q": [1, 0, 0, 0])";
  WriteText(rig, R"({"format": "rigel-rig 1", "name": "stereo", "cameras": [{)" + camera +
                     R"(, "s": [0, 0, 0]}, {)" + camera + R"(, "s": [0.54, 0, 0]}]})");
  const std::string matches =
      Simulate("in", {"--scene=street", "--rig=" + rig, "--motion=car", "--ground_m=1.65",
                      "--pairs=5", "--inter_share=0.4", "--num_matches=300"});
  const Args args = {"--matches=" + matches, "--prior=body", "--json=-"};
  const Outcome right = RunTool("estimate", args);
  EXPECT_THAT(right.err, Not(HasSubstr("camera 1:")));
  for (int k = 0; k < 5; ++k) {
    const std::string file = matches + "/00000" + std::to_string(k) + ".matches";
    std::string text = ReadText(file);
    const std::string stated = " 1 0 0 0 0.54 0 0";
    const size_t at = text.find(stated);
    ASSERT_NE(at, std::string::npos) << text.substr(0, 300);
    // 0.1 degrees.
    text.replace(at, stated.size(), " 0.9999996192 0.000872664515 0 0 0.54 0 0");
    WriteText(file, text);
  }
  const Outcome off = RunTool("estimate", args);
  EXPECT_EXIT_CODE(off, 0);
  EXPECT_THAT(off.err, HasSubstr("camera 1: pitch -0.1"));
  EXPECT_THAT(off.err, HasSubstr("in 5 pairs"));
  const Json report = ParseReport(off.out);
  EXPECT_EQ(report["rig_test"]["pairs"], 5);
  EXPECT_LT(report["rig_test"]["p"].get<double>(), 1e-6);
  for (const Json& pair : report["pairs"]) EXPECT_LT(pair["rig_test"]["p"].get<double>(), 0.01);
}

TEST_F(EstimateTest, CsvHasOneRowAPairOfTheSameColumns) {
  const std::string matches = Simulate("in", {"--pairs=3", "--num_matches=40"});
  // One that fails, with what CSV has to quote in its name.
  WriteText(matches + "/a, \"b\".matches", kHeader + std::string("axis 0 1 0\nmatches 0\n"));
  const Outcome run = RunTool("estimate", {"--matches=" + matches, "--csv=-"});
  ASSERT_EXIT_CODE(run, 0);
  const std::vector<std::string> lines = Lines(run.out);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_THAT(lines[0], StartsWith("pair,status,"));
  const auto commas = [](const std::string& line) {
    int count = 0;
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c == ',' && !quoted) ++count;
    }
    return count;
  };
  for (const std::string& line : lines) EXPECT_EQ(commas(line), commas(lines[0])) << line;
  EXPECT_THAT(lines[4], HasSubstr("/a, \"\"b\"\".matches\",too few matches,"));
  EXPECT_THAT(run.out, Not(HasSubstr("nan")));
  EXPECT_THAT(run.out, Not(HasSubstr("inf")));
}

TEST_F(EstimateTest, TooFewMatchesAreAnAnswer) {
  WriteText(Path("in/none.matches"), kHeader + std::string("axis 0 1 0\nmatches 0\n"));
  WriteText(Path("in/three.matches"),
            kHeader + std::string("axis 0 1 0\n") +
                Matches({"0 100 100 0 110 100 0", "1 200 90 1 210 91 0", "0 50 60 0 55 60 0"}));
  const Outcome run = RunTool("estimate", {"--matches=" + Path("in"), "--solver=4pt-axis"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("none.matches: 0 matches, 4pt-axis needs 4 (2 "
                                                    "files alike but for the numbers)"),
                                          "no pair has a motion"));
  EXPECT_THAT(run.out, HasSubstr("too few matches"));
  const Json report = ParseReport(RunTool("estimate", {"--matches=" + Path("in"), "--json=-"}).out);
  for (const Json& pair : report["pairs"]) {
    EXPECT_THAT(Keys(pair), UnorderedElementsAre("pair", "status", "message", "matches", "auto"));
    EXPECT_EQ(pair["status"], "too few matches");
  }
}

TEST_F(EstimateTest, DegenerateMatchesEndInAStatusWithEverySolver) {
  const std::string priors = "axis 0 1 0\ngravity1 0 1 0\ngravity2 0 1 0\nnormal 0 1 0\n";
  // All the same; all the same and in the middle of the image; no motion at all; epipole only;
  // far outside of the image.
  const std::vector<std::vector<std::string>> kinds = {
      std::vector<std::string>(40, "0 100 100 0 110 101 0"),
      std::vector<std::string>(40, "0 320 240 0 320 240 0"),
      {"0 100 100 0 100 100 0", "1 200 300 1 200 300 0", "0 500 60 0 500 60 0",
       "1 333 111 1 333 111 0", "0 9 222 0 9 222 0", "1 600 400 1 600 400 0", "0 77 7 0 77 7 0",
       "1 123 321 1 123 321 0"},
      std::vector<std::string>(20, "0 320 240 1 320 240 0"),
      std::vector<std::string>(20, "0 1e300 1e300 1 -1e300 1e-300 0"),
      std::vector<std::string>(20, "0 1e8 -1e8 0 1e8 1e8 0"),
  };
  for (size_t k = 0; k < kinds.size(); ++k) {
    WriteText(Path("in/" + std::to_string(k) + ".matches"), kHeader + priors + Matches(kinds[k]));
  }
  const Outcome usage = RunTool("estimate", {"--matches=x", "--solver=?"});
  const std::string marker = "expected one of ";
  ASSERT_THAT(usage.err, HasSubstr(marker));
  std::string names = usage.err.substr(usage.err.find(marker) + marker.size());
  names = names.substr(0, names.find('\n')) + ", ";
  for (size_t begin = 0; begin < names.size();) {
    const size_t end = names.find(", ", begin);
    const std::string solver = names.substr(begin, end - begin);
    begin = end + 2;
    const Outcome run = RunTool("estimate", {"--matches=" + Path("in"), "--solver=" + solver,
                                             "--max_iterations=200", "--json=-"});
    const Json report = ParseReport(run.out);
    ASSERT_EQ(report["pairs"].size(), kinds.size());
    const bool any_motion = std::any_of(report["pairs"].begin(), report["pairs"].end(),
                                        [](const Json& pair) { return pair.contains("raw"); });
    EXPECT_EXIT_CODE(run, any_motion ? 0 : 1);
    for (const Json& pair : report["pairs"]) {
      // Matches that all agree on standing still may be solved; a direction must not come of it.
      EXPECT_FALSE(pair.value("translation_observable", false)) << solver << " " << pair.dump(2);
    }
  }
}

TEST_F(EstimateTest, PairWithoutThePriorOfItsSolverFailsWithAMessage) {
  const std::string directory = Simulate("in", {"--pairs=1", "--num_matches=40"});
  for (const auto& [solver, words] : std::vector<std::pair<std::string, std::string>>{
           {"3pt", "no normal; add a 'normal' line"},
           {"3pt-approx", "no normal; add a 'normal' line"}}) {
    const Outcome run = RunTool("estimate", {"--matches=" + directory, "--solver=" + solver});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err), ElementsAre(AllOf(HasSubstr("000000.matches: "), HasSubstr(solver),
                                                  HasSubstr(words), HasSubstr("--prior=body")),
                                            "no pair has a motion"));
    EXPECT_THAT(run.out, HasSubstr("invalid input"));
  }
  // The other remedies.
  WriteText(Path("none/a.matches"), kHeader + std::string("matches 0\n"));
  for (const auto& [solver, words] : std::vector<std::pair<std::string, std::string>>{
           {"4pt", "add 'gravity1' and 'gravity2' lines"}, {"4pt-axis", "add an 'axis' line"}}) {
    const Outcome run = RunTool("estimate", {"--matches=" + Path("none"), "--solver=" + solver});
    EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr(words), "no pair has a motion"));
  }
  // The body's axes stand in.
  EXPECT_EQ(OnlyPair({"--matches=" + directory, "--solver=3pt", "--prior=body"})["status"], "ok");
}

// A turn of a car with x forward and z up, which nobody says.
TEST_F(EstimateTest, ZUpBodyGivesItsTurnWhateverThePrior) {
  const std::string directory = Simulate("in", {"--pairs=2", "--rotation_deg=12", "--motion=planar",
                                                "--inter_share=0.3", "--outlier_share=0.2"});
  MakeZUpWithoutPriors(directory);
  for (const Args& flags :
       {Args{}, Args{"--solver=auto", "--prior=body"}, Args{"--solver=3pt", "--prior=body"},
        Args{"--solver=3pt", "--prior=body", "--down=-z"},
        Args{"--solver=4pt", "--prior=body", "--down=0,0,-3"}}) {
    const bool suggested = flags.size() == 2 && flags[1] == "--prior=body";
    const Outcome run = RunTool("estimate", Args{"--matches=" + directory, "--json=-"} + flags);
    EXPECT_EXIT_CODE(run, 0);
    // Once, not for each pair.
    EXPECT_EQ(run.err, suggested ? "--down=-z: taken from the cameras of the rig\n" : "");
    const Json report = ParseReport(run.out);
    for (const Json& pair : report["pairs"]) {
      const std::vector<double> q = pair["refined"]["q_wxyz"];
      EXPECT_NEAR(RadToDeg(2 * std::acos(std::abs(q[0]))), 12.0, 0.3) << run.command;
      EXPECT_GT(std::abs(q[3]), 0.99 * std::sin(DegToRad(6.0)));
      EXPECT_GT(pair["inliers"], 140);
    }
  }
  // Two vehicles in one run.
  const std::string other = Simulate("other", {"--pairs=1"});
  const Outcome two = RunTool("estimate", {"--matches=" + directory + "," + other, "--prior=body"});
  EXPECT_EXIT_CODE(two, 0);
  EXPECT_THAT(two.err, HasSubstr("--down=+y in 1 file, --down=-z in 2 files: taken from the "
                                 "cameras of the rigs\n"));
  // The front is told where it is looked at.
  const Outcome front =
      RunTool("estimate", {"--matches=" + directory, "--prior=body", "--solver=2pt-ackermann"});
  EXPECT_THAT(front.err, HasSubstr("--down=-z --forward=+x: taken from"));
  const Outcome said = RunTool("estimate", {"--matches=" + directory, "--prior=body",
                                            "--solver=2pt-ackermann", "--down=-z", "--forward=x"});
  EXPECT_THAT(said.err, IsEmpty());
  EXPECT_EQ(said.out, front.out);
}

TEST_F(EstimateTest, EqualMessagesOfManyPairsAreOneLine) {
  const std::string directory = Simulate("in", {"--pairs=20", "--num_matches=40"});
  const Outcome run = RunTool("estimate", {"--matches=" + directory, "--solver=3pt"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err),
              ElementsAre(AllOf(HasSubstr("000000.matches: 3pt: the prior has no normal"),
                                HasSubstr("(20 files alike)")),
                          "no pair has a motion"));
  // A part of them is no run: of the others some may have one.
  const Outcome shard =
      RunTool("estimate", {"--matches=" + directory, "--solver=3pt", "--shard=0/2"});
  EXPECT_EXIT_CODE(shard, 0);
  EXPECT_THAT(Lines(shard.err), ElementsAre(HasSubstr("(10 files alike)")));
}

TEST_F(EstimateTest, PriorFromTheTruthNeedsTheTruth) {
  WriteText(Path("in/a.matches"), kHeader + std::string("matches 0\n"));
  const Outcome run = RunTool("estimate", {"--matches=" + Path("in"), "--prior=truth"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("a.matches: no truth"));
}

TEST_F(EstimateTest, ResultsDoNotDependOnThreadsAndRuns) {
  const std::string matches =
      Simulate("in", {"--pairs=8", "--inter_share=0.3", "--outlier_share=0.4"});
  const auto estimate = [&](const Args& more) {
    const Outcome run = RunTool("estimate", Args{"--matches=" + matches, "--json=-"} + more);
    EXPECT_EXIT_CODE(run, 0);
    return WithoutTimes(ParseReport(run.out));
  };
  const Json one = estimate({"--threads=1"});
  EXPECT_EQ(one, estimate({"--threads=1"}));
  EXPECT_EQ(one, estimate({"--threads=4"}));
  EXPECT_NE(one["pairs"], estimate({"--seed=2"})["pairs"]);
}

TEST_F(EstimateTest, DashWritesOnlyTheReportToStdout) {
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=40"});
  const Outcome json =
      RunTool("estimate", {"--matches=" + matches, "--json=-", "--csv=" + Path("csv")});
  EXPECT_THAT(json.out, StartsWith("{"));
  ParseReport(json.out);
  const Outcome csv =
      RunTool("estimate", {"--matches=" + matches, "--json=" + Path("json"), "--csv=-"});
  EXPECT_THAT(csv.out, StartsWith("pair,"));
  EXPECT_THAT(Lines(csv.out), SizeIs(2));
  EXPECT_EQ(Lines(ReadText(Path("csv"))).size(), 2u);
  EXPECT_EQ(WithoutTimes(ParseReport(ReadText(Path("json")))), WithoutTimes(ParseReport(json.out)));
}

TEST_F(EstimateTest, TableFitsIntoAHundredColumns) {
  // Long names, large angles, statuses of all lengths.
  const std::string matches =
      Simulate("in", {"--pairs=2", "--rotation_deg=12", "--inter_share=1", "--num_matches=3000"});
  WriteText(matches + "/a_very_long_name_of_a_sequence_000000_000001.matches",
            kHeader + std::string("axis 0 1 0\nmatches 0\n"));
  WriteText(matches +
                "/\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc"
                "\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6.matches",
            kHeader + std::string("axis 0 1 0\nmatches 0\n"));
  // Outliers only: whatever numbers come of them.
  const std::string noise = Simulate(
      "noise", {"--pairs=5", "--num_matches=30", "--outlier_share=1", "--inter_share=0.5"});
  const Outcome run = RunTool("estimate", {"--matches=" + matches + "," + noise});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_LE(Width(run.out), 100u) << run.out;
  EXPECT_THAT(run.out, HasSubstr("...000000_000001")) << run.out;
}

TEST_F(EstimateTest, OptionsChangeTheResult) {
  // Large noise and gravity off by 2 degrees, so that every option shows.
  const std::string matches =
      Simulate("in", {"--pairs=1", "--num_matches=60", "--inter_share=0.5", "--outlier_share=0.2"});
  const Args base = {"--matches=" + matches, "--solver=4pt"};
  const Json result = OnlyPair(base)["refined"];
  for (const Args& change : std::vector<Args>{{"--refine=prior"},
                                              {"--refine=depths"},
                                              {"--refine=prior-depths"},
                                              {"--residual=algebraic"},
                                              {"--residual=angular"},
                                              {"--loss=none"},
                                              {"--loss=huber"},
                                              {"--loss=cauchy"},
                                              {"--loss=truncated"},
                                              {"--use=intra"},
                                              {"--use=inter"},
                                              {"--use_prior_in_refine", "--prior_sigma_deg=0.01"},
                                              {"--threshold_px=1"}}) {
    const Json pair = OnlyPair(base + change);
    ASSERT_EQ(pair["status"], "ok") << change[0];
    EXPECT_NE(pair["refined"], result) << change[0];
  }
}

TEST_F(EstimateTest, ExactPriorIsKeptExactly) {
  const std::string matches =
      Simulate("in", {"--pairs=1", "--num_matches=60", "--inter_share=0.5", "--motion=planar"});
  for (const char* form : {"--refine=prior", "--refine=prior-depths"}) {
    const Json axis = OnlyPair({"--matches=" + matches, "--solver=4pt-axis", form})["refined"];
    EXPECT_NEAR(axis["q_wxyz"][1], 0, 1e-12) << form;
    EXPECT_NEAR(axis["q_wxyz"][3], 0, 1e-12) << form;
    const Json planar = OnlyPair({"--matches=" + matches, "--solver=3pt", form})["refined"];
    EXPECT_NEAR(planar["q_wxyz"][1], 0, 1e-12) << form;
    EXPECT_NEAR(planar["q_wxyz"][3], 0, 1e-12) << form;
    EXPECT_NEAR(planar["t"][1], 0, 1e-12) << form;
  }
}

// An offset of the shell: `>> input`.
TEST_F(EstimateTest, StdoutIsNoInput) {
  const std::string matches = Simulate("in", {"--pairs=1"}) + "/000000.matches";
  const std::string before = ReadText(matches);
  const std::string program = std::string(RIGEL_PROGRAMS) + "/rigel_estimate";
  const std::string command =
      program + " --matches=" + matches + " >>" + matches + " 2>" + Path("err");
  EXPECT_NE(std::system(command.c_str()), 0);
  EXPECT_THAT(ReadText(Path("err")), HasSubstr("stdout: would overwrite the input " + matches));
  EXPECT_EQ(ReadText(matches), before);
}

// Not a line for each count of inliers, and what is likely wrong.
TEST_F(EstimateTest, PairsWithoutAConsensusAreOneLine) {
  const std::string matches = Simulate("in", {"--pairs=6", "--outlier_share=1"});
  const Outcome run =
      RunTool("estimate", {"--matches=" + matches, "--solver=4pt", "--max_iterations=200"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), testing::Contains(testing::AllOf(
                                  HasSubstr("no more than chance allows; is the prior right?"),
                                  HasSubstr("(6 files alike"))));
}

}  // namespace
}  // namespace rigel
