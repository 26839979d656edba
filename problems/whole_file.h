// Files that are there whole or not at all.
#ifndef RIGEL_PROBLEMS_WHOLE_FILE_H_
#define RIGEL_PROBLEMS_WHOLE_FILE_H_

#include <string>

namespace rigel {

// Writes `text` to a temporary file beside `path`, which then takes its place, so that `path` is
// never half a file. False with a message, one line of printable text, if that fails.
bool WriteWholeFile(const std::string& path, const std::string& text, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_WHOLE_FILE_H_
