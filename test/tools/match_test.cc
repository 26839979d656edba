// rigel_match: files that are right.
#include <cstdlib>
#include <filesystem>

#include "rigel/core/metrics.h"
#include "rigel/test/tools/match_runs.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(MatchTest, EurocFilesHoldWhatTheDataSetKnows) {
  const Outcome run = Euroc("out");
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_THAT(Lines(run.err), ElementsAre("wrote 3 match files to " + Path("out")));
  EXPECT_THAT(Names(Path("out")), ElementsAre("000000-000001.matches", "000001-000002.matches",
                                              "000002-000003.matches", "rigel_match.settings"));
  const PlaneScene scene;
  const FramePair pair = Read(Path("out/000001-000002.matches"));
  EXPECT_EQ(pair.sequence, "plane");
  ASSERT_EQ(pair.rig.size(), 2);
  for (int k = 0; k < 2; ++k) {
    const RigCamera& expected = scene.cameras()[k].camera;
    EXPECT_NEAR((pair.rig.cameras[k].Q - expected.Q).norm(), 0, 1e-12);
    EXPECT_EQ(pair.rig.cameras[k].s, expected.s);
    EXPECT_EQ(pair.rig.cameras[k].intrinsics.fy(), expected.intrinsics.fy());
    EXPECT_EQ(pair.rig.cameras[k].intrinsics.width, 376);
  }
  const Pose world_from_1 = PlaneScene::WorldFromBody(1);
  const Pose world_from_2 = PlaneScene::WorldFromBody(2);
  ASSERT_TRUE(pair.truth && pair.time1 && pair.time2);
  EXPECT_NEAR(*pair.time1, 1e-9 * PlaneSceneTime(1), 1e-6);
  EXPECT_NEAR(*pair.time2 - *pair.time1, 0.05, 1e-6);
  const Pose truth = world_from_2.Inverse() * world_from_1;
  EXPECT_NEAR(RotationError(pair.truth->R, truth.R), 0, 1e-12);
  EXPECT_NEAR((pair.truth->t - truth.t).norm(), 0, 1e-12);
  ASSERT_TRUE(pair.prior.gravity1 && pair.prior.gravity2);
  EXPECT_FALSE(pair.prior.gravity_sigma.has_value());
  const Eigen::Vector3d down(0, 0, -1);
  EXPECT_NEAR((world_from_1.R * *pair.prior.gravity1 - down).norm(), 0, 1e-9);
  EXPECT_NEAR((world_from_2.R * *pair.prior.gravity2 - down).norm(), 0, 1e-9);

  int count[2][2] = {}, good = 0;
  for (const Match& m : pair.matches) {
    ++count[m.camera1][m.camera2];
    const Eigen::Vector2d expected =
        scene.Transfer(pair.rig.cameras[m.camera1], world_from_1, m.pixel1,
                       pair.rig.cameras[m.camera2], world_from_2);
    good += (m.pixel2 - expected).norm() < 0.5 ? 1 : 0;
  }
  for (const auto& of_camera1 : count) {
    for (const int n : of_camera1) EXPECT_GT(n, 40);
  }
  EXPECT_GT(good, 0.9 * static_cast<double>(pair.matches.size()));
}

