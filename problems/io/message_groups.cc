#include "rigel/problems/io/message_groups.h"

#include <algorithm>
#include <cctype>
#include <unordered_map>
#include <unordered_set>

#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

// Counts at the beginning of a word become #: "16 of 200 matches", not the 4 of "4pt" or "x4".
std::string WithoutNumbers(const std::string& text) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::string masked;
  for (size_t k = 0; k < text.size();) {
    size_t end = k;
    while (end < text.size() && (is_digit(text[end]) || (end > k && text[end] == '.'))) ++end;
    const bool is_word = end > k && (k == 0 || text[k - 1] == ' ') &&
                         (end == text.size() || text[end] == ' ' || text[end] == ',');
    masked += is_word ? "#" : text.substr(k, std::max<size_t>(end - k, 1));
    k = std::max(end, k + 1);
  }
  return masked;
}

}  // namespace

std::vector<std::string> GroupMessages(const std::vector<std::string>& messages,
                                       const std::vector<std::string>& files) {
  std::unordered_set<std::string> names;
  for (const std::string& file : files) names.insert(Printable(file));
  // What follows the longest of the names that the message begins with.
  const auto without_name = [&](const std::string& message) {
    for (size_t colon = message.rfind(':'); colon != std::string::npos && colon > 0;
         colon = message.rfind(':', colon - 1)) {
      if (names.count(message.substr(0, colon)) == 0) continue;
      // With a line of the file it is of that file alone.
      const bool has_line = std::isdigit(static_cast<unsigned char>(message[colon + 1])) != 0;
      return has_line ? message : message.substr(colon);
    }
    return message;
  };
  struct Group {
    std::string line, text;  // the first message, without its name
    int count = 0;
    bool same_numbers = true;
  };
  std::vector<Group> groups;
  std::unordered_map<std::string, size_t> group_of;
  for (const std::string& message : messages) {
    const std::string text = without_name(message);
    const auto [entry, is_new] = group_of.emplace(WithoutNumbers(text), groups.size());
    if (is_new) groups.push_back({message, text, 0, true});
    Group& group = groups[entry->second];
    ++group.count;
    group.same_numbers = group.same_numbers && text == group.text;
  }
  std::vector<std::string> lines;
  for (const Group& group : groups) {
    lines.push_back(group.line);
    if (group.count == 1) continue;
    lines.back() += " (" + std::to_string(group.count) + " files alike" +
                    (group.same_numbers ? ")" : " but for the numbers)");
  }
  return lines;
}

}  // namespace rigel
