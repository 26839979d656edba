// Reads JSON of foreign files, with bounds on its size.
#ifndef RIGEL_PROBLEMS_IO_JSON_TEXT_H_
#define RIGEL_PROBLEMS_IO_JSON_TEXT_H_

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace rigel {

// Bytes of a report: bounds the memory that a wrong file takes.
inline constexpr size_t kMaxJsonBytes = size_t{1} << 30;
// Levels of brackets. Reports have 6. The JSON library recurses once a level.
inline constexpr int kMaxJsonDepth = 64;

// Throws std::exception with a message for people if the text is not JSON or beyond the bounds.
nlohmann::ordered_json ParseJson(std::string_view text);

// A value for a message: shortened; only the type of an array or object.
std::string QuoteJson(const nlohmann::ordered_json& value);

// The value as an integer. Throws std::exception with a message for people if it is none, below
// `min` or larger than an int.
int JsonInteger(const nlohmann::ordered_json& value, int min);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_JSON_TEXT_H_
