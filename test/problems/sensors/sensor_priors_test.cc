// Priors of a drive whose motion is known exactly.
#include "rigel/problems/sensors/sensor_priors.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/pose.h"

namespace rigel {
namespace {

constexpr double kStep = 0.01;     // seconds between readings
constexpr double kTurnRate = 0.3;  // rad/s
constexpr double kSpeed = 10.0;    // m/s

// A car on a circle, x forward and z up, on a slope, rolled: constant rates in its own frame.
const Eigen::Vector3d kRate(0.02, 0, kTurnRate);

Eigen::Matrix3d WorldFromBody(double time) { return ExpSO3({0.1, 0.2, 0}) * ExpSO3(time * kRate); }

class SensorPriorsTest : public testing::Test {
 protected:
  SensorPriorsTest() { options_.imu_from_body = ExpSO3({0.3, -1, 2}); }

  Sensors Load(bool attitude, bool odometry, bool gyro) {
    Sensors sensors(options_);
    AttitudeSeries attitudes;
    OdometrySeries speeds;
    speeds.is_speed = true;
    RateSeries rates;
    for (int k = 0; k <= 1000; ++k) {
      const double time = k * kStep;
      attitudes.times.push_back(time);
      attitudes.values.emplace_back(
          Eigen::Quaterniond(WorldFromBody(time) * options_.imu_from_body.transpose()));
      speeds.readings.times.push_back(time);
      speeds.readings.values.push_back(-kSpeed);  // backwards: |t| all the same
      rates.times.push_back(time);
      rates.values.push_back(options_.imu_from_body * kRate);
    }
    if (attitude) sensors.SetAttitude(attitudes);
    if (odometry) sensors.SetOdometry(speeds);
    if (gyro) sensors.SetGyro(rates);
    return sensors;
  }

