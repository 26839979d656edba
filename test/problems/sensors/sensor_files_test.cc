// The files of sensors: what is read, and what breaks each.
#include "rigel/problems/sensors/sensor_files.h"

#include <string>
#include <vector>

#include "rigel/test/problems/sensors/sensors_test_file.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::EndsWith;

TEST_F(SensorFileTest, AttitudesWithoutNamesAreWXYZ) {
  AttitudeSeries series;
  std::string error;
  ASSERT_TRUE(ReadAttitudeFile(Write("# a car\n\n0.5,1,0,0,0\n 0.75 , 0.6, 0,0.8,0.0005\r\n"),
                               &series, &error))
      << error;
  EXPECT_THAT(series.times, ElementsAre(0.5, 0.75));
  EXPECT_EQ(series.values[0].w(), 1);
  EXPECT_NEAR(series.values[1].y(), 0.8, 1e-6);
  EXPECT_NEAR(series.values[1].norm(), 1, 1e-15);
}

TEST_F(SensorFileTest, GroundTruthOfEurocIsReadAsItIs) {
  AttitudeSeries series;
  std::string error;
  ASSERT_TRUE(ReadAttitudeFile(
      Write("#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y "
            "[], q_RS_z [], v_RS_R_x [m s^-1], b_w_RS_S_x [rad s^-1]\n"
            "1403715523912143104,0.1,0.2,0.3,0,1,0,0,0.4,0.5\n"
            "1403715523917143040,0.1,0.2,0.3,0,0,1,0,0.4,0.5\n"),
      &series, &error))
      << error;
  EXPECT_NEAR(series.times[0], 1403715523.912143104, 1e-6);
  EXPECT_NEAR(series.times[1] - series.times[0], 0.004999936, 3e-7);
  EXPECT_EQ(series.values[0].x(), 1);
  EXPECT_EQ(series.values[1].y(), 1);
}

TEST_F(SensorFileTest, ImuOfEurocIsReadAsItIs) {
  RateSeries series;
  std::string error;
  ASSERT_TRUE(ReadGyroFile(
      Write("#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x "
            "[m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
            "5000000,0.1,0.2,0.3,9,0,0\n10000000,-0.1,-0.2,-0.3,9,0,0\n"),
      &series, &error))
      << error;
  EXPECT_THAT(series.times, ElementsAre(0.005, 0.01));
  EXPECT_EQ(series.values[0], Eigen::Vector3d(0.1, 0.2, 0.3));
}

