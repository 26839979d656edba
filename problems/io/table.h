// Plain-text tables with aligned columns.
#ifndef RIGEL_PROBLEMS_IO_TABLE_H_
#define RIGEL_PROBLEMS_IO_TABLE_H_

#include <optional>
#include <string>
#include <vector>

namespace rigel {

// Columns are as wide as their widest cell, in UTF-8 characters; the first is aligned left, the
// others right, `gap` blanks apart. No trailing blanks. What a terminal would obey
// (rigel/problems/io/printable.h) is shown in hexadecimal.
class Table {
 public:
  explicit Table(int gap = 2) : gap_(gap) {}

  // Several header rows are allowed.
  void AddHeader(const std::vector<std::string>& cells);
  void AddRow(const std::vector<std::string>& cells);
  std::string Format() const;

 private:
  int gap_;
  std::vector<std::vector<std::string>> headers_;
  std::vector<std::vector<std::string>> rows_;
};

// Six significant digits.
std::string FormatShort(double value);

// Fixed-point with `digits` decimals; "-" for nothing or a number that is not finite.
std::string FormatNumber(std::optional<double> value, int digits);

// The same with as many of the decimals as fit into `width` characters; where not even the integer
// does, "2e4".
std::string FormatFitted(std::optional<double> value, int digits, size_t width);

// The text, or "..." and its end if it has more than `width` UTF-8 characters.
std::string Shortened(const std::string& text, size_t width);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_TABLE_H_
