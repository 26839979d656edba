// rigel_match: files that are right, runs that can be interrupted, errors that are told.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "rigel/core/metrics.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/test/problems/images/plane_scene.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kFrames = 4;

// Drawn once, for all tests; who changes it works on a copy.
const std::string& Data() {
  static const std::string* const data = [] {
    auto* const path = new std::string(testing::TempDir() + "/rigel_match_XXXXXX");
    EXPECT_NE(mkdtemp(path->data()), nullptr);
    const PlaneScene scene;
    WriteEurocScene(scene, kFrames, *path + "/plane");
    WriteKittiScene(scene, kFrames, "06", *path + "/kitti");
    std::atexit([] { fs::remove_all(Data()); });
    return path;
  }();
  return *data;
}

class MatchTest : public ToolsTest {
 protected:
  // The names of the files of a directory.
  std::vector<std::string> Names(const std::string& directory) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  // All match files of a directory, one after the other, with their names.
  std::string Bytes(const std::string& directory) {
    std::string bytes;
    for (const std::string& name : Names(directory)) {
      bytes += name + "\n" + ReadText(directory + "/" + name);
    }
    return bytes;
  }

  FramePair Read(const std::string& path) {
    FramePair pair;
    std::string error;
    EXPECT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
    return pair;
  }

  Outcome Euroc(const std::string& output, const Args& args = {}) {
    return RunTool("match", Args{"--euroc_root=" + Data() + "/plane", "--max_features=300",
                                 "--output=" + Path(output)} +
                                args);
  }
  Outcome Kitti(const std::string& output, const Args& args = {}) {
    return RunTool("match", Args{"--kitti_root=" + Data() + "/kitti", "--sequence=06",
                                 "--max_features=300", "--output=" + Path(output)} +
                                args);
  }
};

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
    EXPECT_EQ(pair.rig.cameras[k].intrinsics.fy, expected.intrinsics.fy);
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
    const Eigen::Vector3d u1 = pair.rig.cameras[m.camera1].intrinsics.Normalize(m.pixel1);
    const Eigen::Vector3d u2 = pair.rig.cameras[m.camera2].intrinsics.Normalize(m.pixel2);
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

TEST_F(MatchTest, ResumeWithAnotherCalibrationIsRefusedAndWithAnotherPlaceIsNot) {
  fs::copy(Data() + "/kitti", Path("kitti"), fs::copy_options::recursive);
  ASSERT_EXIT_CODE(Kitti("out", {"--last=1"}), 0);
  const std::string root = "--kitti_root=" + Path("kitti");
  EXPECT_EXIT_CODE(Kitti("out", {"--last=2", "--resume", root}), 0);
  const std::string path = Path("kitti/sequences/06/calib.txt");
  std::string calibration = ReadText(path);
  const size_t focal = calibration.find("P0: ") + 4;
  calibration.replace(focal, calibration.find(' ', focal) - focal, "123.5");
  WriteText(path, calibration);
  const Outcome run = Kitti("out", {"--last=2", "--resume", root});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("this run has 'camera 0 focal 123.5 ")));
}