TEST_F(MatchTest, KittiFilesHoldWhatTheDataSetKnows) {
  const Outcome run = Kitti("out", {"--stride=2", "--last=3"});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(Names(Path("out")), ElementsAre("000000-000002.matches", "rigel_match.settings"));
  const FramePair pair = Read(Path("out/000000-000002.matches"));
  EXPECT_EQ(pair.sequence, "06");
  EXPECT_EQ(pair.time2, 0.2);
  EXPECT_EQ(pair.rig.cameras[1].s, Eigen::Vector3d(0.5, 0, 0));
  EXPECT_EQ(pair.rig.cameras[1].intrinsics.width, 376);
  EXPECT_EQ(pair.rig.cameras[1].intrinsics.height, 240);
  ASSERT_TRUE(pair.truth && pair.prior.gravity1 && pair.prior.gravity2);
  EXPECT_NEAR((*pair.prior.gravity1 - Eigen::Vector3d::UnitY()).norm(), 0, 1e-9);
  EXPECT_NEAR((pair.truth->R * *pair.prior.gravity1 - *pair.prior.gravity2).norm(), 0, 1e-9);
  EXPECT_FALSE(pair.prior.gravity_sigma.has_value());
  int intra = 0, good = 0;
  for (const Match& m : pair.matches) {
    intra += m.IsIntra() ? 1 : 0;
    const Eigen::Vector3d u1 = AlongRay(pair.rig.cameras[m.camera1].intrinsics, m.pixel1);
    const Eigen::Vector3d u2 = AlongRay(pair.rig.cameras[m.camera2].intrinsics, m.pixel2);
    const Eigen::Vector3d b = pair.truth->R * pair.rig.cameras[m.camera1].s + pair.truth->t -
                              pair.rig.cameras[m.camera2].s;
    const Eigen::Vector3d plane = b.cross(pair.truth->R * u1);
    good += std::abs(u2.dot(plane)) / plane.head<2>().norm() * 229 < 0.5 ? 1 : 0;
  }
  EXPECT_GT(intra, 100);
  EXPECT_GT(static_cast<int>(pair.matches.size()) - intra, 100);
  EXPECT_GT(good, 0.9 * static_cast<double>(pair.matches.size()));
}

TEST_F(MatchTest, WithoutTimesAndPosesThereAreNoSuchLines) {
  fs::copy(Data() + "/kitti", Path("kitti"), fs::copy_options::recursive);
  fs::remove(Path("kitti/sequences/06/times.txt"));
  fs::remove_all(Path("kitti/poses"));
  const std::string root = "--kitti_root=" + Path("kitti");
  const Outcome run = Kitti("out", {"--last=1", root});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err), ElementsAre("sequence 06 has no ground truth: the files get no truth "
                                          "and no gravity",
                                          HasSubstr("wrote 1 match files")));
  const std::string text = ReadText(Path("out/000000-000001.matches"));
  for (const char* keyword : {"\ntime", "\ntruth", "\ngravity"}) {
    EXPECT_THAT(text, Not(HasSubstr(keyword)));
  }
  // The truth came later: files with and without it would be mixed.
  fs::copy(Data() + "/kitti/poses", Path("kitti/poses"), fs::copy_options::recursive);
  const Outcome resumed = Kitti("out", {root, "--resume"});
  EXPECT_EXIT_CODE(resumed, 1);
  EXPECT_THAT(Lines(resumed.err), ElementsAre(AllOf(HasSubstr("made with 'truth no'"),
                                                    HasSubstr("this run has 'truth yes'"))));
  EXPECT_THAT(Names(Path("out")), ElementsAre("000000-000001.matches", "rigel_match.settings"));
}

TEST_F(MatchTest, ThreadsAndRepetitionGiveTheSameBytes) {
  for (const char* features : {"--features=sift", "--features=orb"}) {
    const std::string name = std::string(features).substr(11);
    ASSERT_EXIT_CODE(Euroc(name + "1", {features}), 0);
    ASSERT_EXIT_CODE(Euroc(name + "2", {features, "--threads=2"}), 0);
    ASSERT_EXIT_CODE(Euroc(name + "7", {features, "--threads=7"}), 0);
    EXPECT_EQ(Bytes(Path(name + "1")), Bytes(Path(name + "2")));
    EXPECT_EQ(Bytes(Path(name + "1")), Bytes(Path(name + "7")));
  }
  EXPECT_NE(Bytes(Path("sift1")), Bytes(Path("orb1")));
}

TEST_F(MatchTest, NothingMatchedIsAFileToo) {
  fs::copy(Data() + "/plane", Path("plane"), fs::copy_options::recursive);
  for (const char* camera : {"cam0", "cam1"}) {
    for (const auto& image :
         fs::directory_iterator(Path("plane/mav0/" + std::string(camera) + "/data"))) {
      WriteImage(image.path().string(), cv::Mat(240, 376, CV_8U, cv::Scalar(128)));
    }
  }
  ASSERT_EXIT_CODE(Euroc("out", {"--euroc_root=" + Path("plane")}), 0);
  EXPECT_THAT(Read(Path("out/000000-000001.matches")).matches, IsEmpty());
  EXPECT_EXIT_CODE(Euroc("out", {"--euroc_root=" + Path("plane"), "--resume"}), 0);
}

