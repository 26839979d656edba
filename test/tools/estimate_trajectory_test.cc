// rigel_estimate's trajectory files, read as evo reads them, and its drift report.
#include <cmath>
#include <fstream>
#include <sstream>

#include <Eigen/LU>

#include "rigel/core/pose.h"
#include "rigel/problems/io/kitti_poses.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

// Columns parted by one blank, the same number in each line; lines that start with # are comments.
std::vector<std::vector<double>> Rows(const std::string& path, size_t columns) {
  std::vector<std::vector<double>> rows;
  for (const std::string& line : Lines(ReadText(path))) {
    if (line[0] == '#') continue;
    std::vector<double> row;
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ' ');) {
      size_t used = 0;
      row.push_back(std::stod(word, &used));
      EXPECT_EQ(used, word.size()) << line;
      EXPECT_TRUE(std::isfinite(row.back())) << line;
    }
    EXPECT_EQ(row.size(), columns) << line;
    rows.push_back(row);
  }
  return rows;
}

std::vector<Pose> ReadKitti(const std::string& path) {
  EXPECT_THAT(ReadText(path), Not(HasSubstr("#")));
  std::vector<Pose> poses;
  for (const std::vector<double>& m : Rows(path, 12)) {
    Pose pose;
    pose.R << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
    pose.t << m[3], m[7], m[11];
    EXPECT_LT((pose.R.transpose() * pose.R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_GT(pose.R.determinant(), 0);
    poses.push_back(pose);
  }
  return poses;
}

std::vector<Pose> ReadTum(const std::string& path, std::vector<double>* times) {
  std::vector<Pose> poses;
  times->clear();
  for (const std::vector<double>& m : Rows(path, 8)) {
    if (!times->empty()) {
      EXPECT_GT(m[0], times->back());
    }
    times->push_back(m[0]);
    const Eigen::Quaterniond q(m[7], m[4], m[5], m[6]);
    EXPECT_NEAR(q.norm(), 1.0, 1e-14);
    poses.push_back(Pose::FromQuaternion(q, {m[1], m[2], m[3]}));
  }
  return poses;
}

void ExpectSame(const std::vector<Pose>& a, const std::vector<Pose>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k) {
    EXPECT_LT((a[k].R - b[k].R).norm(), tolerance) << k;
    EXPECT_LT((a[k].t - b[k].t).norm(), tolerance) << k;
  }
}

class EstimateTrajectoryTest : public ToolsTest {
 protected:
  // A circle of radius 20 m, `frames` frames 1 m apart, as KITTI has it; its match files with
  // times.
  std::string Drive(int frames) {
    std::ostringstream poses;
    poses.precision(17);
    for (int k = 0; k < frames; ++k) {
      const double a = 0.05 * k;
      poses << std::cos(a) << " 0 " << std::sin(a) << " " << 20 * (1 - std::cos(a)) << " 0 1 0 0 "
            << -std::sin(a) << " 0 " << std::cos(a) << " " << 20 * std::sin(a) << "\n";
    }
    WriteText(Path("poses/03.txt"), poses.str());
    const Outcome run = RunTool("simulate", {"--output=" + Path("in"), "--poses=" + Path("poses"),
                                             "--inter_share=0.5", "--noise_px=0.2"});
    EXPECT_EXIT_CODE(run, 0);
    for (int k = 0; k + 1 < frames; ++k) {
      char name[32];
      std::snprintf(name, sizeof(name), "in/%06d.matches", k);
      const std::string text = ReadText(Path(name));
      WriteText(Path(name), "time " + std::to_string(0.1 * k) + " " +
                                std::to_string(0.1 * (k + 1)) + "\n" + text);
    }
    return Path("in");
  }
};

TEST_F(EstimateTrajectoryTest, FilesHoldTheDriveAndAgree) {
  const std::string matches = Drive(31);
  const Outcome run =
      RunTool("estimate",
              {"--matches=" + matches, "--kitti_trajectory=" + Path("k.txt"),
               "--tum_trajectory=" + Path("t.tum"), "--truth_trajectory", "--json=" + Path("j")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, IsEmpty());
  const std::vector<Pose> kitti = ReadKitti(Path("k.txt"));
  ASSERT_THAT(kitti, SizeIs(31));
  std::vector<double> times;
  ExpectSame(ReadTum(Path("t.tum"), &times), kitti, 1e-13);
  EXPECT_NEAR(times.back(), 3.0, 1e-12);
  EXPECT_THAT(ReadText(Path("t.tum")), testing::StartsWith("# body: down +y, forward +z\n"));
  ExpectSame(ReadTum(Path("t_truth.tum"), &times), ReadKitti(Path("k_truth.txt")), 1e-13);
  // What went in comes out, exactly and with noise.
  std::vector<Pose> driven;
  std::string error;
  ASSERT_TRUE(ReadKittiPoses(Path("poses/03.txt"), &driven, &error)) << error;
  ExpectSame(ReadKitti(Path("k_truth.txt")), driven, 1e-9);
  ExpectSame(kitti, driven, 0.5);
  EXPECT_GT((kitti.back().t - driven.back().t).norm(), 1e-4);

  const Json report = ParseReport(ReadText(Path("j")));
  for (const char* flag : {"kitti_trajectory", "tum_trajectory", "truth_trajectory", "drift"}) {
    EXPECT_FALSE(report["options"].contains(flag));
  }
  ASSERT_THAT(report["trajectories"], SizeIs(1));
  const Json entry = report["trajectories"][0];
  EXPECT_EQ(entry["pairs"], 30);
  EXPECT_EQ(entry["sequence"], "03");
  EXPECT_EQ(entry["first_pair"], matches + "/000000.matches");
  EXPECT_EQ(entry["last_pair"], matches + "/000029.matches");
  EXPECT_NEAR(entry["path_m"].get<double>(), 30.0, 0.1);
  EXPECT_NEAR(entry["refined"]["end"]["translation_m"].get<double>(),
              (kitti.back().t - driven.back().t).norm(), 1e-8);
  EXPECT_NEAR(entry["refined"]["start"]["translation_m"].get<double>(),
              (kitti.back().Inverse().t - driven.back().Inverse().t).norm(), 1e-8);
  EXPECT_LT(entry["refined"]["kitti"]["translation_percent"],
            entry["raw"]["kitti"]["translation_percent"]);
  EXPECT_EQ(entry["refined"]["kitti"]["by_length"][1]["length_m"], 20);
  EXPECT_EQ(entry["refined"]["kitti"]["start_step"], 1);
  EXPECT_THAT(run.out, AllOf(HasSubstr("100 m]"), HasSubstr("over 10 and 20 m from every frame")));
  EXPECT_LE(Width(run.out), 100u);
}

TEST_F(EstimateTrajectoryTest, GapEndsATrajectoryAndTheOutputSaysSo) {
  const std::string matches = Drive(7);
  WriteText(matches + "/000002.matches", "broken\n");
  const Outcome run =
      RunTool("estimate", {"--matches=" + matches, "--drift", "--tum_trajectory=" + Path("t.txt")});
  EXPECT_EXIT_CODE(run, 1);  // a file could not be read
  EXPECT_THAT(run.err, AllOf(HasSubstr("000003.matches: a pair is missing before it"),
                             HasSubstr("trajectory 0, 2 pairs, is in"),
                             HasSubstr("trajectory 1, 3 pairs, is in")));
  std::vector<double> times;
  EXPECT_THAT(ReadTum(Path("t_0.txt"), &times), SizeIs(3));
  EXPECT_THAT(ReadTum(Path("t_1.txt"), &times), SizeIs(4));
  EXPECT_NEAR(times.front(), 0.3, 1e-12);
  EXPECT_FALSE(std::ifstream(Path("t.txt")).good());
  const Outcome one = RunTool("estimate", {"--matches=" + matches, "--tum_trajectory=-"});
  EXPECT_EXIT_CODE(one, 1);
  EXPECT_THAT(one.err, HasSubstr("stdout takes one"));
  EXPECT_THAT(one.out, IsEmpty());
}

TEST_F(EstimateTrajectoryTest, RefinementIsNotNeeded) {
  const std::string matches = Drive(5);
  const Outcome run = RunTool(
      "estimate", {"--matches=" + matches, "--refine=none", "--drift", "--json=" + Path("j")});
  EXPECT_EXIT_CODE(run, 0);
  const Json entry = ParseReport(ReadText(Path("j")))["trajectories"][0];
  EXPECT_TRUE(entry.contains("raw"));
  EXPECT_FALSE(entry.contains("refined"));
}

TEST_F(EstimateTrajectoryTest, WhatCannotBeDoneIsSaid) {
  const std::string intra = Simulate("intra", {"--pairs=2", "--num_matches=60"});
  const Outcome none = RunTool(
      "estimate", {"--matches=" + intra, "--kitti_trajectory=" + Path("k.txt"), "--json=-"});
  EXPECT_EXIT_CODE(none, 1);
  EXPECT_THAT(Lines(none.err),
              ElementsAre(AllOf(HasSubstr("000000.matches: length of translation not determined"),
                                HasSubstr("(2 files alike)")),
                          "trajectory: no motion to chain"));
  EXPECT_THAT(ParseReport(none.out)["trajectories"], SizeIs(0));
  const Outcome shard = RunTool(
      "estimate", {"--matches=" + intra, "--shard=0/3", "--drift", "--json=" + Path("shard")});
  EXPECT_EXIT_CODE(shard, 0);  // the shard of no files
  EXPECT_THAT(shard.err, IsEmpty());
  const std::string full = "/proc/nonexistent/of/rigel.txt";
  const std::string inter = Simulate("inter", {"--pairs=1", "--inter_share=0.5"});
  const Outcome write = RunTool("estimate", {"--matches=" + inter, "--kitti_trajectory=" + full});
  EXPECT_EXIT_CODE(write, 1);
  EXPECT_THAT(Lines(write.err), ElementsAre(HasSubstr(full + ": cannot be written")));
  for (const Args& args : std::vector<Args>{{"--truth_trajectory"},
                                            {"--kitti_trajectory=-", "--tum_trajectory=-"},
                                            {"--kitti_trajectory=-", "--truth_trajectory"}}) {
    const Outcome usage = RunTool("estimate", Args{"--matches=/proc/nonexistent/of/rigel"} + args);
    EXPECT_EXIT_CODE(usage, 2);
    EXPECT_THAT(usage.err, Not(HasSubstr("/nonexistent")));
  }
}

TEST_F(EstimateTrajectoryTest, TwoOutputsInOneFileAreRefused) {
  const Args matches = {"--matches=/proc/nonexistent/of/rigel"};
  const Args flags = {"json", "csv", "g2o", "kitti_trajectory", "tum_trajectory"};
  for (size_t k = 0; k < flags.size(); ++k) {
    for (size_t i = 0; i < k; ++i) {
      // The same file by two names.
      const Outcome run = RunTool("estimate", matches + Args{"--" + flags[i] + "=" + Path("f"),
                                                             "--" + flags[k] + "=" + Path("./f")});
      EXPECT_EXIT_CODE(run, 2);
      EXPECT_THAT(run.err, HasSubstr(": --" + flags[i] + " writes to this file already"));
    }
  }
  const std::string inter = Simulate("inter", {"--pairs=1", "--inter_share=0.5"});
  EXPECT_EXIT_CODE(
      RunTool("estimate", {"--matches=" + inter, "--json=/dev/null", "--csv=/dev/null"}), 0);
}

}  // namespace
}  // namespace rigel
