// Plain-text tables with aligned columns.
#ifndef RIGEL_PROBLEMS_TABLE_H_
#define RIGEL_PROBLEMS_TABLE_H_

#include <optional>
#include <string>
#include <vector>

namespace rigel {

// Columns are as wide as their widest cell; the first is aligned left, the others right, `gap`
// blanks apart. No trailing blanks.
class Table {
 public:
  explicit Table(int gap = 2) : gap_(gap) {}

  // Several header rows are allowed.
  void AddHeader(const std::vector<std::string>& cells) { headers_.push_back(cells); }
  void AddRow(const std::vector<std::string>& cells) { rows_.push_back(cells); }
  std::string Format() const;

 private:
  int gap_;
  std::vector<std::vector<std::string>> headers_;
  std::vector<std::vector<std::string>> rows_;
};

// Fixed-point with `digits` decimals; "-" for nothing or a number that is not finite.
std::string FormatNumber(std::optional<double> value, int digits);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_TABLE_H_
