#include "rigel/problems/match_header.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include "rigel/problems/match_file.h"

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
  std::string result;
  size_t begin = 0;
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
  std::ifstream file(path, std::ios::binary);
  std::ostringstream stream;
  if (file) stream << file.rdbuf();
  if (!file) {
    *error = PrintablePath(path) + ": cannot be read: " + std::generic_category().message(errno);
    return false;
  }
  FramePair pair;
  if (!ParseMatches(stream.str(), path, &pair, error)) return false;
  *text = ReplaceHeaderLines(stream.str(), lines);
  return ParseMatches(*text, path + ": not written, it could not be read back", &pair, error);
}

std::string FindHeaderComment(const std::string& path, const std::string& words) {
  std::ifstream file(path, std::ios::binary);
  for (std::string line; std::getline(file, line) && FirstWord(line) != "matches";) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    if (IsComment(line, words)) return line;
  }
  return "";
}

}  // namespace rigel
