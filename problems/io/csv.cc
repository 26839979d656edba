#include "rigel/problems/io/csv.h"

#include <charconv>
#include <cmath>

#include "rigel/problems/io/printable.h"

namespace rigel {

std::string CsvText(std::string_view text) {
  std::string cell = Printable(text);
  if (cell.find_first_of(",\"") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string CsvNumber(double value) {
  if (!std::isfinite(value)) return "";
  char text[32];
  const auto result = std::to_chars(text, text + sizeof(text), value);
  return std::string(text, result.ptr);
}

}  // namespace rigel
