#include "rigel/tools/output_directory.h"

#include <filesystem>
#include <set>
#include <system_error>

#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_header.h"
#include "rigel/tools/tool.h"

namespace rigel {

namespace fs = std::filesystem;

bool MakeDirectory(const std::string& directory, std::string* error) {
  std::error_code code;
  fs::create_directories(directory, code);
  if (!code) return true;
  return Refuse(PrintablePath(directory) + ": cannot be made: " + code.message(), error);
}

bool HoldsNoOtherMatchFiles(const std::string& directory,
                            const std::function<bool(const std::string& name)>& is_own,
                            std::string* error) {
  std::set<std::string> others;  // in byte order
  std::error_code code;
  fs::directory_iterator entry(directory, code);
  for (; !code && entry != fs::directory_iterator(); entry.increment(code)) {
    const std::string name = entry->path().filename().string();
    std::error_code ignored;
    if (IsMatchFileName(name) && !entry->is_directory(ignored) && !is_own(name)) {
      others.insert(name);
    }
  }
  if (code) {
    return Refuse(PrintablePath(directory) + ": cannot be listed: " + code.message(), error);
  }
  if (others.empty()) return true;
  return Refuse(
      PrintablePath(directory) + ": holds " + PrintablePath(*others.begin()) +
          (others.size() > 1 ? " and " + std::to_string(others.size() - 1) + " more" : "") +
          ", not written by this run, which would later be read with its files; "
          "empty the directory or name another",
      error);
}

std::vector<std::string> CopyTargets(const std::vector<std::string>& paths,
                                     const std::string& directory, const std::string& mark,
                                     const std::string& instead, std::string* error) {
  std::error_code code;
  std::vector<std::string> targets;
  std::set<std::string> seen;
  for (const std::string& path : paths) {
    targets.push_back((fs::path(directory) / fs::path(path).filename()).string());
    if (!seen.insert(targets.back()).second) {
      *error = PrintablePath(path) + ": another file has the same name; both would be written to " +
               PrintablePath(targets.back());
      return {};
    }
    if (fs::equivalent(path, targets.back(), code)) {
      *error = PrintablePath(path) + ": --output would overwrite it; " + instead;
      return {};
    }
  }
  if (!fs::is_directory(directory, code)) return targets;
  const auto is_own = [&](const std::string& name) {
    const std::string path = (fs::path(directory) / name).string();
    return seen.count(path) > 0 && !FindHeaderComment(path, mark).empty();
  };
  if (!HoldsNoOtherMatchFiles(directory, is_own, error)) return {};
  return targets;
}

}  // namespace rigel
