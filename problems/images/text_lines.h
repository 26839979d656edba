// Text files of numbers, line by line.
#ifndef RIGEL_PROBLEMS_IMAGES_TEXT_LINES_H_
#define RIGEL_PROBLEMS_IMAGES_TEXT_LINES_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rigel {

struct TextLine {
  int number = 0;  // from 1
  std::string text;
};

// The lines that are not blank and do not start with '#', without blanks at their ends. False with
// a message if the file cannot be read.
bool ReadTextLines(const std::string& path, std::vector<TextLine>* lines, std::string* error);

// "path:line"; a path as one line of text.
std::string Where(const std::string& path, const TextLine& line);

std::string_view TrimBlanks(std::string_view text);

// Between blanks; never empty.
std::vector<std::string_view> SplitAtBlanks(std::string_view text);

// Between commas, without blanks around them; may be empty.
std::vector<std::string_view> SplitAtCommas(std::string_view text);

// A word of a file for a message: quoted, short and printable.
std::string Quoted(std::string_view word);

// False if the whole word is not a finite number.
bool ParseFinite(std::string_view word, double* value);

// False if the whole word is not an integer from 0.
bool ParseTimestamp(std::string_view word, int64_t* value);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_TEXT_LINES_H_