TEST_F(MatchTest, ManyMissingImagesAreFewLines) {
  fs::copy(Data() + "/kitti", Path("kitti"), fs::copy_options::recursive);
  for (const char* camera : {"image_0", "image_1"}) {
    for (int k = 0; k < kFrames; ++k) {
      // The last of one camera stays: frames count to the highest image.
      if (k + 1 == kFrames && camera == std::string("image_1")) continue;
      fs::remove(Path(std::string("kitti/sequences/06/") + camera + "/00000" + std::to_string(k) +
                      ".png"));
    }
  }
  const Outcome run = Kitti("out", {"--kitti_root=" + Path("kitti")});
  EXPECT_EXIT_CODE(run, 1);
  const auto absent = HasSubstr(".png: cannot be opened: No such file or directory");
  EXPECT_THAT(
      Lines(run.err),
      ElementsAre("frame 0, the first of the range, has no images",
                  "2 pairs of the range have no image at all", absent, absent, absent,
                  HasSubstr("wrote 0 match files to " + Path("out") + "; 3 could not be made")));
  // Numbers that are left out, a million of them: their pairs are not even gone through.
  for (const char* camera : {"image_0", "image_1"}) {
    const std::string from = Data() + "/kitti/sequences/06/" + camera;
    const std::string to = Path(std::string("kitti/sequences/06/") + camera);
    fs::copy(from + "/000000.png", to + "/000000.png");
    fs::copy(from + "/000001.png", to + "/000001.png");
    fs::copy(from + "/000003.png", to + "/1000000.png");
  }
  const Outcome gap = Kitti("gap", {"--kitti_root=" + Path("kitti")});
  EXPECT_EXIT_CODE(gap, 1);
  EXPECT_THAT(Lines(gap.err),
              ElementsAre(HasSubstr("times.txt: 4 lines for 1000001 frames"),
                          HasSubstr("06.txt: 4 lines for 1000001 frames"),
                          "999995 pairs of the range have no image at all", absent, absent, absent,
                          absent, absent, "and 2 more images that cannot be opened",
                          HasSubstr("wrote 1 match files to " + Path("gap") +
                                    "; 999999 could not be made")));
  EXPECT_TRUE(fs::exists(Path("gap/000000-000001.matches")));
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

TEST_F(MatchTest, ResumeKeepsWhatIsCompleteAndDoesTheRest) {
  ASSERT_EXIT_CODE(Euroc("whole"), 0);
  const std::string whole = Bytes(Path("whole"));
  // As a run leaves it that was killed: one file missing, one temporary left. One that is cut off,
  // which no run leaves, is made again as well.
  ASSERT_EXIT_CODE(Euroc("out"), 0);
  fs::remove(Path("out/000001-000002.matches"));
  WriteText(Path("out/000001-000002.matches.rigel-tmp0"), "format rigma");
  WriteText(Path("out/000002-000003.matches"), "format rigmatch 1\n");
  const auto before = fs::last_write_time(Path("out/000000-000001.matches"));

  const Outcome refused = Euroc("out");
  EXPECT_EXIT_CODE(refused, 1);
  EXPECT_THAT(Lines(refused.err),
              ElementsAre(AllOf(HasSubstr("holds 000000-000001.matches and 1 more"),
                                HasSubstr("--resume continues that run"))));

  const Outcome run = Euroc("out", {"--resume"});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err), ElementsAre("wrote 2 match files to " + Path("out") + ", kept 1"));
  EXPECT_EQ(Bytes(Path("out")), whole);
  EXPECT_EQ(fs::last_write_time(Path("out/000000-000001.matches")), before);

  const Outcome nothing = Euroc("out", {"--resume"});
  EXPECT_EXIT_CODE(nothing, 0);
  EXPECT_THAT(nothing.err, HasSubstr("wrote 0 match files to " + Path("out") + ", kept 3"));
}

TEST_F(MatchTest, ResumeOfOtherSettingsOrOfOtherFilesIsRefused) {
  ASSERT_EXIT_CODE(Euroc("out", {"--last=1"}), 0);
  const std::string before = Bytes(Path("out"));
  for (const char* flag : {"--features=orb", "--ratio=0.7", "--max_features=200"}) {
    const Outcome run = Euroc("out", {"--resume", flag});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("the match files beside it were made with")));
  }
  const Outcome others = Euroc("out", {"--resume", "--first=1"});
  EXPECT_EXIT_CODE(others, 1);
  EXPECT_THAT(Lines(others.err),
              ElementsAre(HasSubstr("holds 000000-000001.matches, which would")));
  EXPECT_EQ(Bytes(Path("out")), before);
  // A longer range is more of the same.
  const Outcome longer = Euroc("out", {"--resume", "--last=2"});
  EXPECT_EXIT_CODE(longer, 0);
  EXPECT_THAT(longer.err, HasSubstr("wrote 1 match files to " + Path("out") + ", kept 1"));

  fs::remove(Path("out/rigel_match.settings"));
  const Outcome unknown = Euroc("out", {"--resume", "--last=2"});
  EXPECT_EXIT_CODE(unknown, 1);
  EXPECT_THAT(Lines(unknown.err), ElementsAre(HasSubstr("rigel_match.settings: cannot be opened")));
}

TEST_F(MatchTest, MissingAndBrokenImagesCostTheirPairsOnly) {
  fs::copy(Data() + "/kitti", Path("kitti"), fs::copy_options::recursive);
  const std::string root = "--kitti_root=" + Path("kitti");
  const std::string image0 = Path("kitti/sequences/06/image_0/000000.png");
  fs::remove(image0);
  const Outcome missing = Kitti("out", {root});
  EXPECT_EXIT_CODE(missing, 1);
  EXPECT_THAT(Lines(missing.err),
              ElementsAre(image0 + ": cannot be opened: No such file or directory",
                          "wrote 2 match files to " + Path("out") + "; 1 could not be made"));
  EXPECT_THAT(Names(Path("out")), ElementsAre("000001-000002.matches", "000002-000003.matches",
                                              "rigel_match.settings"));

  // Said once, though two pairs need it.
  WriteText(Path("kitti/sequences/06/image_1/000002.png"), "not an image");
  const Outcome broken = Kitti("broken", {root, "--threads=2"});
  EXPECT_EXIT_CODE(broken, 1);
  EXPECT_THAT(Lines(broken.err),
              ElementsAre(HasSubstr("image_0/000000.png: cannot be opened"),
                          HasSubstr("image_1/000002.png: not an image that can be decoded"),
                          HasSubstr("wrote 0 match files")));

  fs::copy(Data() + "/kitti/sequences/06/image_0/000000.png", image0);
  const Outcome resumed = Kitti("out", {root, "--resume"});
  EXPECT_EXIT_CODE(resumed, 0);
  EXPECT_THAT(resumed.err, HasSubstr("wrote 1 match files to " + Path("out") + ", kept 2"));
}

