// Which match files a list of paths means (match_file.h).
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/name_order.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

constexpr std::string_view kSuffix = ".matches";
constexpr std::string_view kCompressedSuffix = ".matches.gz";

bool EndsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

// What a list of paths means, as it is found out.
struct Listing {
  std::vector<std::string> paths;
  std::vector<std::string> errors;
  std::vector<std::string> by_number;  // directories whose order is not byte order
  bool has_stdin = false;
};

// Adds the match files of a directory.
void AddDirectory(const std::string& directory, Listing* listing) {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  std::string error;
  const auto add = [&](const std::string& name, bool is_directory) {
    if (IsMatchFileName(name) && !is_directory) names.push_back(name);
  };
  if (!ListDirectory(directory, add, &error)) {
    listing->errors.push_back(error);
    return;
  }
  if (names.empty()) {
    listing->errors.push_back(Printable(directory) + ": no " + std::string(kSuffix) +
                              " files in this directory");
    return;
  }
  if (SortByNumbers(&names)) listing->by_number.push_back(directory);
  const std::set<std::string> there(names.begin(), names.end());
  for (const std::string& name : names) {
    const std::string path = (fs::path(directory) / name).string();
    const std::string plain = name.substr(0, name.size() - 3);
    if (EndsWith(name, kCompressedSuffix) && there.count(plain) > 0) {
      listing->errors.push_back(Printable(path) + ": left out, " + Printable(plain) +
                                " is there too, expected one of them");
    } else {
      listing->paths.push_back(path);
    }
  }
}

void AddItem(const std::string& item, Listing* listing) {
  namespace fs = std::filesystem;
  if (item == "-") {
    if (listing->has_stdin) {
      listing->errors.push_back("-: named twice, expected once: stdin can be read but once");
    } else {
      listing->paths.push_back(item);
    }
    listing->has_stdin = true;
    return;
  }
  std::error_code code;
  const fs::file_status status = fs::status(item, code);
  if (!fs::exists(status)) {
    listing->errors.push_back(Printable(item) + ": cannot be opened: " + code.message());
  } else if (fs::is_directory(status)) {
    AddDirectory(item, listing);
  } else {
    listing->paths.push_back(item);
  }
}

}  // namespace

bool IsMatchFileName(const std::string& name) {
  return (EndsWith(name, kSuffix) && name.size() > kSuffix.size()) ||
         (EndsWith(name, kCompressedSuffix) && name.size() > kCompressedSuffix.size());
}

std::vector<std::string> ListMatchFiles(const std::string& comma_separated,
                                        std::vector<std::string>* errors,
                                        std::vector<std::string>* notes) {
  Listing listing;
  for (size_t begin = 0; begin <= comma_separated.size();) {
    const size_t comma = std::min(comma_separated.find(',', begin), comma_separated.size());
    const std::string item = comma_separated.substr(begin, comma - begin);
    begin = comma + 1;
    if (!item.empty()) AddItem(item, &listing);
  }
  errors->insert(errors->end(), listing.errors.begin(), listing.errors.end());
  if (notes != nullptr && !listing.by_number.empty()) {
    const size_t more = listing.by_number.size() - 1;
    notes->push_back(Printable(listing.by_number.front()) +
                     (more > 0 ? " and " + std::to_string(more) + " more directories" : "") +
                     ": files are taken in the order of the numbers in their names, which is not "
                     "the byte order of the names");
  }
  return std::move(listing.paths);
}

}  // namespace rigel
