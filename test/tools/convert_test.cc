// rigel_convert: lines from sensors in match files.
#include <filesystem>
#include <string>

#include "rigel/core/pose.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;
using testing::Not;

class ConvertTest : public ToolsTest {
 protected:
  void SetUp() override {
    ToolsTest::SetUp();
    fs::create_directories(Path("in"));
    // Down is the body's y; the IMU has the axes of the body.
    WriteText(Path("attitude.csv"),
              "time,qw,qx,qy,qz\n0,0.70710678,-0.70710678,0,0\n0.2,0.70710678,-0.70710678,0,0\n"
              "0.4,0.70710678,-0.70710678,0,0\n5,0.70710678,-0.70710678,0,0\n");
    WriteText(Path("speed.csv"), "time,speed\n0,10\n0.2,10\n0.4,10\n");
  }

  void WritePair(const std::string& name, const std::string& header) {
    WriteText(Path("in") + "/" + name,
              "format rigmatch 1\ncamera 0 pinhole 400 400 320 240 640 480 1 0 0 0 0 0 0\n" +
                  header + "# of a camera\nmatches 1\n0 1.50 2 0 3 4 0.5\n");
  }

  Args Files() const { return {"--matches=" + Path("in"), "--output=" + Path("out")}; }
  std::string Out(const std::string& name) const { return ReadText(Path("out") + "/" + name); }
};

