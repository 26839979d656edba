#include "rigel/problems/io/parse_number.h"

#include <cmath>

namespace rigel {

bool ParseFinite(std::string_view word, double* value) {
  // from_chars takes no plus sign, though printf("%+g") writes one.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [stop, status] = std::from_chars(word.data(), end, *value);
  return status == std::errc() && stop == end && std::isfinite(*value);
}

}  // namespace rigel
