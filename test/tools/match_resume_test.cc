// rigel_match: runs that can be interrupted.
#include "rigel/test/tools/match_runs.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

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

TEST_F(MatchTest, SensorsAreInTheFilesAndAmongTheSettings) {
  WriteText(Path("speed.csv"), "time,speed\n0,2\n0.2,2\n0.25,2\n");
  WriteText(Path("gyro.csv"), "0,0,1,0\n0.1,0,1,0\n0.5,0,1,0\n");
  const Args sensors = {"--odometry=" + Path("speed.csv"), "--gyro=" + Path("gyro.csv"),
                        "--imu_from_body=0,1,0,0"};
  const Outcome run = Kitti("out", sensors);
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, HasSubstr("--odometry: distance in 2 of 3 pairs; 1 outside its times, 0.000 "
                                 "to 0.250 s (the pairs: 0.000 to 0.300 s)\n"));
  EXPECT_THAT(run.err,
              HasSubstr("--gyro: rotation in 1 of 3 pairs; 2 in a gap of more than 0.2 s\n"));
  const FramePair pair = Read(Path("out/000000-000001.matches"));
  ASSERT_TRUE(pair.prior.distance && pair.prior.axis && pair.prior.gravity1);
  EXPECT_NEAR(*pair.prior.distance, 0.2, 0.001);
  EXPECT_NEAR(std::abs(pair.prior.axis->y()), 1, 1e-9);
  EXPECT_THAT(ReadText(Path("out/000000-000001.matches")), HasSubstr("\nrotation 0.99"));
  const FramePair last = Read(Path("out/000002-000003.matches"));
  EXPECT_FALSE(last.prior.distance || last.prior.axis);
  EXPECT_TRUE(last.prior.gravity1) << "no sensor gives it, so that of the truth stays";

  EXPECT_EXIT_CODE(Kitti("out", sensors + Args{"--resume"}), 0);
  for (const Args& other : {Args(), sensors + Args{"--gyro_noise_deg=1"}}) {
    const Outcome resume = Kitti("out", other + Args{"--resume"});
    EXPECT_EXIT_CODE(resume, 1);
    EXPECT_THAT(resume.err, HasSubstr("the match files beside it were made with"));
  }
}

}  // namespace
}  // namespace rigel
