// rigel_match: errors that are told.
#include "rigel/test/tools/match_runs.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
      {{"--euroc_root=x"}, "--rig, --kitti_root and --euroc_root: expected one of them"},
      {{"--kitti_root="}, "--rig, --kitti_root or --euroc_root is missing"},
      {{"--kitti_root=", "--euroc_root=x"}, "--sequence: has no effect with --euroc_root"},
      {{"--rig=x"}, "--rig, --kitti_root and --euroc_root: expected one of them"},
      {{"--images=x"}, "--images: has an effect with --rig only"},
      {{"--camera_pairs=all"}, "--camera_pairs: has an effect with --rig only"},
      {{"--kitti_root=", "--rig=x", "--frames=never"}, "--frames=never: expected name, order or"},
      {{"--kitti_root=", "--rig=x", "--sync_tolerance_ms=1"}, "has an effect with --frames=time"},
      {{"--kitti_root=", "--rig=x", "--frames=time", "--time_unit_s=2"}, "--time_unit_s: expected"},
      {{"--kitti_root=", "--rig=x", "--frames=time", "--time_unit_s=nan"}, "--time_unit_s: expec"},
      {{"--tracks=t", "--landmarks=false"}, "--tracks: needs the landmarks"},
  };
  for (const auto& [flags, what] : wrong) {
    const Outcome run = Kitti("out", flags);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, HasSubstr(what));
  }
  EXPECT_FALSE(fs::exists(Path("out")));
}

}  // namespace
}  // namespace rigel
