// rigel_match with a rig file: raw pixels of three lenses, one of them a fisheye's.
#include <cmath>
#include <cstdio>

#include "rigel/core/median.h"
#include "rigel/problems/io/track_file.h"
#include "rigel/test/tools/match_runs.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

// A pinhole, a lens with distortion and a fisheye, whose pixels are those of their images.
std::vector<ImageCamera> Cameras(const PlaneScene& scene) {
  std::vector<ImageCamera> cameras = {scene.cameras()[0], scene.cameras()[1], scene.cameras()[0]};
  cameras[0].lens.reset();
  cameras[1].camera.intrinsics = *cameras[1].lens;
  cameras[1].lens.reset();
  Camera fisheye = Camera::Pinhole(190, 191, 187, 121, 376, 240);
  fisheye.model = CameraModel::kOpencvFisheye;
  fisheye.parameters[4] = -0.02;
  cameras[2].lens.reset();
  cameras[2].camera.intrinsics = fisheye;
  cameras[2].camera.s.y() += 0.06;
  return cameras;
}

constexpr const char* kNames[] = {"left", "right", "fisheye"};

std::string ImageName(int frame) {
  char name[32];
  std::snprintf(name, sizeof(name), "/%06d.png", frame);
  return name;
}

// Writes directory/rig.json and directory/NAME/000000.png, ...
void WriteRigScene(const std::string& directory) {
  const PlaneScene scene;
  Json rig = {{"format", "rigel-rig 1"}, {"name", "three"}, {"forward", {0, 0, 1}}};
  for (size_t k = 0; k < std::size(kNames); ++k) {
    const ImageCamera camera = Cameras(scene)[k];
    const Camera& c = camera.camera.intrinsics;
    const Eigen::Quaterniond q(camera.camera.Q);
    const Eigen::Vector3d& s = camera.camera.s;
    rig["cameras"].push_back(
        {{"name", kNames[k]},
         {"model", CameraModelName(c.model)},
         {"parameters",
          std::vector<double>(c.parameters, c.parameters + NumCameraParameters(c.model))},
         {"width", c.width},
         {"height", c.height},
         {"q", {q.w(), q.x(), q.y(), q.z()}},
         {"s", {s.x(), s.y(), s.z()}}});
    for (int frame = 0; frame < kFrames; ++frame) {
      WriteImage(directory + "/" + kNames[k] + ImageName(frame),
                 scene.Render(camera, PlaneScene::WorldFromBody(frame)));
    }
  }
  WriteFile(directory + "/rig.json", rig.dump());
}

const std::string& RigData() {
  static const std::string* const data = [] {
    auto* const path = new std::string(Data() + "/rig");
    WriteRigScene(*path);
    return path;
  }();
  return *data;
}

class MatchRigTest : public MatchTest {
 protected:
  Outcome Run(const std::string& data, const std::string& output, const Args& args = {}) {
    return RunTool("match",
                   Args{"--rig=" + data + "/rig.json", "--images=" + data + "/{camera}/{frame}.png",
                        "--max_features=300", "--output=" + Path(output)} +
                       args);
  }
  // A copy of the images that a test may change.
  std::string Copy() {
    fs::copy(RigData(), Path("data"), fs::copy_options::recursive);
    return Path("data");
  }
};