TEST_F(MatchTest, ImagesWithoutPartnerAreLeftOutAndSaidToBe) {
  fs::copy(Data() + "/plane", Path("plane"), fs::copy_options::recursive);
  const std::string list = Path("plane/mav0/cam1/data.csv");
  const std::vector<std::string> lines = Lines(ReadText(list));
  WriteText(list, lines[1] + "\n" + lines[3] + "\n" + lines[4] + "\n");
  const Outcome run = Euroc("out", {"--euroc_root=" + Path("plane")});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err),
              ElementsAre(HasSubstr("cam0/data.csv: 1 of 4 images are left out: no image of cam1"),
                          "wrote 2 match files to " + Path("out")));
  const FramePair pair = Read(Path("out/000000-000001.matches"));
  EXPECT_NEAR(*pair.time2 - *pair.time1, 0.1, 1e-6);
}

TEST_F(MatchTest, StampsOfARecordingDifferByMicroseconds) {
  fs::copy(Data() + "/plane", Path("plane"), fs::copy_options::recursive);
  const std::string root = "--euroc_root=" + Path("plane");
  std::string images;
  for (int k = 0; k < 3; ++k) {
    images += std::to_string(PlaneSceneTime(k) + 31000 + 1000 * k) + "," +
              std::to_string(PlaneSceneTime(k)) + ".png\n";
  }
  WriteText(Path("plane/mav0/cam1/data.csv"), images);
  const Outcome run = Euroc("out", {root});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, AllOf(HasSubstr("time stamps of cam0 and cam1 differ by up to 0.033 ms, "
                                       "within 5 ms, a tenth of the frame interval"),
                             HasSubstr("wrote 2 match files")));
  // With another tolerance the numbers of frames would be those of others.
  const Outcome resumed = Euroc("out", {root, "--resume", "--sync_tolerance_ms=0.0325"});
  EXPECT_EXIT_CODE(resumed, 1);
  EXPECT_THAT(resumed.err, HasSubstr("which would be read as if it were of this run"));
  const Outcome exact = Euroc("exact", {root, "--sync_tolerance_ms=0"});
  EXPECT_EXIT_CODE(exact, 1);
  EXPECT_THAT(exact.err, HasSubstr("the nearest are 0.031 ms apart"));
  EXPECT_EXIT_CODE(Euroc("wrong", {root, "--sync_tolerance_ms=-1"}), 2);
}

TEST_F(MatchTest, RealImagesGiveTheMotionOfTheCar) {
  const char* folder = std::getenv("RIGEL_REAL_DATA");
  if (folder == nullptr || *folder == '\0') {
    GTEST_SKIP() << "RIGEL_REAL_DATA is not set: no real images to test with";
  }
  const std::string root = std::string(folder) + "/kitti_odometry";
  const Outcome run = RunTool("match", {"--kitti_root=" + root, "--sequence=06", "--first=20",
                                        "--last=27", "--output=" + Path("out"), "--threads=2"});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, HasSubstr("wrote 7 match files"));
  const Outcome compare =
      RunTool("compare", {"--matches=" + Path("out"), "--prior=body", "--json=-"});
  ASSERT_EXIT_CODE(compare, 0);
  const Json results = ParseReport(compare.out)["results"];
  EXPECT_GE(results.size(), 13u);
  for (const Json& entry : results) {
    EXPECT_EQ(entry.at("pairs"), 7);
    EXPECT_EQ(entry.at("failures"), 0) << entry["solver"];
    // at(): a statistic that is left out fails, too.
    const Json& refined = entry.at("refined");
    EXPECT_LE(refined.at("rotation_deg").at("median"), 0.05) << entry["solver"];
    EXPECT_LE(refined.at("translation_dir_deg").at("median"), 0.35) << entry["solver"];
    EXPECT_LE(refined.at("scale").at("median"), 0.01) << entry["solver"];
  }
}

}  // namespace
}  // namespace rigel
