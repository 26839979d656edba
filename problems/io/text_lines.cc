#include "rigel/problems/io/text_lines.h"

#include <algorithm>

#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

constexpr std::string_view kBlanks = " \t\r";

// Bytes: a month of poses at 10 Hz. As lines they take several times this memory.
constexpr size_t kMaxTableBytes = size_t{256} << 20;

// Calls line(number, text) for each line, without blanks at its ends, while that returns true.
template <class Line>
bool ForEachLine(const std::string& path, std::string* error, const Line& line) {
  InputBytes bytes;
  if (!ReadInputFile(path, &bytes, error, kMaxTableBytes)) return false;
  std::string_view text = bytes.text();
  int64_t bad_line;
  std::string what;
  if (!CheckText(&text, &bad_line, &what)) {
    *error = Printable(path) + (bad_line > 0 ? ":" + std::to_string(bad_line) : "") + ": " + what +
             ", expected UTF-8 text";
    return false;
  }
  for (int number = 1; !text.empty(); ++number) {
    const size_t end = std::min(text.find('\n'), text.size());
    if (!line(number, TrimBlanks(text.substr(0, end)))) return false;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return true;
}

}  // namespace

bool ReadTextLines(const std::string& path, std::vector<TextLine>* lines, std::string* error) {
  lines->clear();
  return ForEachLine(path, error, [&](int number, std::string_view text) {
    if (!text.empty() && text[0] != '#') lines->push_back({number, std::string(text)});
    return true;
  });
}

bool ReadLinesAndComments(const std::string& path, std::vector<TextLine>* lines,
                          std::string* error) {
  lines->clear();
  return ForEachLine(path, error, [&](int number, std::string_view text) {
    if (!text.empty()) lines->push_back({number, std::string(text)});
    return true;
  });
}

bool ReadFrameLines(const std::string& path, std::vector<TextLine>* lines, std::string* error) {
  lines->clear();
  const auto refuse = [&](int number, const char* what) {
    *error = Where(path, {number, ""}) + ": " + what + ", expected that of frame " +
             std::to_string(number - 1) + ": every line is that of a frame";
    return false;
  };
  return ForEachLine(path, error, [&](int number, std::string_view text) {
    const int next = static_cast<int>(lines->size()) + 1;
    if (text.empty()) return true;
    if (number > next) return refuse(next, "a blank line");
    if (text[0] == '#') return refuse(number, "a comment");
    lines->push_back({number, std::string(text)});
    return true;
  });
}

std::string Where(const std::string& path, const TextLine& line) {
  return Printable(path) + ":" + std::to_string(line.number);
}

std::string_view TrimBlanks(std::string_view text) {
  const size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  text.remove_prefix(begin);
  const size_t last = text.find_last_not_of(kBlanks);
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

std::vector<std::string_view> SplitAtBlanks(std::string_view text) {
  std::vector<std::string_view> words;
  for (size_t begin = text.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kBlanks, end);
  }
  return words;
}

std::vector<std::string_view> SplitAtCommas(std::string_view text) {
  std::vector<std::string_view> words;
  for (;;) {
    const size_t comma = text.find(',');
    words.push_back(TrimBlanks(text.substr(0, comma)));
    if (comma == std::string_view::npos) return words;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace rigel