TEST_F(MatchRigTest, MatchesOfAllLensesFollowTheGeometry) {
  const Outcome run = Run(RigData(), "out");
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err),
              ElementsAre("cameras that are matched with each other, as their fields of view "
                          "overlap: left-right, left-fisheye, right-fisheye",
                          "wrote 3 match files to " + Path("out")));
  const PlaneScene scene;
  const std::vector<ImageCamera> cameras = Cameras(scene);
  const FramePair pair = Read(Path("out/000001-000002.matches"));
  EXPECT_EQ(pair.sequence, "three");
  EXPECT_EQ(pair.prior.forward, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(pair.truth || pair.time1 || pair.prior.gravity1);
  ASSERT_EQ(pair.rig.size(), 3);
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(SameLens(pair.rig.cameras[k].intrinsics, cameras[k].camera.intrinsics));
  }
  std::vector<double> errors[3][3];
  for (const Match& m : pair.matches) {
    const Eigen::Vector2d expected =
        scene.Transfer(cameras[m.camera1].camera, PlaneScene::WorldFromBody(1), m.pixel1,
                       cameras[m.camera2].camera, PlaneScene::WorldFromBody(2));
    errors[m.camera1][m.camera2].push_back((m.pixel2 - expected).norm());
  }
  for (auto& of_camera : errors) {
    for (std::vector<double>& of_pair : of_camera) {
      ASSERT_GT(of_pair.size(), 30u);
      EXPECT_LT(MedianInPlace(&of_pair), 0.3);
    }
  }
  // Most points are seen by several cameras.
  ASSERT_EQ(pair.columns.landmark.size(), pair.matches.size());
  const int64_t landmarks =
      1 + *std::max_element(pair.columns.landmark.begin(), pair.columns.landmark.end());
  EXPECT_GT(landmarks, 100);
  EXPECT_LT(landmarks, static_cast<int64_t>(pair.matches.size()) / 2);

  const Outcome plain = Run(RigData(), "plain", {"--landmarks=false", "--camera_pairs=right-2"});
  ASSERT_EXIT_CODE(plain, 0);
  const FramePair without = Read(Path("plain/000001-000002.matches"));
  EXPECT_THAT(without.columns.landmark, SizeIs(0));
  size_t expected = 0;
  for (const auto& [i, j] : {std::pair(0, 0), {1, 1}, {2, 2}, {1, 2}, {2, 1}}) {
    expected += errors[i][j].size();
  }
  EXPECT_EQ(without.matches.size(), expected);
}

TEST_F(MatchRigTest, ThreadsGiveTheSameBytesAndTracksSpanTheDrive) {
  const Args tracks1 = {"--tracks=" + Path("1.tracks")}, tracks3 = {"--tracks=" + Path("3.tracks")};
  ASSERT_EXIT_CODE(Run(RigData(), "one", tracks1), 0);
  const Outcome run = Run(RigData(), "three", tracks3 + Args{"--threads=3"});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err), Contains(AllOf(HasSubstr("landmarks with"), HasSubstr("3.tracks"))));
  EXPECT_EQ(Bytes(Path("one")), Bytes(Path("three")));
  EXPECT_EQ(ReadText(Path("1.tracks")), ReadText(Path("3.tracks")));

  Tracks tracks;
  std::string error;
  ASSERT_TRUE(ReadTrackFile(Path("1.tracks"), &tracks, &error)) << error;
  EXPECT_EQ(tracks.sequence, "three");
  EXPECT_EQ(tracks.frames.size(), 4u);
  // How many landmarks are seen in all frames, and how far the truth has them from their pixels.
  std::map<int64_t, std::vector<Observation>> landmarks;
  for (const Observation& o : tracks.observations) landmarks[o.landmark].push_back(o);
  const PlaneScene scene;
  std::vector<double> errors;
  int long_ones = 0;
  for (const auto& [landmark, rows] : landmarks) {
    const Observation &a = rows.front(), &b = rows.back();
    if (a.frame != 0 || b.frame != 3) continue;
    ++long_ones;
    errors.push_back(
        (scene.Transfer(tracks.rig.cameras[a.camera], PlaneScene::WorldFromBody(0), a.pixel,
                        tracks.rig.cameras[b.camera], PlaneScene::WorldFromBody(3)) -
         b.pixel)
            .norm());
  }
  EXPECT_GT(long_ones, 50);
  EXPECT_LT(MedianInPlace(&errors), 0.5);
}