TEST_F(MatchTest, ImagesOfDifferentSizesAreTold) {
  fs::copy(Data() + "/kitti", Path("kitti"), fs::copy_options::recursive);
  const std::string image = Path("kitti/sequences/06/image_1/000001.png");
  ImageCamera camera = PlaneScene().cameras()[0];
  camera.camera.intrinsics.width = 400;
  WriteImage(image, PlaneScene().Render(camera, PlaneScene::WorldFromBody(1)));
  const Outcome run = Kitti("out", {"--kitti_root=" + Path("kitti"), "--last=1"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("not written: the images of camera 1 differ in size"));
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

TEST_F(MatchTest, RangesBeyondTheSequenceAreToldBeforeAnythingIsDone) {
  for (const char* flag : {"--last=4", "--first=4", "--first=1000000"}) {
    const Outcome run = Kitti("out", {flag});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err),
                ElementsAre(HasSubstr("is not there: sequence 06 has 4 frames, 0 to 3")));
  }
  const Outcome one = Kitti("out", {"--first=3"});
  EXPECT_EXIT_CODE(one, 1);
  EXPECT_THAT(one.err, HasSubstr("no pair of frames in the range: sequence 06 has 4 frames"));
  EXPECT_FALSE(fs::exists(Path("out")));
}

TEST_F(MatchTest, WhatIsMissingOrBrokenIsOneLine) {
  EXPECT_THAT(Kitti("out", {"--sequence=07"}).err, HasSubstr("sequences/07: no such directory"));
  const Outcome nowhere = Euroc("out", {"--euroc_root=" + Path("none")});
  EXPECT_EXIT_CODE(nowhere, 1);
  EXPECT_THAT(Lines(nowhere.err), ElementsAre(HasSubstr("expected EuRoC's folder mav0")));
  fs::copy(Data() + "/plane", Path("plane"), fs::copy_options::recursive);
  WriteText(Path("plane/mav0/cam1/sensor.yaml"), "T_BS: [\n");
  const Outcome yaml = Euroc("out", {"--euroc_root=" + Path("plane")});
  EXPECT_EXIT_CODE(yaml, 1);
  EXPECT_THAT(Lines(yaml.err), ElementsAre(HasSubstr("cam1/sensor.yaml:")));
  WriteText(Path("file"), "in the way");
  const Outcome file = Euroc("file");
  EXPECT_EXIT_CODE(file, 1);
  EXPECT_THAT(Lines(file.err), ElementsAre(HasSubstr(Path("file") + ": cannot be")));
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

TEST_F(MatchTest, ABlankLineInTimesIsRefused) {
  fs::copy(Data() + "/kitti", Path("kitti"), fs::copy_options::recursive);
  WriteText(Path("kitti/sequences/06/times.txt"), "0\n\n0.2\n0.3\n");
  const Outcome run = Kitti("out", {"--kitti_root=" + Path("kitti")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("times.txt:2: a blank line, expected")));
  EXPECT_FALSE(fs::exists(Path("out")));
}

TEST_F(MatchTest, WrongFlagsAreUsageErrorsAndLeaveNothing) {
  const std::pair<Args, const char*> wrong[] = {
      {{"--first=3", "--last=2"}, "--last: expected at least first + stride"},
      {{"--first=2", "--last=2"}, "--last: expected at least first + stride"},
      {{"--last=2", "--stride=3"}, "--last: expected at least first + stride"},
      {{"--first=-1"}, "--first: expected 0 or more"},
      {{"--last=-1"}, "--last=-1: expected 0 or more"},
      {{"--stride=0"}, "--stride: expected at least 1"},
      {{"--features=surf"}, "--features=surf: expected sift or orb"},
      {{"--ratio=0"}, "--ratio: expected above 0, at most 1"},
      {{"--ratio=1.1"}, "--ratio: expected above 0, at most 1"},
      {{"--ratio=nan"}, "--ratio: expected above 0, at most 1"},
      {{"--max_features=0"}, "--max_features: expected 1 to 20000"},
      {{"--threads=0"}, "--threads=0: expected 1 to 1024"},
      {{"--output="}, "--output is missing"},
      {{"--sync_tolerance_ms=5"}, "--sync_tolerance_ms: KITTI has one time stamp"},
      {{"--sequence="}, "--sequence is missing"},
      {{"--sequence=../06"}, "--sequence: expected the name of a directory"},
      {{"--sequence=0 6"}, "--sequence: expected the name of a directory"},
      {{"--euroc_root=x"}, "--kitti_root and --euroc_root: expected one of them"},
      {{"--kitti_root="}, "--kitti_root or --euroc_root is missing"},
      {{"--kitti_root=", "--euroc_root=x"}, "--sequence: has no effect with --euroc_root"},
  };
  for (const auto& [flags, what] : wrong) {
    const Outcome run = Kitti("out", flags);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, HasSubstr(what));
  }
  EXPECT_FALSE(fs::exists(Path("out")));
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
