#include "rigel/problems/io/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

// In UTF-8 text: all bytes but those that continue a character.
bool StartsCharacter(char c) { return (c & 0xc0) != 0x80; }

size_t Length(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), StartsCharacter));
}

std::vector<std::string> PrintableCells(const std::vector<std::string>& cells) {
  std::vector<std::string> printable;
  for (const std::string& cell : cells) printable.push_back(Printable(cell));
  return printable;
}

}  // namespace

void Table::AddHeader(const std::vector<std::string>& cells) {
  headers_.push_back(PrintableCells(cells));
}

void Table::AddRow(const std::vector<std::string>& cells) {
  rows_.push_back(PrintableCells(cells));
}

std::string Table::Format() const {
  std::vector<size_t> widths;
  const auto measure = [&](const std::vector<std::vector<std::string>>& rows) {
    for (const auto& row : rows) {
      if (widths.size() < row.size()) widths.resize(row.size(), 0);
      for (size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], Length(row[c]));
    }
  };
  measure(headers_);
  measure(rows_);

  std::string text;
  const auto append = [&](const std::vector<std::string>& row) {
    std::string line;
    for (size_t c = 0; c < row.size(); ++c) {
      if (c > 0) line += std::string(gap_, ' ');
      const std::string padding(widths[c] - Length(row[c]), ' ');
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

std::string FormatShort(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

std::string FormatNumber(std::optional<double> value, int digits) {
  if (!value.has_value() || !std::isfinite(*value)) return "-";
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, *value);
  return text;
}

std::string FormatFitted(std::optional<double> value, int digits, size_t width) {
  std::string text = FormatNumber(value, digits);
  for (int d = digits - 1; d >= 0 && text.size() > width; --d) text = FormatNumber(value, d);
  if (text.size() <= width) return text;
  // One digit and the power of ten, without the "+0" of printf.
  char digit_and_power[64];
  std::snprintf(digit_and_power, sizeof(digit_and_power), "%.0e", *value);
  text = digit_and_power;
  const size_t e = text.find('e');
  return text.substr(0, e + 1) + std::to_string(std::stoi(text.substr(e + 1)));
}

std::string Shortened(const std::string& text, size_t width) {
  if (Length(text) <= width) return text;
  size_t begin = text.size();
  for (size_t kept = 3; kept < width; ++kept) {
    --begin;
    while (begin > 0 && !StartsCharacter(text[begin])) --begin;
  }
  return "..." + text.substr(begin);
}

}  // namespace rigel
