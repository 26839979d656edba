// Priors from sensors on real drives, which are no part of the project: skipped where the
// environment variable RIGEL_REAL_DATA does not name them.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "rigel/core/angles.h"
#include "rigel/core/random.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/kitti_poses.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr double kInterval = 0.10362;  // seconds between KITTI's poses

std::string CsvRow(const std::vector<double>& numbers) {
  std::string row;
  for (const double x : numbers) row += (row.empty() ? "" : ",") + CsvNumber(x);
  return row + "\n";
}

// The poses of a recorded drive at any time: between two of them a cubic with their velocities.
class Drive {
 public:
  explicit Drive(std::vector<Pose> world_from_body) : poses_(std::move(world_from_body)) {}

  // The step at each end has no velocity.
  double begin() const { return 2 * kInterval; }
  double end() const { return kInterval * static_cast<double>(poses_.size() - 3); }

  Pose At(double time) const {
    const size_t k = std::min(static_cast<size_t>(time / kInterval), poses_.size() - 3);
    const double s = time / kInterval - static_cast<double>(k), s2 = s * s, s3 = s2 * s;
    const Pose &before = poses_[k - 1], &a = poses_[k], &b = poses_[k + 1], &after = poses_[k + 2];
    const double h01 = 3 * s2 - 2 * s3, h10 = s - 2 * s2 + s3, h11 = s3 - s2;
    Pose pose;
    pose.t = a.t + h01 * (b.t - a.t) + h10 * (b.t - before.t) / 2 + h11 * (after.t - a.t) / 2;
    pose.R = a.R * ExpSO3(h01 * LogSO3(a.R.transpose() * b.R) +
                          h10 * LogSO3(before.R.transpose() * b.R) / 2 +
                          h11 * LogSO3(a.R.transpose() * after.R) / 2);
    return pose;
  }

  double Speed(double time) const {
    return (At(time + kStep).t - At(time - kStep).t).norm() / (2 * kStep);
  }

  Eigen::Vector3d Rate(double time) const {
    return LogSO3(At(time - kStep).R.transpose() * At(time + kStep).R) / (2 * kStep);
  }

 private:
  static constexpr double kStep = 1e-4;  // seconds, of the derivatives

  std::vector<Pose> poses_;
};

double Rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double x : values) sum += x * x;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

