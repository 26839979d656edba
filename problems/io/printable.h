// Text of files and file names, made safe to show: control characters in it must not act on a
// terminal.
#ifndef RIGEL_PROBLEMS_IO_PRINTABLE_H_
#define RIGEL_PROBLEMS_IO_PRINTABLE_H_

#include <string>
#include <string_view>

namespace rigel {

// The text with unsafe bytes in hexadecimal, as "\x1b": control characters (C0, delete, C1), marks
// of writing direction, line separators, byte order marks, and bytes that are not UTF-8. Other
// UTF-8 is unchanged.
std::string Printable(std::string_view text);

// A word of a file for a message: quoted, printable, and cut to 30 bytes.
std::string Quoted(std::string_view word);

// JSON text with the same characters as "\uXXXX": it is read back as the same strings. The text
// must be JSON in UTF-8.
std::string PrintableJson(const std::string& json);

// Well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates, at most U+10FFFF).
bool IsUtf8(std::string_view text);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_PRINTABLE_H_
