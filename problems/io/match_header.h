// Header lines of match files, changed in place: all else, comments too, stays as it is.
#ifndef RIGEL_PROBLEMS_IO_MATCH_HEADER_H_
#define RIGEL_PROBLEMS_IO_MATCH_HEADER_H_

#include <map>
#include <string>

namespace rigel {

// Takes the lines of these keywords out of the header of a match file's text and puts those given
// (without a line break; none if empty) before its `matches` line. A keyword that begins with "#"
// stands for the comment lines that begin with its words.
std::string ReplaceHeaderLines(const std::string& text,
                               const std::map<std::string, std::string>& lines);

// *text is that of the match file `path` with those lines. False with a message if it cannot be
// read, or if it is no match file, before or with them.
bool ReadWithHeaderLines(const std::string& path, const std::map<std::string, std::string>& lines,
                         std::string* text, std::string* error);

// The first comment line in the header of the file that begins with these words; empty if there is
// none, or no such file.
std::string FindHeaderComment(const std::string& path, const std::string& words);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MATCH_HEADER_H_
