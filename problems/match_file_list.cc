// Which match files a list of paths means (match_file.h).
#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "rigel/problems/match_file.h"
#include "rigel/problems/match_file_words.h"

namespace rigel {
namespace {

constexpr std::string_view kSuffix = ".matches";

// Appends the match files of a directory.
void ListDirectory(const std::string& directory, std::vector<std::string>* paths,
                   std::vector<std::string>* errors) {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  std::error_code status;
  fs::directory_iterator entry(directory, status);
  for (; !status && entry != fs::directory_iterator(); entry.increment(status)) {
    std::string name = entry->path().filename().string();
    std::error_code ignored;
    if (name.size() > kSuffix.size() &&
        std::string_view(name).substr(name.size() - kSuffix.size()) == kSuffix &&
        !entry->is_directory(ignored)) {
      names.push_back(std::move(name));
    }
  }
  if (status) {
    errors->push_back(PrintablePath(directory) + ": cannot be listed: " + status.message());
    return;
  }
  if (names.empty()) {
    errors->push_back(PrintablePath(directory) + ": no " + std::string(kSuffix) +
                      " files in this directory");
    return;
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) paths->push_back((fs::path(directory) / name).string());
}

}  // namespace

std::string PrintablePath(const std::string& path) {
  std::string out;
  for (const char c : path) {
    if (match_file::IsControl(c)) {
      match_file::AppendHex(c, &out);
    } else {
      out += c;
    }
  }
  return out;
}

std::vector<std::string> ListMatchFiles(const std::string& comma_separated,
                                        std::vector<std::string>* errors) {
  namespace fs = std::filesystem;
  std::vector<std::string> paths;
  for (size_t begin = 0; begin <= comma_separated.size();) {
    const size_t comma = std::min(comma_separated.find(',', begin), comma_separated.size());
    const std::string item = comma_separated.substr(begin, comma - begin);
    begin = comma + 1;
    if (item.empty()) continue;
    std::error_code code;
    const fs::file_status status = fs::status(item, code);
    if (!fs::exists(status)) {
      errors->push_back(PrintablePath(item) + ": cannot be opened: " + code.message());
    } else if (fs::is_directory(status)) {
      ListDirectory(item, &paths, errors);
    } else {
      paths.push_back(item);
    }
  }
  return paths;
}

}  // namespace rigel