  SensorOptions options_;
};

TEST_F(SensorPriorsTest, GravityAndTurnAreThoseOfTheMotion) {
  for (const bool gyro : {false, true}) {
    for (const auto& [time1, time2] : {std::pair(1.2345, 2.3), std::pair(2.3, 1.2345)}) {
      const SensorPriors priors = PriorsBetween(Load(true, false, gyro), time1, time2);
      const Eigen::Matrix3d R = WorldFromBody(time2).transpose() * WorldFromBody(time1);
      const Eigen::Vector3d down(0, 0, -1);
      ASSERT_TRUE(priors.prior.gravity1 && priors.prior.gravity2 && priors.rotation);
      EXPECT_LT((*priors.prior.gravity1 - WorldFromBody(time1).transpose() * down).norm(), 1e-9);
      EXPECT_LT((R * *priors.prior.gravity1 - *priors.prior.gravity2).norm(), 1e-9);
      EXPECT_LT((*priors.rotation - R).norm(), 1e-9);
      ASSERT_TRUE(priors.prior.axis.has_value());
      EXPECT_LT((R * *priors.prior.axis - *priors.prior.axis).norm(), 1e-9);
      EXPECT_NEAR(*priors.prior.axis_sigma,
                  priors.rotation_sigma / (2 * std::sin(LogSO3(R).norm() / 2)), 1e-12);
      EXPECT_FALSE(priors.prior.distance.has_value());
    }
  }
}

TEST_F(SensorPriorsTest, DistanceIsTheChordOfAKnownTurn) {
  const double seconds = 1.5, path = kSpeed * seconds, half = seconds * kRate.norm() / 2;
  const SensorPriors chord = PriorsBetween(Load(false, true, true), 0.123, 0.123 + seconds);
  EXPECT_NEAR(*chord.prior.distance, path * std::sin(half) / half, 1e-9);
  const SensorPriors arc = PriorsBetween(Load(false, true, false), 0.123, 0.123 + seconds);
  EXPECT_NEAR(*arc.prior.distance, path, 1e-9);
  EXPECT_NEAR(arc.prior.distance_sigma,
              std::hypot(0.01 * path, options_.odometry_sigma * std::sqrt(seconds * kStep)), 1e-5);
  EXPECT_FALSE(arc.rotation || arc.prior.gravity1 || arc.prior.axis);
}

TEST_F(SensorPriorsTest, DistancesOfAnOdometerAreSubtracted) {
  OdometrySeries odometry;
  odometry.readings = {{0, 0.1, 0.2, 0.3}, {100, 101, 103, 103}};
  options_.odometry_sigma_fraction = 0;
  Sensors sensors(options_);
  sensors.SetOdometry(odometry);
  const SensorPriors priors = PriorsBetween(sensors, 0.05, 0.15);
  EXPECT_NEAR(*priors.prior.distance, 1.5, 1e-9);
  EXPECT_GT(priors.prior.distance_sigma, options_.odometry_sigma);
}

TEST_F(SensorPriorsTest, SigmaOfAGyroGrowsWithTime) {
  options_.gyro_bias = 0;
  const Sensors white = Load(false, false, true);
  for (const double seconds : {0.1, 1.0, 4.0}) {
    EXPECT_NEAR(PriorsBetween(white, 1, 1 + seconds).rotation_sigma /
                    (options_.gyro_noise * std::sqrt(seconds)),
                1, 0.03);
  }
  options_.gyro_bias = 0.01;
  const Sensors biased = Load(false, false, true);
  EXPECT_NEAR(PriorsBetween(biased, 1, 5).rotation_sigma, 0.04, 0.001);
}

TEST_F(SensorPriorsTest, SmallTurnsHaveNoAxis) {
  const Sensors sensors = Load(true, false, false);
  // Half a degree of sigma: the axis is known to five degrees from eight degrees of turn on.
  EXPECT_FALSE(PriorsBetween(sensors, 1, 1.3).prior.axis.has_value());
  EXPECT_TRUE(PriorsBetween(sensors, 1, 1.6).prior.axis.has_value());
}

TEST_F(SensorPriorsTest, OutsideInGapsAndAfterLongThereIsNothing) {
  const Sensors sensors = Load(true, true, true);
  const SensorPriors outside = PriorsBetween(sensors, 9.9, 10.1);
  EXPECT_EQ(outside.attitude, Coverage::kOutside);
  EXPECT_EQ(outside.gyro, Coverage::kOutside);
  EXPECT_EQ(outside.odometry, Coverage::kOutside);
  EXPECT_FALSE(outside.prior.gravity1 || outside.prior.distance || outside.rotation);
  const SensorPriors later = PriorsBetween(sensors, 1, 7);
  EXPECT_TRUE(later.too_long);
  EXPECT_FALSE(later.prior.distance.has_value());
  EXPECT_TRUE(later.rotation.has_value());
  const SensorPriors still = PriorsBetween(sensors, 1, 1);
  EXPECT_FALSE(still.prior.distance || still.rotation || still.prior.axis);

  options_.max_gap_s = kStep / 2;
  EXPECT_EQ(PriorsBetween(Load(true, false, false), 1.005, 2).attitude, Coverage::kGap);
}

TEST_F(SensorPriorsTest, LinesReplaceThoseThatTheSensorsCouldGive) {
  const Sensors all = Load(true, true, true);
  const std::map<std::string, std::string> full = SensorLines(all, PriorsBetween(all, 1, 3));
  EXPECT_THAT(full.at("gravity1"), testing::StartsWith("gravity1 "));
  EXPECT_THAT(full.at("gravity_sigma_deg"), testing::StartsWith("gravity_sigma_deg 0."));
  EXPECT_THAT(full.at("rotation"), testing::StartsWith("rotation 0.9"));
  EXPECT_THAT(full.at("distance"), testing::StartsWith("distance 19."));
  const std::map<std::string, std::string> none = SensorLines(all, PriorsBetween(all, 11, 12));
  EXPECT_EQ(none.size(), 7u);
  for (const auto& [keyword, line] : none) EXPECT_EQ(line, "") << keyword;
  const Sensors one = Load(false, true, false);
  EXPECT_EQ(SensorLines(one, PriorsBetween(one, 1, 3)).size(), 1u);
}

TEST_F(SensorPriorsTest, ReadingsThatScatterMoreThanStatedAreTold) {
  RateSeries rates;
  for (int k = 0; k < 100; ++k) {
    rates.times.push_back(k * kStep);
    rates.values.emplace_back(k % 2 == 0 ? 0.1 : -0.1, 0, 0);
  }
  Sensors sensors(options_);
  EXPECT_EQ(sensors.GyroExcess(), 1);
  sensors.SetGyro(rates);
  EXPECT_GT(sensors.GyroExcess(), 10);
  EXPECT_EQ(sensors.AttitudeExcess(), 1);
  EXPECT_EQ(Load(true, true, true).AttitudeExcess(), 1);
}

TEST_F(SensorPriorsTest, OptionsAreChecked) {
  std::string error;
  EXPECT_TRUE(options_.IsValid(&error));
  options_.odometry_sigma = 0;
  EXPECT_FALSE(options_.IsValid(&error));
  EXPECT_EQ(error, "odometry_sigma: expected a number > 0");
  options_ = SensorOptions();
  options_.gyro_bias = -1;
  EXPECT_FALSE(options_.IsValid(&error));
  EXPECT_EQ(error, "gyro_bias: expected a number >= 0");
  options_ = SensorOptions();
  options_.imu_from_body *= 2;
  EXPECT_FALSE(options_.IsValid(&error));
}

}  // namespace
}  // namespace rigel
