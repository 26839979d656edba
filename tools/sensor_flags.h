// The flags of the vehicle's sensors, and the lines that they add to match files.
#ifndef RIGEL_TOOLS_SENSOR_FLAGS_H_
#define RIGEL_TOOLS_SENSOR_FLAGS_H_

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/sensors/sensor_priors.h"

namespace rigel {

// Whether a flag names the file of a sensor.
bool HasSensors();

// Checks the flags without reading a file. False with a message if one is wrong.
bool CheckSensorFlags(std::string* error);

// The sensors that the flags name, and what the pairs got of them.
class SensorSource {
 public:
  SensorSource() : sensors_(SensorOptions()) {}

  // Reads the files. False with a message if one cannot be used. Says on stderr which times are
  // shifted, and where readings scatter more than their stated sigma.
  bool Load(std::string* error);

  // The lines of a pair; none, counted, if it has no times. Thread-safe.
  std::map<std::string, std::string> Lines(const FramePair& pair);

  // Says on stderr how many pairs got which lines, and why not all.
  void Report() const;

  // What the lines are made from, for the settings of a run: the flags but for the paths.
  static std::string Settings();

 private:
  struct Counts {
    int covered = 0, outside = 0, gap = 0, too_long = 0;
    void Add(Coverage coverage, bool is_too_long);
  };
  void ReportSensor(const std::string& flag, const std::string& lines, const Counts& counts,
                    const std::vector<double>& times) const;

  Sensors sensors_;
  mutable std::mutex mutex_;
  int num_pairs_ = 0, without_times_ = 0, with_axis_ = 0, gravity_off_ = 0;
  double first_time_ = 0, last_time_ = 0;  // of the pairs
  Counts attitude_, odometry_, gyro_;
};

}  // namespace rigel

#endif  // RIGEL_TOOLS_SENSOR_FLAGS_H_
