// Text files of numbers, line by line.
//
// A file may be compressed by gzip, and a byte order mark of UTF-8 is skipped. Text in another
// encoding, a file larger than kMaxInputBytes (rigel/problems/io/input_file.h) and one that cannot
// be read are refused with a message that names the file.
#ifndef RIGEL_PROBLEMS_IO_TEXT_LINES_H_
#define RIGEL_PROBLEMS_IO_TEXT_LINES_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rigel {

struct TextLine {
  int number = 0;  // from 1
  std::string text;
};

// The lines that are not blank and do not start with '#', without blanks at their ends. For files
// whose lines identify themselves.
bool ReadTextLines(const std::string& path, std::vector<TextLine>* lines, std::string* error);

// The same with the lines that start with '#': one of them may name the columns.
bool ReadLinesAndComments(const std::string& path, std::vector<TextLine>* lines,
                          std::string* error);

// All lines of a file whose line k belongs to frame k, without blanks at their ends. A blank line
// or a comment is refused with its number: if it were skipped, all later frames would get a wrong
// line. Blank lines at the end of the file are allowed.
bool ReadFrameLines(const std::string& path, std::vector<TextLine>* lines, std::string* error);

// "path:line"; a path as one line of text.
std::string Where(const std::string& path, const TextLine& line);

std::string_view TrimBlanks(std::string_view text);

// Between blanks; never empty.
std::vector<std::string_view> SplitAtBlanks(std::string_view text);

// Between commas, without blanks around them; may be empty.
std::vector<std::string_view> SplitAtCommas(std::string_view text);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_TEXT_LINES_H_
