#include "rigel/problems/images/text_lines.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <system_error>

#include "rigel/problems/match_file.h"

namespace rigel {
namespace {

constexpr std::string_view kBlanks = " \t\r";

}  // namespace

bool ReadTextLines(const std::string& path, std::vector<TextLine>* lines, std::string* error) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    *error = PrintablePath(path) + ": cannot be opened: " + std::generic_category().message(errno);
    return false;
  }
  lines->clear();
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    const std::string_view text = TrimBlanks(line);
    if (!text.empty() && text[0] != '#') lines->push_back({number, std::string(text)});
  }
  if (file.bad()) {
    *error = PrintablePath(path) + ": cannot be read";
    return false;
  }
  return true;
}

std::string Where(const std::string& path, const TextLine& line) {
  return PrintablePath(path) + ":" + std::to_string(line.number);
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

std::string Quoted(std::string_view word) {
  constexpr size_t kMaxLength = 30;
  std::string shown = PrintablePath(std::string(word.substr(0, kMaxLength)));
  if (word.size() > kMaxLength) shown += "...";
  return "'" + shown + "'";
}

bool ParseFinite(std::string_view word, double* value) {
  // from_chars takes no plus sign.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [stop, status] = std::from_chars(word.data(), end, *value);
  return status == std::errc() && stop == end && std::isfinite(*value);
}

bool ParseTimestamp(std::string_view word, int64_t* value) {
  const char* const end = word.data() + word.size();
  const auto [stop, status] = std::from_chars(word.data(), end, *value);
  return status == std::errc() && stop == end && *value >= 0;
}

}  // namespace rigel
