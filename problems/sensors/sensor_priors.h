// Priors of frame pairs from the sensors of the vehicle, with their standard deviations.
//
//   gravity1, gravity2  attitude at the two times
//   rotation            gyro, integrated; without one the difference of the two attitudes
//   axis                that of this rotation, where it is large enough to have one
//   distance            odometry
//
// The body has the axes of the rig; the IMU may be turned against it. Lever arms are left out: the
// distance is that of the point that the odometry measures, on cars the rear axle, and |t| is that
// of the body's origin. The path is taken as an arc of a circle whose chord is |t|.
#ifndef RIGEL_PROBLEMS_SENSORS_SENSOR_PRIORS_H_
#define RIGEL_PROBLEMS_SENSORS_SENSOR_PRIORS_H_

#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "rigel/core/angles.h"
#include "rigel/core/prior.h"
#include "rigel/problems/sensors/sensor_files.h"
#include "rigel/problems/sensors/series_noise.h"

namespace rigel {

struct SensorOptions {
  Eigen::Matrix3d imu_from_body = Eigen::Matrix3d::Identity();
  Eigen::Vector3d world_down = -Eigen::Vector3d::UnitZ();  // of world_from_imu; unit

  // Standard deviations. Of the attitude per axis, the heading's too.
  double attitude_sigma = DegToRad(0.5);  // of a good AHRS in a car
  // Of the odometry's scale, which is the same in all readings, and of each reading (m/s or m).
  double odometry_sigma_fraction = 0.01;  // tyres: pressure, wear
  double odometry_sigma = 0.02;           // the resolution of a car's bus
  // Of the gyro per axis: white noise, rad/s per square root of Hz, and the bias, rad/s.
  double gyro_noise = DegToRad(0.01);  // MEMS, as EuRoC's
  double gyro_bias = DegToRad(0.05);   // MEMS, after it was estimated

  double max_gap_s = 0.2;  // between readings: of all sensors of a car

  // False with a message if a number is not positive (odometry_sigma_fraction, gyro_bias:
  // negative) or not finite.
  bool IsValid(std::string* error) const;
};

// What was loaded. A sensor that is not there gives no line.
class Sensors {
 public:
  // Needs valid options.
  explicit Sensors(const SensorOptions& options) : options_(options) {}

  void SetAttitude(AttitudeSeries series);
  void SetOdometry(OdometrySeries series);
  void SetGyro(RateSeries series);

  const SensorOptions& options() const { return options_; }
  const std::optional<AttitudeSeries>& attitude() const { return attitude_; }
  const std::optional<OdometrySeries>& odometry() const { return odometry_; }
  const std::optional<RateSeries>& gyro() const { return gyro_; }

  // Neighbouring readings of each differ by that much more than the stated sigma explains; 1 if it
  // explains all, also without the sensor.
  double AttitudeExcess() const;
  double OdometryExcess() const;
  double GyroExcess() const;

 private:
  friend class PairSensors;

  // The stated sigma of one reading of the gyro.
  double GyroReadingSigma() const;

  SensorOptions options_;
  std::optional<AttitudeSeries> attitude_;
  std::optional<OdometrySeries> odometry_;
  std::optional<RateSeries> gyro_;
  SeriesNoise attitude_noise_, odometry_noise_, gyro_noise_;
  double gyro_step_ = 0.0;  // seconds between readings, the median
};

// What the sensors say of a pair of frames.
struct SensorPriors {
  // Of the sensors that are there.
  Coverage attitude = Coverage::kCovered;
  Coverage gyro = Coverage::kCovered;
  Coverage odometry = Coverage::kCovered;
  bool too_long = false;  // the time between the frames, for a distance along the path to be |t|

  MotionPrior prior;                        // gravity, axis and distance
  std::optional<Eigen::Matrix3d> rotation;  // R of f2_from_f1
  double rotation_sigma = 0.0;              // per axis, radians
};

// The times are seconds of the sensors' clock; time2 may be before time1.
SensorPriors PriorsBetween(const Sensors& sensors, double time1, double time2);

// The lines of a match file that these priors are, for ReplaceHeaderLines(). Those that the sensors
// could give and do not give for this pair are empty: the line of another source is then removed.
std::map<std::string, std::string> SensorLines(const Sensors& sensors, const SensorPriors& priors);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SENSORS_SENSOR_PRIORS_H_
