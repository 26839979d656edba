// Words of files and names of files as they may be shown: on a terminal they must be read, not
// obeyed.
#ifndef RIGEL_PROBLEMS_IO_PRINTABLE_H_
#define RIGEL_PROBLEMS_IO_PRINTABLE_H_

#include <string>
#include <string_view>

namespace rigel {

// The text with the bytes of what commands a terminal or misleads the eye in hexadecimal, "\x1b":
// control characters (C0, delete, C1), marks that turn the direction of writing, line separators,
// byte order marks, and bytes that are not UTF-8. Other UTF-8 stays as it is.
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
