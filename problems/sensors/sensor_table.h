// Tables of a sensor's readings: CSV, one reading a row, the time first.
//
//   - Comment lines start with '#', blank lines are skipped.
//   - The columns are named by the first line if it does not begin with a number, else by the last
//     comment above the first row with as many cells as that row. A name may have a unit behind it:
//     "timestamp [ns]".
//   - Times are seconds, or what the unit says: [ns], [us], [ms], [s]. Whole numbers of 16 or more
//     digits are nanoseconds without it. Each time is after the one before.
//
// Messages are one line: file, line, what was found and what was expected.
#ifndef RIGEL_PROBLEMS_SENSORS_SENSOR_TABLE_H_
#define RIGEL_PROBLEMS_SENSORS_SENSOR_TABLE_H_

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "rigel/problems/io/text_lines.h"

namespace rigel {

class SensorTable {
 public:
  struct Column {
    std::string name;  // lower case, without its unit
    std::string unit;  // what stands in brackets; may be empty
  };

  // False with a message if the file cannot be read or has fewer than two readings, if its rows
  // differ in length, or if the first column is not named as a time.
  bool Read(const std::string& path, std::string* error);

  bool has_names() const { return !columns_.empty(); }
  size_t num_columns() const { return num_columns_; }
  const std::vector<Column>& columns() const { return columns_; }

  // The one column of such a name; `what` is how messages call it. False with a message if there is
  // none or more than one, or if its unit is not one of `units`. No unit is always right.
  bool Find(const std::function<bool(std::string_view name)>& is_name, const std::string& what,
            const std::vector<std::string_view>& units, size_t* column, std::string* error) const;

  // Converts the times and these columns; value k of a reading is at columns.size() * row + k.
  // False with a message if one is no finite number or the times do not increase.
  bool Convert(const std::vector<size_t>& columns, std::vector<double>* times,
               std::vector<double>* values, std::string* error) const;

  // "path:line" of a reading.
  std::string WhereIs(size_t row) const { return Where(path_, rows_[row]); }

  // False with a message of the whole file.
  bool Fail(const std::string& what, std::string* error) const;

 private:
  bool NameColumns(const TextLine& line, std::string* error);
  bool TimeUnit(double* seconds, std::string* error) const;

  std::string path_;
  std::vector<Column> columns_;  // empty: without names
  size_t num_columns_ = 0;
  std::vector<TextLine> rows_;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SENSORS_SENSOR_TABLE_H_
