#include "rigel/problems/sensors/sensor_files.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "rigel/problems/io/rotation_check.h"
#include "rigel/problems/sensors/sensor_table.h"

namespace rigel {
namespace {

bool BeginsWith(std::string_view name, std::string_view prefix) {
  return name.substr(0, prefix.size()) == prefix;
}

bool IsQuaternionName(std::string_view name, char axis) {
  return name.size() == 1 ? name[0] == axis : BeginsWith(name, "q") && name.back() == axis;
}

bool IsRateName(std::string_view name, char axis) {
  if (name.size() < 2 || name.back() != axis) return false;
  return BeginsWith(name, "w") || BeginsWith(name, "gyr") || BeginsWith(name, "omega") ||
         BeginsWith(name, "ang");
}

// The columns of these axes: by their names, else all in their order.
bool AxisColumns(const SensorTable& table, std::string_view axes, const std::string& prefix,
                 bool (*is_name)(std::string_view name, char axis),
                 const std::vector<std::string_view>& units, std::vector<size_t>* columns,
                 std::string* error) {
  columns->clear();
  if (!table.has_names()) {
    std::string names = "time";
    for (const char axis : axes) {
      names += ", " + prefix + axis;
      columns->push_back(columns->size() + 1);
    }
    return table.num_columns() == axes.size() + 1 ||
           table.Fail(std::to_string(table.num_columns()) +
                          " columns without a line of names, expected " + names,
                      error);
  }
  for (const char axis : axes) {
    columns->emplace_back();
    if (!table.Find([&](std::string_view name) { return is_name(name, axis); }, prefix + axis,
                    units, &columns->back(), error)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool ReadAttitudeFile(const std::string& path, AttitudeSeries* series, std::string* error) {
  SensorTable table;
  std::vector<size_t> columns;
  std::vector<double> values;
  AttitudeSeries read;
  if (!table.Read(path, error) ||
      !AxisColumns(table, "wxyz", "q", IsQuaternionName, {"1"}, &columns, error) ||
      !table.Convert(columns, &read.times, &values, error)) {
    return false;
  }
  for (size_t k = 0; k < read.times.size(); ++k) {
    const double* const q = &values[columns.size() * k];
    read.values.emplace_back(q[0], q[1], q[2], q[3]);
    if (!(std::abs(read.values.back().norm() - 1.0) <= kMaxRotationError)) {
      *error = table.WhereIs(k) + ": the quaternion is not of unit length, expected qw, qx, qy, qz";
      return false;
    }
    read.values.back().normalize();
  }
  *series = std::move(read);
  return true;
}

bool ReadOdometryFile(const std::string& path, OdometrySeries* series, std::string* error) {
  const auto is_speed = [](std::string_view name) {
    return name == "speed" || name == "speed_mps" || name == "velocity";
  };
  const auto is_distance = [](std::string_view name) {
    return name == "distance" || name == "distance_m";
  };
  SensorTable table;
  if (!table.Read(path, error)) return false;
  if (!table.has_names()) {
    return table.Fail("no line names the columns, expected \"time,speed\" or \"time,distance\"",
                      error);
  }
  OdometrySeries read;
  read.is_speed =
      std::any_of(table.columns().begin(), table.columns().end(),
                  [&](const SensorTable::Column& column) { return is_speed(column.name); });
  size_t column;
  const bool found =
      read.is_speed
          ? table.Find([&](std::string_view name) { return is_speed(name) || is_distance(name); },
                       "the speed", {"m/s", "m s^-1"}, &column, error)
          : table.Find(is_distance, "speed (m/s) or distance (m)", {"m"}, &column, error);
  if (!found || !table.Convert({column}, &read.readings.times, &read.readings.values, error)) {
    return false;
  }
  *series = std::move(read);
  return true;
}

bool ReadGyroFile(const std::string& path, RateSeries* series, std::string* error) {
  SensorTable table;
  std::vector<size_t> columns;
  std::vector<double> values;
  RateSeries read;
  if (!table.Read(path, error) ||
      !AxisColumns(table, "xyz", "w", IsRateName, {"rad/s", "rad s^-1"}, &columns, error) ||
      !table.Convert(columns, &read.times, &values, error)) {
    return false;
  }
  for (size_t k = 0; k < read.times.size(); ++k) {
    const double* const w = &values[columns.size() * k];
    read.values.emplace_back(w[0], w[1], w[2]);
  }
  *series = std::move(read);
  return true;
}

}  // namespace rigel
