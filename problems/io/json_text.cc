#include "rigel/problems/io/json_text.h"

#include <cstdint>
#include <limits>
#include <stdexcept>

#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

// The line at which brackets nest deeper than is allowed, 0 if they do not. Brackets in strings
// are none; of what is not JSON the library tells.
int LineTooDeep(std::string_view text) {
  int line = 1;
  int depth = 0;
  bool in_string = false;
  for (size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == '\n') ++line;
    if (in_string) {
      if (c == '\\') {
        ++k;
      } else if (c == '"') {
        in_string = false;
      }
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxJsonDepth) return line;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return 0;
}

}  // namespace

nlohmann::ordered_json ParseJson(std::string_view text) {
  if (text.size() > kMaxJsonBytes) {
    throw std::runtime_error("larger than 1 GiB, the most that is read");
  }
  const int line = LineTooDeep(text);
  if (line > 0) {
    throw std::runtime_error("line " + std::to_string(line) + ": nested more than " +
                             std::to_string(kMaxJsonDepth) + " deep");
  }
  return nlohmann::ordered_json::parse(text.begin(), text.end());
}

std::string QuoteJson(const nlohmann::ordered_json& value) {
  if (value.is_structured()) return std::string("an ") + value.type_name();
  return Quoted(value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

int JsonInteger(const nlohmann::ordered_json& value, int min) {
  const bool is_integer = value.is_number_integer();
  const int64_t number = is_integer ? value.get<int64_t>() : 0;
  if (!is_integer || number < min || number > std::numeric_limits<int>::max()) {
    throw std::runtime_error(QuoteJson(value) + ", expected an integer from " +
                             std::to_string(min));
  }
  return static_cast<int>(number);
}

}  // namespace rigel
