#include "rigel/problems/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace rigel {

std::string Table::Format() const {
  std::vector<size_t> widths;
  const auto measure = [&](const std::vector<std::vector<std::string>>& rows) {
    for (const auto& row : rows) {
      if (widths.size() < row.size()) widths.resize(row.size(), 0);
      for (size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    }
  };
  measure(headers_);
  measure(rows_);

  std::string text;
  const auto append = [&](const std::vector<std::string>& row) {
    std::string line;
    for (size_t c = 0; c < row.size(); ++c) {
      if (c > 0) line += std::string(gap_, ' ');
      const std::string padding(widths[c] - row[c].size(), ' ');
      line += c == 0 ? row[c] + padding : padding + row[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  for (const auto& row : headers_) append(row);
  size_t total = widths.empty() ? 0 : gap_ * (widths.size() - 1);
  for (const size_t width : widths) total += width;
  if (!headers_.empty()) text += std::string(total, '-') + "\n";
  for (const auto& row : rows_) append(row);
  return text;
}

std::string FormatNumber(std::optional<double> value, int digits) {
  if (!value.has_value() || !std::isfinite(*value)) return "-";
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, *value);
  return text;
}

}  // namespace rigel
