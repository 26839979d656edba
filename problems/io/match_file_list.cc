#include "rigel/problems/io/match_file_list.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/name_order.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

// The match files of some paths, as they are found out.
struct MatchFileList {
  std::vector<std::string> paths;
  std::vector<std::string> errors;
  std::vector<std::string> by_number;  // directories whose order is not byte order
  bool has_stdin = false;

  // Adds a file, "-" for stdin, or the match files of a directory.
  void Add(const std::string& path);
};

// Adds the match files of a directory.
void AddDirectory(const std::string& directory, MatchFileList* list) {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  std::string error;
  const auto add = [&](const std::string& name, bool is_directory) {
    if (IsMatchFileName(name) && !is_directory) names.push_back(name);
  };
  if (!ListDirectory(directory, add, &error)) {
    list->errors.push_back(error);
    return;
  }
  if (names.empty()) {
    list->errors.push_back(Printable(directory) + ": no .matches files in this directory");
    return;
  }
  if (SortByNumbers(&names)) list->by_number.push_back(directory);
  const std::set<std::string> there(names.begin(), names.end());
  for (const std::string& name : names) {
    const std::string path = (fs::path(directory) / name).string();
    // Of a compressed file its like; of another no name of a match file.
    const std::string plain = name.substr(0, name.size() - std::string_view(".gz").size());
    if (there.count(plain) > 0) {
      list->errors.push_back(Printable(path) + ": left out, " + Printable(plain) +
                             " is there too, expected one of them");
    } else {
      list->paths.push_back(path);
    }
  }
}

void MatchFileList::Add(const std::string& path) {
  namespace fs = std::filesystem;
  if (path == "-") {
    if (has_stdin) {
      errors.emplace_back("-: named twice, expected once: stdin can be read but once");
    } else {
      paths.push_back(path);
    }
    has_stdin = true;
    return;
  }
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (!fs::exists(status)) {
    errors.push_back(Printable(path) + ": cannot be opened: " + code.message());
  } else if (fs::is_directory(status)) {
    AddDirectory(path, this);
  } else {
    paths.push_back(path);
  }
}

}  // namespace

std::vector<std::string> ListMatchFiles(const std::string& comma_separated,
                                        std::vector<std::string>* errors,
                                        std::vector<std::string>* notes) {
  MatchFileList list;
  for (size_t begin = 0; begin <= comma_separated.size();) {
    const size_t comma = std::min(comma_separated.find(',', begin), comma_separated.size());
    const std::string item = comma_separated.substr(begin, comma - begin);
    begin = comma + 1;
    if (!item.empty()) list.Add(item);
  }
  errors->insert(errors->end(), list.errors.begin(), list.errors.end());
  if (notes != nullptr && !list.by_number.empty()) {
    const size_t more = list.by_number.size() - 1;
    notes->push_back(Printable(list.by_number.front()) +
                     (more > 0 ? " and " + std::to_string(more) + " more directories" : "") +
                     ": files are taken in the order of the numbers in their names, which is not "
                     "the byte order of the names");
  }
  return std::move(list.paths);
}

}  // namespace rigel
