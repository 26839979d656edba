#include "rigel/problems/io/match_header.h"

#include <algorithm>
#include <string_view>

#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/whole_file.h"

namespace rigel {

namespace {

constexpr char kBlanks[] = " \t\r";

std::string FirstWord(const std::string& line) {
  const size_t word = std::min(line.find_first_not_of(kBlanks), line.size());
  return line.substr(word, std::min(line.find_first_of(kBlanks, word), line.size()) - word);
}

// Whether the line is a comment and begins with these words.
bool IsComment(const std::string& line, const std::string& words) {
  return !words.empty() && words[0] == '#' && line.compare(0, words.size(), words) == 0 &&
         (line.size() == words.size() || line[words.size()] == ' ');
}

}  // namespace

std::string ReplaceHeaderLines(const std::string& text,
                               const std::map<std::string, std::string>& lines) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  size_t begin = text.compare(0, kByteOrderMark.size(), kByteOrderMark) == 0 ? 3 : 0;
  std::string result = text.substr(0, begin);
  while (begin < text.size()) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const std::string keyword = FirstWord(line);
    if (keyword == "matches") {
      for (const auto& [ignored, new_line] : lines) {
        if (!new_line.empty()) result += new_line + "\n";
      }
      break;
    }
    const bool replaced = std::any_of(lines.begin(), lines.end(), [&](const auto& entry) {
      return entry.first == keyword || IsComment(line, entry.first);
    });
    if (!replaced) result += text.substr(begin, end + 1 - begin);
    begin = end + 1;
  }
  return begin < text.size() ? result + text.substr(begin) : result;
}

bool ReadWithHeaderLines(const std::string& path, const std::map<std::string, std::string>& lines,
                         std::string* text, std::string* error) {
  InputBytes bytes;
  FramePair pair;
  if (!ReadInputFile(path, &bytes, error) || !ParseMatches(bytes.text(), path, &pair, error)) {
    return false;
  }
  *text = ReplaceHeaderLines(std::string(bytes.text()), lines);
  return ParseMatches(*text, path + ": not written, it could not be read back", &pair, error);
}

bool WriteMatchFile(const std::string& path, const FramePair& pair,
                    const std::map<std::string, std::string>& lines, std::string* error) {
  const std::string text = ReplaceHeaderLines(FormatMatches(pair), lines);
  FramePair ignored;
  return ParseMatches(text, path + ": not written, it could not be read back", &ignored, error) &&
         WriteWholeFile(path, MatchFileBytes(path, text), error);
}

std::string FindHeaderComment(const std::string& path, const std::string& words) {
  InputBytes bytes;
  std::string ignored;
  if (!ReadInputFile(path, &bytes, &ignored)) return "";
  std::string_view text = bytes.text();
  int64_t line_number;
  if (!CheckText(&text, &line_number, &ignored)) return "";
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string line(text.substr(0, end));
    if (FirstWord(line) == "matches") break;
    while (!line.empty() && line.back() == '\r') line.pop_back();
    if (IsComment(line, words)) return line;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return "";
}

}  // namespace rigel
