// The files of a vehicle's sensors: CSV of attitudes, of the odometry and of a gyro
// (rigel/problems/sensors/sensor_table.h).
//
//   attitude  time, qw, qx, qy, qz       world_from_imu, unit quaternion
//   odometry  time, speed | distance     m/s, negative backwards | metres since any moment
//   gyro      time, wx, wy, wz           rad/s in the frame of the IMU
//
// Columns are found by their names, in any order and among others: qw or q_..._w and so on; speed,
// speed_mps or velocity, distance or distance_m; wx or w..._x, gyr..._x, omega..._x, ang..._x. So
// EuRoC's files of the IMU and of the ground truth are read as they are. Attitudes and rates
// without names have exactly the columns above, in that order.
#ifndef RIGEL_PROBLEMS_SENSORS_SENSOR_FILES_H_
#define RIGEL_PROBLEMS_SENSORS_SENSOR_FILES_H_

#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rigel/problems/sensors/time_series.h"

namespace rigel {

using AttitudeSeries = TimeSeries<Eigen::Quaternion<double, Eigen::DontAlign>>;
using RateSeries = TimeSeries<Eigen::Vector3d>;

struct OdometrySeries {
  bool is_speed = false;        // else distances
  TimeSeries<double> readings;  // m/s or metres
};

// Each is false with a message of one line if the file cannot be read or is not of this form; the
// series is then unchanged. Quaternions are off unit length by at most 1e-3; they are normalized.
bool ReadAttitudeFile(const std::string& path, AttitudeSeries* series, std::string* error);
bool ReadOdometryFile(const std::string& path, OdometrySeries* series, std::string* error);
bool ReadGyroFile(const std::string& path, RateSeries* series, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SENSORS_SENSOR_FILES_H_
