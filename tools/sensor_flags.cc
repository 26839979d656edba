#include "rigel/tools/sensor_flags.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/core/angles.h"
#include "rigel/core/body_axes.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/sensors/mounting.h"
#include "rigel/tools/tool.h"

DEFINE_string(attitude, "",
              "CSV of attitudes, time,qw,qx,qy,qz: world_from_imu. Gives gravity1 and gravity2, "
              "without --gyro also rotation and axis");
DEFINE_double(attitude_sigma_deg, 0.5, "1-sigma error of an attitude, per axis, degrees");
DEFINE_double(attitude_time_offset_s, 0, "seconds to add to the times of --attitude");
DEFINE_string(world_down, "-z", "down in the world of --attitude: +z for NED, or three numbers");
DEFINE_string(odometry, "",
              "CSV of the odometry, \"time,speed\" (m/s) or \"time,distance\" (m), with a line of "
              "these names. Gives distance");
DEFINE_double(odometry_sigma_fraction, 0.01,
              "1-sigma error of the scale of the odometry, the same in all readings");
DEFINE_double(odometry_sigma, 0.02,
              "1-sigma error of each reading of the odometry, m/s of speeds, m of distances");
DEFINE_double(odometry_time_offset_s, 0, "seconds to add to the times of --odometry");
DEFINE_string(gyro, "",
              "CSV of turn rates, time,wx,wy,wz, rad/s, as EuRoC's imu0/data.csv. Gives rotation, "
              "and axis where the turn is large enough");
DEFINE_double(gyro_noise_deg, 0.01,
              "noise density of the gyro per axis, degrees per second and square root of Hz");
DEFINE_double(gyro_bias_deg, 0.05, "1-sigma bias of the gyro per axis, degrees per second");
DEFINE_double(gyro_time_offset_s, 0, "seconds to add to the times of --gyro");
DEFINE_string(imu_from_body, "1,0,0,0",
              "rotation from the body's axes to those of --attitude and --gyro: a unit quaternion "
              "w,x,y,z, nine numbers of a matrix row by row, or a file that has them");
DEFINE_double(sensor_max_gap_s, 0.2,
              "a frame between two readings that are further apart gets no line, seconds");

