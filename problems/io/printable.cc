#include "rigel/problems/io/printable.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace rigel {
namespace {

// A character at the beginning of a text.
struct Character {
  uint32_t code = 0;
  size_t length = 0;  // bytes; 0: not UTF-8
};

Character FirstCharacter(std::string_view text) {
  const auto byte = [&](size_t n) {
    return n < text.size() ? static_cast<unsigned char>(text[n]) : 0u;
  };
  const uint32_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  size_t tail;
  uint32_t code;
  uint32_t low = 0x80, high = 0xbf;  // range of the second byte
  if (lead >= 0xc2 && lead <= 0xdf) {
    tail = 1;
    code = lead & 0x1f;
  } else if (lead >= 0xe0 && lead <= 0xef) {
    tail = 2;
    code = lead & 0x0f;
    if (lead == 0xe0) low = 0xa0;
    if (lead == 0xed) high = 0x9f;
  } else if (lead >= 0xf0 && lead <= 0xf4) {
    tail = 3;
    code = lead & 0x07;
    if (lead == 0xf0) low = 0x90;
    if (lead == 0xf4) high = 0x8f;
  } else {
    return {};
  }
  if (byte(1) < low || byte(1) > high) return {};
  for (size_t n = 1; n <= tail; ++n) {
    if ((byte(n) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(n) & 0x3f);
  }
  return {code, tail + 1};
}

bool IsHarmful(uint32_t code) {
  if (code < 0x20 || (code >= 0x7f && code <= 0x9f)) return true;  // control characters
  return code == 0x061c || code == 0x200e || code == 0x200f ||     // marks of direction
         (code >= 0x2028 && code <= 0x202e) ||                     // line ends, overrides
         (code >= 0x2066 && code <= 0x2069) ||                     // isolates
         code == 0xfeff;                                           // byte order mark
}

void AppendHex(char c, std::string* out) {
  constexpr char kDigits[] = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  *out += "\\x";
  *out += kDigits[byte >> 4];
  *out += kDigits[byte & 15];
}

}  // namespace

std::string Printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character c = FirstCharacter(text);
    const size_t length = c.length > 0 ? c.length : 1;
    if (c.length == 0 || IsHarmful(c.code)) {
      for (const char byte : text.substr(0, length)) AppendHex(byte, &out);
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(length);
  }
  return out;
}

std::string Quoted(std::string_view word) {
  // Bytes: enough to know it again, and the message stays a line.
  constexpr size_t kMaxLength = 30;
  if (word.size() <= kMaxLength) return "'" + Printable(word) + "'";
  // Not within a character.
  size_t end = kMaxLength;
  while (end > kMaxLength - 3 && (word[end] & 0xc0) == 0x80) --end;
  return "'" + Printable(word.substr(0, end)) + "...'";
}

std::string PrintableJson(const std::string& json) {
  std::string out;
  for (std::string_view text = json; !text.empty();) {
    const Character c = FirstCharacter(text);
    const size_t length = c.length > 0 ? c.length : 1;
    // Those below are escaped in strings already, and white space between them.
    if (c.code >= 0x7f && IsHarmful(c.code)) {
      char escape[8];
      std::snprintf(escape, sizeof(escape), "\\u%04x", c.code);
      out += escape;
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(length);
  }
  return out;
}

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const size_t length = FirstCharacter(text).length;
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace rigel