TEST_F(SensorFileTest, ColumnsOfAnyOrderAreFoundByTheirNames) {
  AttitudeSeries attitude;
  RateSeries rates;
  OdometrySeries odometry;
  std::string error;
  ASSERT_TRUE(
      ReadAttitudeFile(Write("time,qx,qy,qz,qw\n0,0,0,0,1\n1,0,0,0,1\n"), &attitude, &error))
      << error;
  EXPECT_EQ(attitude.values[0].w(), 1);
  ASSERT_TRUE(
      ReadGyroFile(Write("stamp [ms],gyro_z,gyro_x,gyro_y\n0,3,1,2\n10,3,1,2\n"), &rates, &error))
      << error;
  EXPECT_EQ(rates.values[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(rates.times, ElementsAre(0, 0.01));
  ASSERT_TRUE(ReadOdometryFile(Write("# t, Speed [m/s]\n0,1.5\n1,-1.5\n"), &odometry, &error))
      << error;
  EXPECT_TRUE(odometry.is_speed);
  EXPECT_THAT(odometry.readings.values, ElementsAre(1.5, -1.5));
  ASSERT_TRUE(
      ReadOdometryFile(Write("time,steering,distance [m]\n0,1,2\n1,1,5\n"), &odometry, &error))
      << error;
  EXPECT_FALSE(odometry.is_speed);
  EXPECT_THAT(odometry.readings.values, ElementsAre(2, 5));
}

TEST_F(SensorFileTest, WhatIsBrokenIsToldWithFileAndLine) {
  const auto attitude = [](const std::string& path, std::string* error) {
    AttitudeSeries series;
    return ReadAttitudeFile(path, &series, error);
  };
  const auto odometry = [](const std::string& path, std::string* error) {
    OdometrySeries series;
    return ReadOdometryFile(path, &series, error);
  };
  const auto gyro = [](const std::string& path, std::string* error) {
    RateSeries series;
    return ReadGyroFile(path, &series, error);
  };
  const struct {
    bool (*read)(const std::string&, std::string*);
    const char* text;
    const char* message;
  } cases[] = {
      {attitude, "",
       "a.csv: 0 readings, expected at least 2: lines of a time and values, separated by commas"},
      {attitude, "0,1,0,0,0\n",
       "a.csv: 1 readings, expected at least 2: lines of a time and values, separated by commas"},
      {attitude, "0,1,0,0,0\n1,1,0,0\n", "a.csv:2: 4 columns, expected 5 as in the first line"},
      {attitude, "0,1,0,0\n1,1,0,0\n",
       "a.csv: 4 columns without a line of names, expected time, qw, qx, qy, qz"},
      {attitude, "0,1,0,0,0\n1,1,0,0,x\n", "a.csv:2: column 5 is 'x', expected a finite number"},
      {attitude, "0,1,0,0,0\n1,1,0,nan,0\n",
       "a.csv:2: column 4 is 'nan', expected a finite number"},
      {attitude, "0,1,0,0,0\n\n0,1,0,0,0\n",
       "a.csv:3: the time 0 is not after that of the row before, expected times that increase"},
      {attitude, "0,1,0,0,0\n1,1,1,0,0\n",
       "a.csv:2: the quaternion is not of unit length, expected qw, qx, qy, qz"},
      {attitude, "time,qw,qx,qy\n0,1,0,0\n1,1,0,0\n", "a.csv: no column is named qz"},
      {attitude, "time,qw,qx,qy,qz,q2_z\n0,1,0,0,0,0\n1,1,0,0,0,0\n",
       "a.csv: two columns could be qz, expected one"},
      {attitude, "seq,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0,0\n",
       "a.csv:1: the first column is 'seq', expected the time"},
      {attitude, "time [h],qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0,0\n",
       "a.csv: the unit of the time is 'h', expected ns, us, ms or s"},
      {gyro, "time [ns],wx,wy,wz\n0.5,1,0,0\n1,1,0,0\n",
       "a.csv:2: the time is '0.5', expected whole nanoseconds"},
      {gyro, "time,wx [deg/s],wy,wz\n0.5,1,0,0\n1,1,0,0\n",
       "a.csv: the unit of wx is 'deg/s', expected rad/s"},
      {gyro, "0,1,0,0,0\n1,1,0,0,0\n",
       "a.csv: 5 columns without a line of names, expected time, wx, wy, wz"},
      {odometry, "0,1\n1,1\n",
       "a.csv: no line names the columns, expected \"time,speed\" or \"time,distance\""},
      {odometry, "time,x\n0,1\n1,1\n", "a.csv: no column is named speed (m/s) or distance (m)"},
      {odometry, "time,speed,distance\n0,1,1\n1,1,1\n",
       "a.csv: two columns could be the speed, expected one"},
      {odometry, "time,speed [km/h]\n0,1\n1,1\n",
       "a.csv: the unit of the speed is 'km/h', expected m/s"},
  };
  for (const auto& [read, text, message] : cases) {
    std::string error;
    EXPECT_FALSE(read(Write(text), &error)) << text;
    EXPECT_THAT(error, EndsWith(message)) << text;
  }
  std::string error;
  EXPECT_FALSE(attitude(directory_ + "/none.csv", &error));
  EXPECT_THAT(error, testing::HasSubstr("none.csv"));
}

}  // namespace
}  // namespace rigel