namespace rigel {
namespace {

// The flags that name a sensor's file, each with those that have no effect without it.
const std::vector<std::pair<std::string, std::vector<std::string>>>& FlagsOfSensors() {
  static const auto& flags = *new std::vector<std::pair<std::string, std::vector<std::string>>>{
      {"attitude", {"attitude_sigma_deg", "attitude_time_offset_s", "world_down"}},
      {"odometry", {"odometry_sigma_fraction", "odometry_sigma", "odometry_time_offset_s"}},
      {"gyro", {"gyro_noise_deg", "gyro_bias_deg", "gyro_time_offset_s"}}};
  return flags;
}

bool OptionsFromFlags(SensorOptions* options, std::string* error) {
  options->attitude_sigma = DegToRad(FLAGS_attitude_sigma_deg);
  options->odometry_sigma_fraction = FLAGS_odometry_sigma_fraction;
  options->odometry_sigma = FLAGS_odometry_sigma;
  options->gyro_noise = DegToRad(FLAGS_gyro_noise_deg);
  options->gyro_bias = DegToRad(FLAGS_gyro_bias_deg);
  options->max_gap_s = FLAGS_sensor_max_gap_s;
  if (!ParseDirection(FLAGS_world_down, &options->world_down)) {
    return WrongValue("world_down", FLAGS_world_down, "+z, -z, ... or three numbers", error);
  }
  return true;
}

bool CheckNumber(const std::string& flag, double value, bool may_be_zero, std::string* error) {
  if (std::isfinite(value) && (value > 0 || (may_be_zero && value == 0))) return true;
  return WrongValue(flag, CsvNumber(value), may_be_zero ? "a number >= 0" : "a number > 0", error);
}

void Shift(double offset, const std::string& flag, std::vector<double>* times) {
  if (offset == 0) return;
  for (double& time : *times) time += offset;
  std::cerr << "--" << flag << ": " << CsvNumber(offset) << " s are added to its times\n";
}

void ReportExcess(double excess, const std::string& flag, const std::string& value) {
  // What is estimated from a hundred readings is good to a tenth.
  constexpr double kClearExcess = 1.25;
  if (excess < kClearExcess) return;
  std::cerr << "neighbouring readings differ " << FormatNumber(excess, 1) << " times as much as --"
            << flag << "=" << value << " says; the lines state that\n";
}

std::string Pairs(int count) { return std::to_string(count) + (count == 1 ? " pair" : " pairs"); }

}  // namespace

bool HasSensors() {
  return !FLAGS_attitude.empty() || !FLAGS_odometry.empty() || !FLAGS_gyro.empty();
}

bool CheckSensorFlags(std::string* error) {
  for (const auto& [sensor, flags] : FlagsOfSensors()) {
    const std::string without = IsGiven(sensor) ? "" : FirstGiven(flags);
    if (!without.empty()) {
      return Refuse("--" + without + ": has no effect without --" + sensor, error);
    }
  }
  if (IsGiven("imu_from_body") && FLAGS_attitude.empty() && FLAGS_gyro.empty()) {
    return Refuse("--imu_from_body: has no effect without --attitude or --gyro", error);
  }
  if (IsGiven("sensor_max_gap_s") && !HasSensors()) {
    return Refuse("--sensor_max_gap_s: has no effect without a sensor", error);
  }
  for (const auto& [flag, value] :
       {std::pair("attitude_time_offset_s", FLAGS_attitude_time_offset_s),
        std::pair("odometry_time_offset_s", FLAGS_odometry_time_offset_s),
        std::pair("gyro_time_offset_s", FLAGS_gyro_time_offset_s)}) {
    if (!std::isfinite(value)) return WrongValue(flag, CsvNumber(value), "a finite number", error);
  }
  SensorOptions options;
  return CheckNumber("attitude_sigma_deg", FLAGS_attitude_sigma_deg, false, error) &&
         CheckNumber("odometry_sigma", FLAGS_odometry_sigma, false, error) &&
         CheckNumber("odometry_sigma_fraction", FLAGS_odometry_sigma_fraction, true, error) &&
         CheckNumber("gyro_noise_deg", FLAGS_gyro_noise_deg, false, error) &&
         CheckNumber("gyro_bias_deg", FLAGS_gyro_bias_deg, true, error) &&
         CheckNumber("sensor_max_gap_s", FLAGS_sensor_max_gap_s, false, error) &&
         OptionsFromFlags(&options, error);
}

bool SensorSource::Load(std::string* error) {
  SensorOptions options;
  if (!OptionsFromFlags(&options, error)) return false;
  if (!ReadMounting(FLAGS_imu_from_body, &options.imu_from_body, error)) {
    *error = "--imu_from_body: " + *error;
    return false;
  }
  sensors_ = Sensors(options);
  if (!FLAGS_attitude.empty()) {
    AttitudeSeries series;
    if (!ReadAttitudeFile(FLAGS_attitude, &series, error)) return false;
    Shift(FLAGS_attitude_time_offset_s, "attitude", &series.times);
    sensors_.SetAttitude(std::move(series));
  }
  if (!FLAGS_odometry.empty()) {
    OdometrySeries series;
    if (!ReadOdometryFile(FLAGS_odometry, &series, error)) return false;
    Shift(FLAGS_odometry_time_offset_s, "odometry", &series.readings.times);
    sensors_.SetOdometry(std::move(series));
  }
  if (!FLAGS_gyro.empty()) {
    RateSeries series;
    if (!ReadGyroFile(FLAGS_gyro, &series, error)) return false;
    Shift(FLAGS_gyro_time_offset_s, "gyro", &series.times);
    sensors_.SetGyro(std::move(series));
  }
  ReportExcess(sensors_.AttitudeExcess(), "attitude_sigma_deg",
               CsvNumber(FLAGS_attitude_sigma_deg));
  ReportExcess(sensors_.OdometryExcess(), "odometry_sigma", CsvNumber(FLAGS_odometry_sigma));
  ReportExcess(sensors_.GyroExcess(), "gyro_noise_deg", CsvNumber(FLAGS_gyro_noise_deg));
  return true;
}

void SensorSource::Counts::Add(Coverage coverage, bool is_too_long) {
  switch (coverage) {
    case Coverage::kCovered:
      ++(is_too_long ? too_long : covered);
      break;
    case Coverage::kOutside:
      ++outside;
      break;
    case Coverage::kGap:
      ++gap;
      break;
  }
}

std::map<std::string, std::string> SensorSource::Lines(const FramePair& pair) {
  // Degrees: no road is as steep.
  constexpr double kMostDownOff = DegToRad(45.0);
  if (!pair.time1 || !pair.time2) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++without_times_;
    return {};
  }
  const SensorPriors priors = PriorsBetween(sensors_, *pair.time1, *pair.time2);
  BodyAxes axes;
  std::string ignored;
  const bool gravity_off = priors.prior.gravity1 &&
                           ResolveBodyAxes(pair.rig, {}, {}, &axes, &ignored) &&
                           CamerasOffDown(pair.rig, axes.down) < kMostDownOff &&
                           CamerasOffDown(pair.rig, *priors.prior.gravity1) > kMostDownOff;
  const std::lock_guard<std::mutex> lock(mutex_);
  const double first = std::min(*pair.time1, *pair.time2);
  const double last = std::max(*pair.time1, *pair.time2);
  first_time_ = num_pairs_ == 0 ? first : std::min(first_time_, first);
  last_time_ = num_pairs_ == 0 ? last : std::max(last_time_, last);
  ++num_pairs_;
  with_axis_ += priors.prior.axis ? 1 : 0;
  gravity_off_ += gravity_off ? 1 : 0;
  attitude_.Add(priors.attitude, false);
  gyro_.Add(priors.gyro, false);
  odometry_.Add(priors.odometry, priors.too_long);
  return SensorLines(sensors_, priors);
}

