// Numbers of text files and flags. A word is a number as a whole or not at all.
#ifndef RIGEL_PROBLEMS_IO_PARSE_NUMBER_H_
#define RIGEL_PROBLEMS_IO_PARSE_NUMBER_H_

#include <charconv>
#include <string_view>
#include <system_error>

namespace rigel {

// A plus sign is allowed. False if the word is not a finite number; *value may then have changed.
bool ParseFinite(std::string_view word, double* value);

// False if the word is not an integer of that type from `min` on; *value may then have changed.
template <class Integer>
bool ParseInteger(std::string_view word, Integer min, Integer* value) {
  const char* const end = word.data() + word.size();
  Integer parsed = 0;
  const auto [stop, status] = std::from_chars(word.data(), end, parsed);
  *value = parsed;
  return status == std::errc() && stop == end && parsed >= min;
}

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_PARSE_NUMBER_H_
