// rigel_simulate: files that the other programs can rely on.
#include <filesystem>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SimulateTest : public ToolsTest {
 protected:
  std::vector<FramePair> ReadAll(const std::string& directory) {
    std::vector<std::string> errors;
    std::vector<FramePair> pairs;
    for (const std::string& path : ListMatchFiles(directory, &errors)) {
      FramePair pair;
      std::string error;
      EXPECT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
      pairs.push_back(pair);
    }
    EXPECT_THAT(errors, IsEmpty());
    return pairs;
  }

  // All files of a directory, one after the other, with their names.
  std::string Bytes(const std::string& directory) {
    std::vector<std::string> errors;
    std::string bytes;
    for (const std::string& path : ListMatchFiles(directory, &errors)) {
      bytes += std::filesystem::path(path).filename().string() + "\n" + ReadText(path);
    }
    return bytes;
  }
};

TEST_F(SimulateTest, DefaultsAreTheSceneOfTheBenchmarks) {
  const Outcome run = RunTool("simulate", {"--output=" + Path("out")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_THAT(run.err, HasSubstr("wrote 50 match files"));
  const std::vector<FramePair> pairs = ReadAll(Path("out"));
  ASSERT_EQ(pairs.size(), 50u);
  EXPECT_EQ(std::filesystem::path(pairs.front().name).filename(), "000000.matches");
  EXPECT_EQ(std::filesystem::path(pairs.back().name).filename(), "000049.matches");
  for (const FramePair& pair : pairs) {
    EXPECT_EQ(pair.rig.size(), 2);
    EXPECT_EQ(pair.matches.size(), 200u);
    EXPECT_EQ(pair.noise_px, 0.5);
    ASSERT_TRUE(pair.truth.has_value());
    EXPECT_NEAR(RadToDeg(LogSO3(pair.truth->R).y()), 1.0, 1e-9);
    EXPECT_NEAR((pair.truth->t - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-12);
    ASSERT_TRUE(pair.prior.gravity1 && pair.prior.gravity2 && pair.prior.axis);
    EXPECT_FALSE(pair.prior.normal.has_value());
    EXPECT_NEAR((pair.truth->R * *pair.prior.gravity1 - *pair.prior.gravity2).norm(), 0, 1e-12);
    for (const Match& match : pair.matches) EXPECT_TRUE(match.IsIntra());
  }
}

TEST_F(SimulateTest, SameSeedSameBytes) {
  const Args args = {
      "--pairs=3",         "--num_matches=50",    "--motion=random", "--rotation_axis=random",
      "--inter_share=0.5", "--outlier_share=0.2", "--seed=7"};
  const std::string bytes = Bytes(Simulate("a", args));
  EXPECT_EQ(bytes, Bytes(Simulate("b", args)));
  EXPECT_NE(bytes, Bytes(Simulate("c", args + Args{"--seed=8"})));
  // Over what is there already.
  EXPECT_EQ(bytes, Bytes(Simulate("c", args)));
}

TEST_F(SimulateTest, MotionsAreAsNamed) {
  for (const FramePair& pair : ReadAll(Simulate("sideways", {"--motion=sideways", "--pairs=2"}))) {
    EXPECT_NEAR((pair.truth->t - Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-12);
  }
  const std::vector<FramePair> random = ReadAll(Simulate("random", {"--motion=random"}));
  EXPECT_NEAR(random[0].truth->t.norm(), 1.0, 1e-12);
  EXPECT_GT((random[0].truth->t - random[1].truth->t).norm(), 1e-3);
}

TEST_F(SimulateTest, PlanarFilesHaveTheNormal) {
  const std::string directory = Simulate("planar", {"--motion=planar", "--rotation_deg=10"});
  EXPECT_THAT(ReadText(directory + "/000000.matches"), HasSubstr("\nnormal 0 1 0\n"));
  for (const FramePair& pair : ReadAll(directory)) {
    ASSERT_TRUE(pair.prior.normal.has_value());
    EXPECT_NEAR(pair.prior.normal->dot(pair.truth->t), 0.0, 1e-12);
    EXPECT_NEAR((pair.truth->R * *pair.prior.normal - *pair.prior.normal).norm(), 0.0, 1e-12);
  }
}

TEST_F(SimulateTest, NoNoiseNoNoiseLine) {
  const std::string text =
      ReadText(Simulate("exact", {"--noise_px=0", "--pairs=1"}) + "/000000.matches");
  EXPECT_THAT(text, testing::Not(HasSubstr("noise_px")));
}

TEST_F(SimulateTest, SharesAreExact) {
  const std::string directory = Simulate(
      "shares", {"--pairs=2", "--inter_share=0.25", "--outlier_share=0.5", "--noise_px=0"});
  for (const FramePair& pair : ReadAll(directory)) {
    int inter = 0;
    for (const Match& match : pair.matches) inter += match.IsIntra() ? 0 : 1;
    EXPECT_EQ(inter, 50);
  }
  EXPECT_EXIT_CODE(RunTool("simulate", {"--output=" + Path("all"), "--pairs=1", "--inter_share=1",
                                        "--outlier_share=1"}),
                   0);
}

TEST_F(SimulateTest, CarsAndScoresAreWrittenWhereAskedFor) {
  const std::vector<FramePair> still = ReadAll(Simulate("still", {"--pairs=1"}));
  const std::vector<FramePair> moving =
      ReadAll(Simulate("moving", {"--pairs=1", "--moving_share=0.3", "--match_scores"}));
  ASSERT_EQ(moving.size(), 1u);
  int moved = 0;
  for (size_t k = 0; k < moving[0].matches.size(); ++k) {
    moved += moving[0].matches[k].pixel1 != still[0].matches[k].pixel1 ? 1 : 0;
    EXPECT_EQ(still[0].matches[k].score, 0.0);
    EXPECT_GT(moving[0].matches[k].score, 0.0);
  }
  EXPECT_EQ(moved, 60);
}

// A rig of two cameras that look ahead, on a body with x forward and z up.
constexpr char kRig[] = R"({"format": "rigel-rig 1", "cameras": [
  {"model": "pinhole", "parameters": [400, 400, 320, 240], "width": 640, "height": 480,
   "q": [0.5, -0.5, 0.5, -0.5], "s": [1.7, 0.3, 1.3]},
  {"model": "opencv", "parameters": [400, 400, 320, 240, 0.1, 0, 0, 0], "width": 640,
   "height": 480, "q": [0.5, -0.5, 0.5, -0.5], "s": [1.7, -0.3, 1.3]}]})";

TEST_F(SimulateTest, StreetWithARigFile) {
  WriteText(Path("rig.json"), kRig);
  const Args args = {
      "--scene=street", "--rig=" + Path("rig.json"), "--pairs=3",           "--rotation_deg=3",
      "--distance_m=2", "--inter_share=0.25",        "--outlier_share=0.1", "--moving_share=0.1"};
  const Outcome run = RunTool("simulate", args + Args{"--output=" + Path("a")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, HasSubstr("rig.json: taken from the cameras: down -z, forward +x"));
  for (const FramePair& pair : ReadAll(Path("a"))) {
    ASSERT_EQ(pair.rig.size(), 2);
    EXPECT_EQ(pair.rig.cameras[1].intrinsics.model, CameraModel::kOpencv);
    EXPECT_EQ(pair.matches.size(), 200u);
    EXPECT_NEAR(pair.truth->t.norm(), 2.0, 1e-12);
    EXPECT_LT(pair.truth->t.x(), -1.9);
    int inliers = 0;
    for (const char inlier : pair.columns.inlier) inliers += inlier;
    EXPECT_EQ(inliers, 160);
    EXPECT_EQ(pair.columns.exact.size(), 200u);
  }
  EXPECT_EQ(Bytes(Path("a")), Bytes(Simulate("b", args + Args{"--threads=3"})));

  WriteText(Path("06.txt"), "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0.9\n");
  const std::vector<FramePair> driven =
      ReadAll(Simulate("driven", {"--scene=street", "--rig=" + Path("rig.json"),
                                  "--poses=" + Path("06.txt"), "--camera_noise_px=0.2,0.7"}));
  ASSERT_EQ(driven.size(), 1u);
  EXPECT_EQ(driven[0].sequence, "06");
  EXPECT_LT((driven[0].truth->t - Eigen::Vector3d(-0.9, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(driven[0].columns.sigma1.size(), 200u);
}

TEST_F(SimulateTest, ErrorsAndTimesOfCameras) {
  const Args args = {"--pairs=2", "--num_matches=20"};
  const std::string plain = Bytes(Simulate("plain", args));
  EXPECT_EQ(Bytes(Simulate("none", args + Args{"--calibration_sigma_deg=0", "--interval_s=1"})),
            plain);
  const Args error = {"--calibration_sigma_deg=0.2", "--calibration_sigma_m=0.02"};
  const std::string wrong = Bytes(Simulate("wrong", args + error));
  EXPECT_NE(wrong, plain);
  EXPECT_THAT(wrong, testing::Not(HasSubstr("camera_sigma")));
  for (const FramePair& pair : ReadAll(Simulate(
           "stated", args + error + Args{"--state_calibration_sigma", "--camera_times=0,0.045"}))) {
    EXPECT_NEAR(RadToDeg(pair.rig.cameras[0].rotation_sigma), 0.2, 1e-12);
    EXPECT_EQ(pair.rig.cameras[1].position_sigma, 0.02);
    EXPECT_EQ(pair.rig.cameras[1].time_offset, 0.045);
    EXPECT_TRUE(pair.time1 && pair.time2);
  }
}

TEST_F(SimulateTest, StandsStillOrTurns) {
  WriteText(Path("rig.json"), kRig);
  const Args street = {"--scene=street", "--rig=" + Path("rig.json"), "--pairs=1"};
  for (const Args& scene : {Args{"--pairs=1"}, street}) {
    const FramePair still = ReadAll(Simulate("still", scene + Args{"--motion=still"}))[0];
    EXPECT_EQ(LogSO3(still.truth->R).norm(), 0);
    EXPECT_EQ(still.truth->t.norm(), 0);
    const FramePair turn =
        ReadAll(Simulate("turn", scene + Args{"--motion=turn", "--rotation_deg=4"}))[0];
    EXPECT_NEAR(RadToDeg(LogSO3(turn.truth->R).norm()), 4, 1e-9);
    EXPECT_EQ(turn.truth->t.norm(), 0);
  }
}

TEST_F(SimulateTest, WrongFlagsOfTheStreet) {
  WriteText(Path("rig.json"), kRig);
  const std::string rig = "--rig=" + Path("rig.json");
  const struct {
    Args args;
    int code;
    const char* what;
  } wrong[] = {
      {{"--scene=road"}, 2, "expected box or street"},
      {{"--scene=street"}, 2, "--rig is missing"},
      {{rig}, 2, "--rig: is of --scene=street"},
      {{"--motion=car"}, 2, "A car needs --scene=street"},
      {{"--scene=street", rig, "--motion=planar"}, 2, "expected car, turn or still"},
      {{"--scene=street", rig, "--motion=turn", "--distance_m=2"}, 2, "--motion=turn has none"},
      {{"--scene=street", rig, "--camera_times=0,1,2"}, 2, "each of the 2 cameras"},
      {{"--scene=street", rig, "--calibration_sigma_m=-1"}, 2, "--calibration_sigma_m must be"},
      {{"--scene=street", rig, "--ring"}, 2, "--ring: is of --scene=box"},
      {{"--scene=street", rig, "--distance_m=-1"}, 2, "--distance_m must be finite"},
      {{"--scene=street", rig, "--ground_m=-5"}, 2, "--ground_m must put the ground below"},
      {{"--scene=street", rig, "--camera_noise_px=1,2,3"}, 2, "each of the 2 cameras"},
      {{"--camera_noise_px=1,x"}, 2, "expected numbers, separated by commas"},
      {{"--camera_noise_px=1,1", "--noise_px=1"}, 2, "--camera_noise_px replaces it"},
      {{"--noise_model=cauchy"}, 2, "expected gaussian, mixture, laplace or t3"},
      {{"--scene=street", "--rig=" + Path("none.json")}, 1, "none.json: cannot be opened"},
  };
  for (const auto& c : wrong) {
    const Outcome run = RunTool("simulate", c.args + Args{"--output=" + Path("out")});
    EXPECT_EXIT_CODE(run, c.code);
    EXPECT_THAT(run.err, HasSubstr(c.what));
  }
  EXPECT_FALSE(std::filesystem::exists(Path("out")));
}

TEST_F(SimulateTest, NoMatchesAreAFileToo) {
  const std::vector<FramePair> pairs = ReadAll(Simulate("none", {"--num_matches=0", "--pairs=1"}));
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_THAT(pairs[0].matches, IsEmpty());
}

TEST_F(SimulateTest, WrongValuesAreUsageErrorsAndLeaveNothing) {
  const std::pair<const char*, const char*> wrong[] = {
      {"--inter_share=1.5", "inter_share"},
      {"--inter_share=-0.1", "inter_share"},
      {"--outlier_share=2", "outlier_share"},
      {"--outlier_share=nan", "outlier_share"},
      {"--moving_share=1.1", "moving_share"},
      {"--moving_share=-0.1", "moving_share"},
      {"--noise_px=-1", "noise_px"},
      {"--noise_px=inf", "noise_px"},
      {"--rotation_deg=nan", "rotation_deg"},
      {"--num_matches=-1", "num_matches"},
      {"--pairs=0", "--pairs"},
      {"--pairs=-3", "--pairs"},
      {"--motion=up", "forward, random, sideways, planar, turn or still"},
      {"--calibration_sigma_deg=-1", "--calibration_sigma_deg must be finite and not negative"},
      {"--calibration_sigma_m=inf", "--calibration_sigma_m must be finite and not negative"},
      {"--state_calibration_sigma", "--state_calibration_sigma needs a calibration_sigma_deg"},
      {"--camera_times=0,x", "--camera_times=x: expected numbers"},
      {"--camera_times=0,1,2", "--camera_times must have a number for each of the 2 cameras"},
      {"--interval_s=0", "--interval_s must be positive and finite"},
      {"--rotation_axis=z", "y or random"},
  };
  for (const auto& [flag, what] : wrong) {
    const Outcome run = RunTool("simulate", {"--output=" + Path("out"), flag});
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, HasSubstr(what));
  }
  const Outcome planar =
      RunTool("simulate", {"--output=" + Path("out"), "--motion=planar", "--rotation_axis=random"});
  EXPECT_EXIT_CODE(planar, 2);
  EXPECT_THAT(planar.err, HasSubstr("--rotation_axis=random contradicts planar motion"));
  const Outcome still =
      RunTool("simulate", {"--output=" + Path("out"), "--motion=still", "--rotation_deg=2"});
  EXPECT_EXIT_CODE(still, 2);
  EXPECT_THAT(still.err, HasSubstr("--rotation_deg: --motion=still has none"));
  const Outcome nowhere = RunTool("simulate", {});
  EXPECT_EXIT_CODE(nowhere, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("--output is missing"));
  EXPECT_FALSE(std::filesystem::exists(Path("out")));
}

TEST_F(SimulateTest, DirectoryIsMadeWithItsParents) {
  EXPECT_EQ(ReadAll(Simulate("a/b/c", {"--pairs=2"})).size(), 2u);
}

// What is left of another run would be read with the files of this one.
TEST_F(SimulateTest, DirectoryWithOtherMatchFilesIsRefused) {
  const std::string output = Simulate("out", {"--pairs=3", "--num_matches=20"});
  WriteText(output + "/notes.txt", "no match file");
  std::filesystem::create_directories(output + "/below.matches");
  Simulate("out", {"--pairs=3", "--num_matches=20"});
  Simulate("out", {"--pairs=5", "--num_matches=20"});
  const std::string before = ReadText(output + "/000000.matches");
  const Outcome fewer =
      RunTool("simulate", {"--output=" + output, "--pairs=4", "--num_matches=10"});
  EXPECT_EXIT_CODE(fewer, 1);
  EXPECT_THAT(Lines(fewer.err),
              testing::ElementsAre(HasSubstr(output + ": holds 000004.matches,")));
  EXPECT_EQ(ReadText(output + "/000000.matches"), before);
  WriteText(output + "/0.matches", "mine");
  const Outcome mine = RunTool("simulate", {"--output=" + output, "--pairs=4"});
  EXPECT_EXIT_CODE(mine, 1);
  EXPECT_THAT(mine.err, HasSubstr("holds 0.matches and 1 more,"));
}

TEST_F(SimulateTest, DirectoryThatCannotBeMadeFails) {
  WriteText(Path("file"), "in the way");
  for (const std::string& output :
       {Path("file"), Path("file") + "/below", std::string("/proc/x")}) {
    const Outcome run = RunTool("simulate", {"--output=" + output, "--pairs=1"});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(run.err, HasSubstr(output));
    EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
  }
}

TEST_F(SimulateTest, FileThatCannotBeWrittenFails) {
  std::filesystem::create_directories(Path("out/000001.matches/below"));
  const Outcome run = RunTool("simulate", {"--output=" + Path("out"), "--pairs=3"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("000001.matches: cannot be written"));
}

TEST_F(SimulateTest, MotionOutOfViewFailsWithAMessage) {
  const Outcome run =
      RunTool("simulate", {"--output=" + Path("out"), "--pairs=1", "--rotation_deg=180"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("in the view of camera"));
  const Outcome apart = RunTool(
      "simulate", {"--output=" + Path("out"), "--ring", "--num_cameras=4", "--inter_share=0.3"});
  EXPECT_EXIT_CODE(apart, 1);
  EXPECT_THAT(apart.err, HasSubstr("neighbours on a ring of fewer than 5 see nothing in common"));
}

}  // namespace
}  // namespace rigel
