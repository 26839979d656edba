#include "rigel/problems/match_header.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include "rigel/problems/match_file.h"
#include "rigel/problems/whole_file.h"

namespace rigel {

std::string ReplaceHeaderLines(const std::string& text,
                               const std::map<std::string, std::string>& lines) {
  constexpr char kBlanks[] = " \t\r";
  std::string result;
  size_t begin = 0;
  while (begin < text.size()) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const size_t word = std::min(line.find_first_not_of(kBlanks), line.size());
    const std::string keyword =
        line.substr(word, std::min(line.find_first_of(kBlanks, word), line.size()) - word);
    if (keyword == "matches") {
      for (const auto& [ignored, new_line] : lines) {
        if (!new_line.empty()) result += new_line + "\n";
      }
      break;
    }
    if (lines.count(keyword) == 0) result += text.substr(begin, end + 1 - begin);
    begin = end + 1;
  }
  return begin < text.size() ? result + text.substr(begin) : result;
}

bool RewriteMatchFile(const std::string& from, const std::map<std::string, std::string>& lines,
                      const std::string& to, std::string* error) {
  std::ifstream file(from, std::ios::binary);
  std::ostringstream stream;
  if (file) stream << file.rdbuf();
  if (!file) {
    *error = PrintablePath(from) + ": cannot be read: " + std::generic_category().message(errno);
    return false;
  }
  FramePair pair;
  if (!ParseMatches(stream.str(), from, &pair, error)) return false;
  const std::string text = ReplaceHeaderLines(stream.str(), lines);
  return ParseMatches(text, to + ": not written, it could not be read back", &pair, error) &&
         WriteWholeFile(to, text, error);
}

}  // namespace rigel
