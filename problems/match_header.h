// Header lines of match files, changed in place: all else, comments too, stays as it is.
#ifndef RIGEL_PROBLEMS_MATCH_HEADER_H_
#define RIGEL_PROBLEMS_MATCH_HEADER_H_

#include <map>
#include <string>

namespace rigel {

// Takes the lines of these keywords out of the header of a match file's text and puts those given
// (without a line break; none if empty) before its `matches` line.
std::string ReplaceHeaderLines(const std::string& text,
                               const std::map<std::string, std::string>& lines);

// Reads the match file `from` and writes it with those lines to `to`, which may be the same: a
// reader finds the old file there or the new one, never half a file. False with a message if one of
// them is no match file, or if reading or writing fails; `to` is then as it was.
bool RewriteMatchFile(const std::string& from, const std::map<std::string, std::string>& lines,
                      const std::string& to, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_MATCH_HEADER_H_
