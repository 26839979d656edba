#include "rigel/problems/message_groups.h"

#include <cctype>
#include <unordered_map>
#include <unordered_set>

#include "rigel/problems/match_file.h"

namespace rigel {

std::vector<std::string> GroupMessages(const std::vector<std::string>& messages,
                                       const std::vector<std::string>& files) {
  std::unordered_set<std::string> names;
  for (const std::string& file : files) names.insert(PrintablePath(file));
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
  std::vector<std::string> lines;
  std::vector<int> counts;
  std::unordered_map<std::string, size_t> line_of;
  for (const std::string& message : messages) {
    const auto [entry, is_new] = line_of.emplace(without_name(message), lines.size());
    if (is_new) {
      lines.push_back(message);
      counts.push_back(0);
    }
    ++counts[entry->second];
  }
  for (size_t k = 0; k < lines.size(); ++k) {
    if (counts[k] > 1) lines[k] += " (" + std::to_string(counts[k]) + " files alike)";
  }
  return lines;
}

}  // namespace rigel
