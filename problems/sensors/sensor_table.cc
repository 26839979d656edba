#include "rigel/problems/sensors/sensor_table.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <utility>

#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

constexpr double kSecondsPerNanosecond = 1e-9;

// Seconds since 1970 have ten digits; as many as these are 30 million years.
constexpr int64_t kLeastNanoseconds = 1'000'000'000'000'000;

bool IsNumber(std::string_view word) {
  double ignored;
  return ParseFinite(word, &ignored);
}

SensorTable::Column ColumnOf(std::string_view cell) {
  SensorTable::Column column;
  const size_t bracket = std::min(cell.find('['), cell.size());
  std::string_view unit = cell.substr(bracket);
  if (!unit.empty()) unit.remove_prefix(1);
  column.unit = std::string(TrimBlanks(unit.substr(0, unit.find(']'))));
  column.name = std::string(TrimBlanks(cell.substr(0, bracket)));
  for (char& c : column.name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return column;
}

}  // namespace

bool SensorTable::Fail(const std::string& what, std::string* error) const {
  *error = Printable(path_) + ": " + what;
  return false;
}

bool SensorTable::NameColumns(const TextLine& line, std::string* error) {
  std::string_view text = line.text;
  text.remove_prefix(std::min(text.find_first_not_of('#'), text.size()));
  columns_.clear();
  for (const std::string_view cell : SplitAtCommas(text)) columns_.push_back(ColumnOf(cell));
  const std::string& time = columns_.front().name;
  if (time == "t" || time.find("time") != std::string::npos ||
      time.find("stamp") != std::string::npos) {
    return true;
  }
  *error = Where(path_, line) + ": the first column is " + Quoted(time) + ", expected the time";
  return false;
}

bool SensorTable::Read(const std::string& path, std::string* error) {
  path_ = path;
  columns_.clear();
  rows_.clear();
  std::vector<TextLine> lines;
  if (!ReadLinesAndComments(path, &lines, error)) return false;
  std::vector<TextLine> comments;  // above the first row
  for (TextLine& line : lines) {
    if (line.text[0] != '#') {
      rows_.push_back(std::move(line));
    } else if (rows_.empty()) {
      comments.push_back(std::move(line));
    }
  }
  const TextLine* names = nullptr;
  TextLine first;
  if (!rows_.empty() && !IsNumber(SplitAtCommas(rows_.front().text).front())) {
    first = rows_.front();
    names = &first;
    rows_.erase(rows_.begin());
  }
  if (rows_.size() < 2) {
    return Fail(std::to_string(rows_.size()) + " readings, expected at least 2: lines of a time " +
                    "and values, separated by commas",
                error);
  }
  const auto cells = [](const TextLine& line) { return SplitAtCommas(line.text).size(); };
  num_columns_ = cells(names != nullptr ? *names : rows_.front());
  for (const TextLine& comment : comments) {
    if (names != &first && num_columns_ > 1 && cells(comment) == num_columns_) names = &comment;
  }
  for (const TextLine& row : rows_) {
    if (cells(row) == num_columns_) continue;
    *error = Where(path_, row) + ": " + std::to_string(cells(row)) + " columns, expected " +
             std::to_string(num_columns_) + " as in the first line";
    return false;
  }
  return names == nullptr || NameColumns(*names, error);
}

bool SensorTable::Find(const std::function<bool(std::string_view name)>& is_name,
                       const std::string& what, const std::vector<std::string_view>& units,
                       size_t* column, std::string* error) const {
  *column = 0;
  for (size_t k = 1; k < columns_.size(); ++k) {
    if (!is_name(columns_[k].name)) continue;
    if (*column > 0) return Fail("two columns could be " + what + ", expected one", error);
    *column = k;
  }
  if (*column == 0) return Fail("no column is named " + what, error);
  const std::string& unit = columns_[*column].unit;
  if (unit.empty() || std::find(units.begin(), units.end(), unit) != units.end()) return true;
  return Fail(
      "the unit of " + what + " is " + Quoted(unit) + ", expected " + std::string(units.front()),
      error);
}

// 0: whole nanoseconds.
bool SensorTable::TimeUnit(double* seconds, std::string* error) const {
  const std::string unit = has_names() ? columns_.front().unit : "";
  const std::string_view first = SplitAtCommas(rows_.front().text).front();
  int64_t ignored;
  if (unit == "ns" || (unit.empty() && ParseInteger(first, kLeastNanoseconds, &ignored))) {
    *seconds = 0;
  } else if (unit.empty() || unit == "s") {
    *seconds = 1;
  } else if (unit == "us") {
    *seconds = 1e-6;
  } else if (unit == "ms") {
    *seconds = 1e-3;
  } else {
    return Fail("the unit of the time is " + Quoted(unit) + ", expected ns, us, ms or s", error);
  }
  return true;
}

bool SensorTable::Convert(const std::vector<size_t>& columns, std::vector<double>* times,
                          std::vector<double>* values, std::string* error) const {
  times->clear();
  values->clear();
  double unit;
  if (!TimeUnit(&unit, error)) return false;
  for (const TextLine& row : rows_) {
    const std::vector<std::string_view> cells = SplitAtCommas(row.text);
    const auto fail = [&](const std::string& what) {
      *error = Where(path_, row) + ": " + what;
      return false;
    };
    double time;
    int64_t nanoseconds;
    if (unit > 0) {
      if (!ParseFinite(cells.front(), &time)) {
        return fail("the time is " + Quoted(cells.front()) + ", expected a finite number");
      }
      time *= unit;
    } else {
      if (!ParseInteger(cells.front(), int64_t{0}, &nanoseconds)) {
        return fail("the time is " + Quoted(cells.front()) + ", expected whole nanoseconds");
      }
      time = static_cast<double>(nanoseconds) * kSecondsPerNanosecond;
    }
    if (!times->empty() && time <= times->back()) {
      return fail("the time " + std::string(cells.front()) +
                  " is not after that of the row before, expected times that increase");
    }
    times->push_back(time);
    for (const size_t column : columns) {
      double value;
      if (!ParseFinite(cells[column], &value)) {
        return fail("column " + std::to_string(column + 1) + " is " + Quoted(cells[column]) +
                    ", expected a finite number");
      }
      values->push_back(value);
    }
  }
  return true;
}

}  // namespace rigel
