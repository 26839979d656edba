// JSON that somebody else wrote: bounded, and quoted in messages only in part.
#ifndef RIGEL_PROBLEMS_IO_JSON_TEXT_H_
#define RIGEL_PROBLEMS_IO_JSON_TEXT_H_

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace rigel {

// Bytes that a report may have: a bound on the memory that a wrong file takes.
inline constexpr size_t kMaxJsonBytes = size_t{1} << 30;
// Reports nest 6 deep; what the JSON library does recursively, it does to this depth at most.
inline constexpr int kMaxJsonDepth = 64;

// Throws std::exception with a message for people if the text is not JSON or beyond the bounds.
nlohmann::ordered_json ParseJson(std::string_view text);

// A value for a message: short, of an array or object only what it is.
std::string QuoteJson(const nlohmann::ordered_json& value);

// The value as an integer. Throws std::exception with a message for people if it is none, below
// `min` or larger than an int.
int JsonInteger(const nlohmann::ordered_json& value, int min);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_JSON_TEXT_H_