TEST_F(MatchRigTest, ThereAreNoKeyPointsWhereTheMaskIsBlack) {
  cv::Mat mask(240, 376, CV_8U, cv::Scalar(255));
  mask(cv::Rect(0, 0, 188, 240)) = 0;
  WriteImage(Path("masks/left.png"), mask);
  for (const char* features : {"sift", "orb"}) {
    const Outcome run =
        Run(RigData(), features,
            {"--masks=" + Path("masks/{camera}.png"), std::string("--features=") + features});
    ASSERT_EXIT_CODE(run, 0);
    EXPECT_THAT(Lines(run.err), Contains("camera right: 4 of 4 images have no mask"));
    int of_left = 0, left_half = 0;
    for (const Match& m : Read(Path(features + std::string("/000000-000001.matches"))).matches) {
      if (m.camera1 == 0) {
        ++of_left;
        EXPECT_GT(m.pixel1.x(), 186);
      } else if (m.camera1 == 1 && m.pixel1.x() < 186) {
        ++left_half;
      }
    }
    EXPECT_GT(of_left, 50);
    EXPECT_GT(left_half, 20);
  }
  WriteImage(Path("masks/left.png"), mask(cv::Rect(0, 0, 100, 100)));
  const Outcome run = Run(RigData(), "out", {"--masks=" + Path("masks/{camera}.png")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("left.png: a mask of 100 x 100 pixels, expected 376 x 240"));
}

TEST_F(MatchRigTest, AMissingImageCostsItsCameraOnly) {
  const std::string data = Copy();
  fs::remove(data + "/right/000001.png");
  const Outcome run = Run(data, "out");
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err),
              Contains("camera right has no image of 1 of 4 frames, the first is frame 1; they are "
                       "matched without it"));
  ASSERT_EXIT_CODE(Run(RigData(), "whole"), 0);
  const FramePair pair = Read(Path("out/000001-000002.matches"));
  const FramePair whole = Read(Path("whole/000001-000002.matches"));
  size_t expected = 0;
  for (const Match& m : whole.matches) expected += m.camera1 != 1 ? 1 : 0;
  EXPECT_EQ(pair.matches.size(), expected);
  EXPECT_EQ(ReadText(Path("out/000002-000003.matches")),
            ReadText(Path("whole/000002-000003.matches")));
}

TEST_F(MatchRigTest, AnUnreadableImageCostsItsPairsUntilItIsRepaired) {
  const std::string data = Copy();
  const std::string image = data + "/fisheye/000000.png";
  const std::string whole = ReadText(image);
  WriteText(image, whole.substr(0, whole.size() / 2));
  const Outcome run = Run(data, "out");
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), Contains(image + ": the image is cut off"));
  EXPECT_THAT(Lines(run.err),
              Contains("wrote 2 match files to " + Path("out") + "; 1 could not be made"));
  WriteText(image, whole);
  const Outcome again = Run(data, "out", {"--resume"});
  EXPECT_EXIT_CODE(again, 0);
  EXPECT_THAT(Lines(again.err), Contains("wrote 1 match files to " + Path("out") + ", kept 2"));
}

TEST_F(MatchRigTest, ResumeWithOtherCamerasOrFramesIsRefused) {
  const std::string data = Copy();
  ASSERT_EXIT_CODE(Run(data, "out", {"--last=2"}), 0);
  const Outcome pairs = Run(data, "out", {"--last=2", "--resume", "--camera_pairs=0-1"});
  EXPECT_EXIT_CODE(pairs, 1);
  EXPECT_THAT(pairs.err, HasSubstr("were made with 'camera_pairs 0-1 0-2 1-2'"));
  const Outcome landmarks = Run(data, "out", {"--last=2", "--resume", "--landmarks=false"});
  EXPECT_EXIT_CODE(landmarks, 1);
  for (const char* name : kNames) fs::remove(data + "/" + name + "/000000.png");
  const Outcome frames = Run(data, "out", {"--last=2", "--resume"});
  EXPECT_EXIT_CODE(frames, 1);
  EXPECT_THAT(frames.err, HasSubstr("were made with 'frame 0 '000000''"));
}

TEST_F(MatchRigTest, TracksOverwriteNoInput) {
  const std::string data = Copy();
  const std::string before = ReadText(data + "/rig.json");
  for (const char* name : {"/rig.json", "/left/000002.png"}) {
    const Outcome run = Run(data, "out", {"--tracks=" + data + name});
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_FALSE(fs::exists(Path("out")));
  }
  EXPECT_EQ(ReadText(data + "/rig.json"), before);
  const Outcome run = Run(data, "out", {"--tracks=-", "--last=1"});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_EQ(run.out.rfind("format rigtracks 1\n", 0), 0u);
}

TEST_F(MatchRigTest, ImagesOfAnotherSizeAreRefused) {
  const std::string data = Copy();
  WriteImage(data + "/left/000000.png", cv::Mat(120, 188, CV_8U, cv::Scalar(9)));
  const Outcome run = Run(data, "out", {"--last=1"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("188 x 120 pixels, expected 376 x 240 as the calibration says"));
}

}  // namespace
}  // namespace rigel
