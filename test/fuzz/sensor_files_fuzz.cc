// Files of sensors: any bytes either are read, and give priors that are valid, or a one-line
// message.
#include "rigel/problems/sensors/sensor_files.h"

#include "rigel/core/pose.h"
#include "rigel/problems/sensors/sensor_priors.h"
#include "rigel/test/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  static const rigel::fuzz::Folder folder;
  folder.Write("a.csv", std::string(reinterpret_cast<const char*>(data), size));
  const std::string path = folder.Path("a.csv");
  std::string error;
  rigel::Sensors sensors{rigel::SensorOptions()};
  std::vector<double> times;
  const auto take = [&](bool read, auto& series, auto set) {
    if (!read) {
      rigel::fuzz::RequireMessage(error);
      return;
    }
    set(std::move(series));
  };
  rigel::AttitudeSeries attitude;
  take(rigel::ReadAttitudeFile(path, &attitude, &error), attitude, [&](auto series) {
    times = series.times;
    sensors.SetAttitude(std::move(series));
  });
  rigel::OdometrySeries odometry;
  take(rigel::ReadOdometryFile(path, &odometry, &error), odometry, [&](auto series) {
    times = series.readings.times;
    sensors.SetOdometry(std::move(series));
  });
  rigel::RateSeries gyro;
  take(rigel::ReadGyroFile(path, &gyro, &error), gyro, [&](auto series) {
    times = series.times;
    sensors.SetGyro(std::move(series));
  });
  if (times.empty()) return 0;
  for (size_t k = 1; k < times.size(); ++k) Require(times[k] > times[k - 1], "increasing times");
  rigel::PriorsBetween(sensors, times.front(), times.back());
  rigel::PriorsBetween(sensors, times.back(), (times.front() + times.back()) / 2);
  return 0;
}