TEST_F(ConvertTest, LinesAreAddedAndReplaced) {
  WritePair("1.matches", "gravity1 1 0 0\ntime 0.05 0.15\nnoise_px 0.5\ndistance 3 1\n");
  const Args args =
      Files() + Args{"--attitude=" + Path("attitude.csv"), "--odometry=" + Path("speed.csv"),
                     "--odometry_sigma=0.1", "--odometry_sigma_fraction=0.03"};
  const Outcome run = RunTool("convert", args);
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run.err,
            "--attitude: gravity and rotation in 1 of 1 pair\n"
            "--odometry: distance in 1 of 1 pair\n"
            "axis in 0 of 1 pair: the others turn too little to have one\n"
            "wrote 1 match file to " +
                Path("out") + "\n");
  const std::string text = Out("1.matches");
  for (const char* line :
       {"noise_px 0.5\n# of a camera\n", "\n# rigel_convert added lines from sensors\n",
        "\nmatches 1\n0 1.50 2 0 3 4 0.5\n", "\nrotation 1 0 0 0 0.707"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
  FramePair pair;
  std::string error;
  ASSERT_TRUE(ReadMatchFile(Path("out") + "/1.matches", &pair, &error)) << error;
  ASSERT_TRUE(pair.prior.gravity1 && pair.prior.gravity2 && pair.prior.distance);
  EXPECT_LT((*pair.prior.gravity1 - Eigen::Vector3d::UnitY()).norm(), 1e-7);
  EXPECT_NEAR(*pair.prior.distance, 1, 1e-9);
  EXPECT_NEAR(pair.prior.distance_sigma, 0.031, 0.001);
  EXPECT_FALSE(pair.prior.axis.has_value());

  // Its own files it writes again, and the same.
  EXPECT_EXIT_CODE(RunTool("convert", args), 0);
  EXPECT_EQ(Out("1.matches"), text);
}

TEST_F(ConvertTest, GapsOffsetsAndMissingTimesAreSaid) {
  WritePair("1.matches", "time 0.1 0.3\ngravity1 1 0 0\n");
  WritePair("2.matches", "time 0.3 0.9\ngravity1 1 0 0\n");
  WritePair("3.matches", "time 5.0 6.0\n");
  WritePair("4.matches", "");
  WritePair("5.matches", "");
  const Outcome run = RunTool("convert", Files() + Args{"--attitude=" + Path("attitude.csv"),
                                                        "--attitude_time_offset_s=-0.05"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("--attitude: -0.05 s are added to its times\n"));
  EXPECT_THAT(run.err, HasSubstr("4.matches: not written, it has no line 'time T1 T2' (2 files "
                                 "alike)\n"));
  EXPECT_THAT(run.err, HasSubstr("--attitude: gravity and rotation in 1 of 3 pairs; 1 in a gap of "
                                 "more than 0.2 s; 1 outside its times, -0.050 to 4.950 s (the "
                                 "pairs: 0.100 to 6.000 s)\n"));
  EXPECT_THAT(run.err, HasSubstr("wrote 3 match files to "));
  EXPECT_THAT(Out("2.matches"), Not(HasSubstr("gravity"))) << "not of another source";
  EXPECT_FALSE(fs::exists(Path("out") + "/4.matches"));
}

TEST_F(ConvertTest, GravityThatIsNotDownIsSaid) {
  WritePair("1.matches", "time 0.1 0.3\n");
  const Args args = Files() + Args{"--attitude=" + Path("attitude.csv")};
  constexpr char kOff[] = "in 1 pair gravity is more than 45 degrees off the cameras' down";
  EXPECT_THAT(RunTool("convert", args).err, Not(HasSubstr(kOff)));
  EXPECT_THAT(RunTool("convert", args + Args{"--world_down=+z"}).err, HasSubstr(kOff));
  EXPECT_THAT(RunTool("convert", args + Args{"--imu_from_body=0.5,0.5,0.5,0.5"}).err,
              HasSubstr(kOff));
}

TEST_F(ConvertTest, ReadingsThatScatterMoreThanStatedAreSaid) {
  WritePair("1.matches", "time 0.1 0.3\n");
  WriteText(Path("speed.csv"), "time,speed\n0,10\n0.1,11\n0.2,10\n0.3,11\n0.4,10\n0.5,11\n");
  const Outcome run = RunTool("convert", Files() + Args{"--odometry=" + Path("speed.csv")});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, HasSubstr("times as much as --odometry_sigma=0.02 says"));
}

TEST_F(ConvertTest, InputsAndOtherFilesAreNotOverwritten) {
  WritePair("1.matches", "time 0.1 0.3\n");
  const std::string before = ReadText(Path("in") + "/1.matches");
  const Args sensor = {"--attitude=" + Path("attitude.csv")};
  const Outcome same = RunTool(
      "convert", sensor + Args{"--matches=" + Path("in"), "--output=" + Path("in") + "/../in"});
  EXPECT_EXIT_CODE(same, 1);
  EXPECT_THAT(same.err, HasSubstr("--output would overwrite it; name another directory"));
  EXPECT_EQ(ReadText(Path("in") + "/1.matches"), before);
  fs::create_directories(Path("out"));
  WriteText(Path("out") + "/1.matches", before);
  const Outcome other = RunTool("convert", sensor + Files());
  EXPECT_EXIT_CODE(other, 1);
  EXPECT_THAT(other.err, HasSubstr("holds 1.matches, not written by this run"));
}

TEST_F(ConvertTest, BrokenSensorFilesAreFailures) {
  WritePair("1.matches", "time 0.1 0.3\n");
  WriteText(Path("bad.csv"), "time,speed\n0,1\n0,2\n");
  const Outcome run = RunTool("convert", Files() + Args{"--odometry=" + Path("bad.csv")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_EQ(run.err, Path("bad.csv") +
                         ":3: the time 0 is not after that of the row before, "
                         "expected times that increase\n");
  EXPECT_FALSE(fs::exists(Path("out")));
  const Outcome mounting = RunTool(
      "convert", Files() + Args{"--attitude=" + Path("attitude.csv"), "--imu_from_body=1,2,3,4"});
  EXPECT_EXIT_CODE(mounting, 1);
  EXPECT_THAT(mounting.err, HasSubstr("--imu_from_body: '1,2,3,4': 4 numbers, expected a unit"));
}

TEST_F(ConvertTest, WrongFlagsAreUsageErrors) {
  const std::string attitude = "--attitude=" + Path("attitude.csv");
  const struct {
    Args args;
    const char* message;
  } cases[] = {
      {{"--output=x", attitude}, "--matches is missing"},
      {{"--matches=x", attitude}, "--output is missing"},
      {{"--matches=x", "--output=x"}, "nothing to add: name a file by --attitude"},
      {Files() + Args{attitude, "--odometry_sigma=1"},
       "--odometry_sigma: has no effect without --odometry"},
      {Files() + Args{"--odometry=x", "--imu_from_body=1,0,0,0.1"},
       "--imu_from_body: has no effect without --attitude or --gyro"},
      {Files() + Args{attitude, "--attitude_sigma_deg=0"},
       "--attitude_sigma_deg=0: expected a number > 0"},
      {Files() + Args{attitude, "--attitude_time_offset_s=nan"}, "expected a finite number"},
      {Files() + Args{attitude, "--world_down=down"}, "--world_down=down: expected +z, -z"},
      {{"--matches=-", "--output=x", attitude}, "--matches=-: stdin has no name"},
  };
  for (const auto& [args, message] : cases) {
    const Outcome run = RunTool("convert", args);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, HasSubstr(message));
  }
}

}  // namespace
}  // namespace rigel