#define EXPECT_STATED_RIGHT(values) \
  EXPECT_GT(Rms(values), 0.85);     \
  EXPECT_LT(Rms(values), 1.15);     \
  RecordProperty(#values, std::to_string(Rms(values)))

class ConvertRealDataTest : public ToolsTest {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("RIGEL_REAL_DATA");
    if (folder == nullptr || *folder == '\0') {
      GTEST_SKIP() << "RIGEL_REAL_DATA is not set: no recorded drives to test with";
    }
    folder_ = folder;
    ToolsTest::SetUp();
    ReadDrive("00");
    imu_from_body_ << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // x forward, y left, z up
    imu_from_body_ = ExpSO3({0.02, -0.05, 0.01}) * imu_from_body_;
    for (int k = 0; k < 9; ++k) {
      mounting_ += (k > 0 ? "," : "") + CsvNumber(imu_from_body_(k / 3, k % 3));
    }
  }

  void ReadDrive(const std::string& name) {
    std::vector<Pose> poses;
    std::string error;
    ASSERT_TRUE(ReadKittiPoses(folder_ + "/kitti_odometry/poses/" + name + ".txt", &poses, &error))
        << error;
    drive_ = std::make_unique<Drive>(std::move(poses));
  }

  void TearDown() override {
    if (!folder_.empty()) ToolsTest::TearDown();
  }

  // Attitudes whose errors are new in each reading, or hold on for seconds.
  void WriteAttitudes(double step, double sigma, double hold_s) {
    Random random(1);
    const double keep = hold_s > 0 ? std::exp(-step / hold_s) : 0.0;
    Eigen::Vector3d error = sigma * random.NormalVector3();
    std::string text = "#timestamp, q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";
    for (double time = drive_->begin(); time < drive_->end(); time += step) {
      error = keep * error + std::sqrt(1 - keep * keep) * sigma * random.NormalVector3();
      Pose imu;
      imu.R = drive_->At(time).R * imu_from_body_.transpose() * ExpSO3(error);
      const auto q = imu.Quaternion();
      text += CsvRow({time, q.w(), q.x(), q.y(), q.z()});
    }
    WriteText(Path("attitude.csv"), text);
  }

  // Another scale every two seconds, so that there are many errors of it.
  void WriteSpeeds(double step, double sigma, double fraction) {
    Random random(2);
    std::string text = "time,speed [m/s]\n";
    double scale = 1;
    double next = 0;
    for (double time = drive_->begin(); time < drive_->end(); time += step) {
      if (time >= next) {
        scale = 1 + fraction * random.Normal();
        next += 2;
      }
      text += CsvRow({time, scale * drive_->Speed(time) + sigma * random.Normal()});
    }
    WriteText(Path("speed.csv"), text);
  }

  void WriteRates(double step, double noise, double bias) {
    Random random(3);
    std::string text = "# rates of the drive\ntime,wx,wy,wz\n";
    Eigen::Vector3d of_bias;
    double next = 0;
    for (double time = drive_->begin(); time < drive_->end(); time += step) {
      if (time >= next) {
        of_bias = bias * random.NormalVector3();
        next += 2;
      }
      const Eigen::Vector3d w = imu_from_body_ * drive_->Rate(time) + of_bias +
                                noise / std::sqrt(step) * random.NormalVector3();
      text += CsvRow({time, w[0], w[1], w[2]});
    }
    WriteText(Path("gyro.csv"), text);
  }

  // Match files without matches: two frames of the drive every `step` seconds, `interval` apart.
  void WritePairs(double step, double interval) {
    fs::create_directories(Path("pairs"));
    int number = 0;
    for (double time = drive_->begin() + 0.537; time + interval < drive_->end(); time += step) {
      FramePair pair;
      RigCamera camera;
      camera.intrinsics = Camera::Pinhole(400, 400, 320, 240, 640, 480);
      pair.rig.cameras.push_back(camera);
      pair.time1 = time;
      pair.time2 = time + interval;
      pair.truth = drive_->At(time + interval).Inverse() * drive_->At(time);
      // Of this moment's "down", to be replaced.
      pair.prior.gravity1 = Eigen::Vector3d::UnitX();
      std::string error;
      ASSERT_TRUE(
          WriteMatchFile(Path("pairs") + "/" + std::to_string(number++) + ".matches", pair, &error))
          << error;
    }
  }

  // Runs rigel_convert over the pairs. Errors over their sigmas: each component of them that the
  // truth gives.
  struct Ratios {
    std::vector<double> gravity, axis, rotation, distance;
    int pairs = 0;
  };
  Ratios Convert(const Args& args) {
    Ratios ratios;
    const Outcome run =
        RunTool("convert", Args{"--matches=" + Path("pairs"), "--output=" + Path("with"),
                                "--imu_from_body=" + mounting_} +
                               args);
    EXPECT_EXIT_CODE(run, 0);
    for (const auto& entry : fs::directory_iterator(Path("with"))) Add(entry.path(), &ratios);
    return ratios;
  }

  // Attitude and speed of the whole drive; the errors of the attitude are new in each reading, or
  // hold on.
  Ratios ConvertDrive(double hold_s) {
    WritePairs(0.53, 0.5);
    WriteSpeeds(0.05, 0.05, 0.01);
    WriteAttitudes(0.02, DegToRad(0.3), hold_s);
    const Ratios ratios = Convert({"--attitude=" + Path("attitude.csv"), "--world_down=+y",
                                   "--attitude_sigma_deg=0.3", "--odometry=" + Path("speed.csv"),
                                   "--odometry_sigma=0.05"});
    EXPECT_GT(ratios.pairs, 800);
    EXPECT_EQ(ratios.gravity.size(), 4u * ratios.pairs);
    EXPECT_EQ(ratios.distance.size(), 1u * ratios.pairs);
    EXPECT_STATED_RIGHT(ratios.gravity);
    EXPECT_STATED_RIGHT(ratios.distance);
    return ratios;
  }

  std::string folder_, mounting_;
  std::unique_ptr<Drive> drive_;
  Eigen::Matrix3d imu_from_body_;

 private:
  void Add(const std::string& path, Ratios* ratios) {
    FramePair pair;
    std::string error;
    ASSERT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
    ++ratios->pairs;
    const MotionPrior& prior = pair.prior;
    const auto add = [](const Eigen::Vector3d& stated, const Eigen::Vector3d& truth, double sigma,
                        std::vector<double>* to) {
      const Eigen::Vector2d e = TangentBasis(truth).transpose() * (stated - truth) / sigma;
      to->insert(to->end(), {e[0], e[1]});
    };
    if (prior.gravity1) {
      for (const auto& [time, gravity] :
           {std::pair(*pair.time1, *prior.gravity1), std::pair(*pair.time2, *prior.gravity2)}) {
        add(gravity, drive_->At(time).R.transpose() * Eigen::Vector3d::UnitY(),
            *prior.gravity_sigma, &ratios->gravity);
      }
    }
    if (prior.axis) {
      const Eigen::Vector3d axis = LogSO3(pair.truth->R).normalized();
      add(*prior.axis, axis, *prior.axis_sigma, &ratios->axis);
    }
    if (prior.distance) {
      ratios->distance.push_back((*prior.distance - pair.truth->t.norm()) / prior.distance_sigma);
    }
    std::istringstream lines(ReadText(path));
    std::string word;
    while (lines >> word && word != "matches") {
      if (word != "rotation") continue;
      double w, x, y, z, sigma_deg;
      lines >> w >> x >> y >> z >> sigma_deg;
      const Eigen::Matrix3d R = Eigen::Quaterniond(w, x, y, z).toRotationMatrix();
      const Eigen::Vector3d e = LogSO3(R * pair.truth->R.transpose()) / DegToRad(sigma_deg);
      ratios->rotation.insert(ratios->rotation.end(), {e[0], e[1], e[2]});
    }
  }
};

