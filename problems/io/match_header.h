// Replaces header lines of match files. All other lines, with comments, are unchanged.
#ifndef RIGEL_PROBLEMS_IO_MATCH_HEADER_H_
#define RIGEL_PROBLEMS_IO_MATCH_HEADER_H_

#include <map>
#include <string>

#include "rigel/core/frame_pair.h"

namespace rigel {

// Removes the lines of these keywords from the header of a match file's text, and inserts the given
// lines (without a line break; none if empty) before its `matches` line. A keyword that begins with
// "#" stands for the comment lines that begin with it.
std::string ReplaceHeaderLines(const std::string& text,
                               const std::map<std::string, std::string>& lines);

// *text is the text of the match file `path` with these lines. False with a message if the file
// cannot be read, or if it is no match file, before or after the change.
bool ReadWithHeaderLines(const std::string& path, const std::map<std::string, std::string>& lines,
                         std::string* text, std::string* error);

// WriteMatchFile() with these lines. False with a message if the file cannot be written, or could
// not be read back.
bool WriteMatchFile(const std::string& path, const FramePair& pair,
                    const std::map<std::string, std::string>& lines, std::string* error);

// The first comment line in the header of the file that begins with these words. Empty if there is
// none, or if the file cannot be read.
std::string FindHeaderComment(const std::string& path, const std::string& words);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MATCH_HEADER_H_
