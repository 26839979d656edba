#include "rigel/problems/io/match_file_words.h"

#include <charconv>
#include <cmath>
#include <system_error>

namespace rigel::match_file {

bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

bool ParseNumber(std::string_view word, double* value) {
  const char* begin = word.data();
  const char* const end = begin + word.size();
  // from_chars takes no plus sign, though printf("%+g") writes one.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') ++begin;
  const auto [stop, status] = std::from_chars(begin, end, *value);
  return status == std::errc() && stop == end && std::isfinite(*value);
}

}  // namespace rigel::match_file