TEST_F(ConvertRealDataTest, ErrorsOfADriveAreThoseOfTheStatedSigmas) {
  const Ratios ratios = ConvertDrive(0);
  EXPECT_GT(ratios.axis.size(), 100u);
  EXPECT_STATED_RIGHT(ratios.axis);
  EXPECT_STATED_RIGHT(ratios.rotation);
}

TEST_F(ConvertRealDataTest, ErrorsThatHoldOnAreThoseOfTheStatedSigmas) {
  const Ratios ratios = ConvertDrive(2.0);
  // What is the same at both times is not in their difference: its sigma is then too large.
  EXPECT_LT(Rms(ratios.rotation), 0.85);
  RecordProperty("ratios.rotation", std::to_string(Rms(ratios.rotation)));
}

TEST_F(ConvertRealDataTest, TurnsOfAGyroAreThoseOfTheStatedSigmas) {
  WritePairs(0.53, 0.25);
  WriteRates(0.01, DegToRad(0.02), DegToRad(0.05));
  const Ratios ratios =
      Convert({"--gyro=" + Path("gyro.csv"), "--gyro_noise_deg=0.02", "--gyro_bias_deg=0.05"});
  EXPECT_EQ(ratios.rotation.size(), 3u * ratios.pairs);
  EXPECT_GT(ratios.axis.size(), 1000u);
  EXPECT_LT(ratios.axis.size(), 2u * ratios.pairs);
  EXPECT_STATED_RIGHT(ratios.rotation);
  EXPECT_STATED_RIGHT(ratios.axis);
}

TEST_F(ConvertRealDataTest, SlowSensorsStateWhatIsLostBetweenTheirReadings) {
  WritePairs(0.53, 0.5);
  WriteAttitudes(0.07, DegToRad(0.05), 2.0);
  WriteSpeeds(0.07, 0.01, 0.0);
  const Ratios ratios = Convert({"--attitude=" + Path("attitude.csv"), "--world_down=+y",
                                 "--attitude_sigma_deg=0.05", "--odometry=" + Path("speed.csv"),
                                 "--odometry_sigma=0.01", "--odometry_sigma_fraction=0"});
  EXPECT_STATED_RIGHT(ratios.gravity);
  // Speeds that go up and down between readings lose less than those of one curve, as is stated.
  EXPECT_LT(Rms(ratios.distance), 1.15);
  EXPECT_GT(Rms(ratios.distance), 0.5);
}

#ifdef RIGEL_HAS_MATCH
TEST_F(ConvertRealDataTest, ImagesAndSensorsGiveTheMotion) {
  ReadDrive("06");
  WriteAttitudes(0.02, DegToRad(0.3), 2.0);
  WriteSpeeds(0.05, 0.05, 0.01);
  const Outcome match = RunTool(
      "match", {"--kitti_root=" + folder_ + "/kitti_odometry", "--sequence=06", "--first=20",
                "--last=27", "--output=" + Path("matches"), "--attitude=" + Path("attitude.csv"),
                "--attitude_sigma_deg=0.3", "--world_down=+y", "--imu_from_body=" + mounting_,
                "--odometry=" + Path("speed.csv"), "--odometry_sigma=0.05"});
  ASSERT_EXIT_CODE(match, 0);
  EXPECT_THAT(match.err, testing::HasSubstr("--odometry: distance in 7 of 7 pairs\n"));

  const Outcome run =
      RunTool("estimate", {"--matches=" + Path("matches"), "--solver=4pt", "--json=-"});
  ASSERT_EXIT_CODE(run, 0);
  const Json report = ParseReport(run.out);
  ASSERT_EQ(report["pairs"].size(), 7u);
  for (const Json& motion : report["pairs"]) {
    FramePair pair;
    std::string error;
    ASSERT_TRUE(ReadMatchFile(motion["pair"], &pair, &error)) << error;
    ASSERT_TRUE(pair.truth && pair.prior.gravity1 && pair.prior.gravity_sigma &&
                pair.prior.distance);
    EXPECT_EQ(motion["status"], "ok") << motion["pair"];
    const std::vector<double> q = motion["refined"]["q_wxyz"], t = motion["refined"]["t"];
    const Eigen::Matrix3d R = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
    // The truth of this clip is good to a tenth of a degree and a few centimetres.
    EXPECT_LT(LogSO3(R * pair.truth->R.transpose()).norm(), DegToRad(0.15)) << motion["pair"];
    EXPECT_LT((Eigen::Vector3d(t[0], t[1], t[2]) - pair.truth->t).norm(), 0.05) << motion["pair"];
  }
}
#endif

}  // namespace
}  // namespace rigel