void SensorSource::ReportSensor(const std::string& flag, const std::string& lines,
                                const Counts& counts, const std::vector<double>& times) const {
  std::cerr << "--" << flag << ": " << lines << " in " << counts.covered << " of "
            << Pairs(num_pairs_);
  if (counts.gap > 0) {
    std::cerr << "; " << counts.gap << " in a gap of more than "
              << CsvNumber(FLAGS_sensor_max_gap_s) << " s";
  }
  if (counts.too_long > 0) std::cerr << "; " << counts.too_long << " of more than 5 s";
  if (counts.outside > 0) {
    std::cerr << "; " << counts.outside << " outside its times, " << FormatNumber(times.front(), 3)
              << " to " << FormatNumber(times.back(), 3)
              << " s (the pairs: " << FormatNumber(first_time_, 3) << " to "
              << FormatNumber(last_time_, 3) << " s)";
  }
  std::cerr << "\n";
}

void SensorSource::Report() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (without_times_ > 0) {
    std::cerr << Pairs(without_times_) << " without a line time: no lines from sensors\n";
  }
  if (num_pairs_ == 0) return;
  if (sensors_.attitude()) {
    ReportSensor("attitude", sensors_.gyro() ? "gravity" : "gravity and rotation", attitude_,
                 sensors_.attitude()->times);
  }
  if (sensors_.gyro()) ReportSensor("gyro", "rotation", gyro_, sensors_.gyro()->times);
  if (sensors_.odometry()) {
    ReportSensor("odometry", "distance", odometry_, sensors_.odometry()->readings.times);
  }
  const int turns = (sensors_.gyro() ? gyro_ : attitude_).covered;
  if ((sensors_.gyro() || sensors_.attitude()) && turns > with_axis_) {
    std::cerr << "axis in " << with_axis_ << " of " << Pairs(turns)
              << ": the others turn too little to have one\n";
  }
  if (gravity_off_ > 0) {
    std::cerr << "in " << Pairs(gravity_off_)
              << " gravity is more than 45 degrees off the cameras' down: expected attitudes "
                 "world_from_imu, w x y z; see --imu_from_body, --world_down\n";
  }
}

std::string SensorSource::Settings() {
  std::vector<std::string> names = {"imu_from_body", "sensor_max_gap_s"};
  std::string text;
  for (const auto& [sensor, flags] : FlagsOfSensors()) {
    if (!IsGiven(sensor)) continue;
    text += "sensor " + sensor + "\n";
    names.push_back(sensor);
    names.insert(names.end(), flags.begin(), flags.end());
  }
  if (text.empty()) return "";
  for (const auto& [name, value] : FlagValues({})) {
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      text += name + " " + value + "\n";
    }
  }
  return text;
}

}  // namespace rigel
