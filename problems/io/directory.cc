#include "rigel/problems/io/directory.h"

#include <system_error>

#include "rigel/problems/io/printable.h"

namespace rigel {

namespace fs = std::filesystem;

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool IsDirectory(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

bool ListDirectory(const fs::path& directory,
                   const std::function<void(const std::string& name, bool is_directory)>& entry,
                   std::string* error) {
  std::error_code code;
  fs::directory_iterator it(directory, code);
  for (; !code && it != fs::directory_iterator(); it.increment(code)) {
    std::error_code ignored;
    entry(it->path().filename().string(), it->is_directory(ignored));
  }
  if (!code) return true;
  *error = Printable(directory.string()) + ": cannot be listed: " + code.message();
  return false;
}

}  // namespace rigel
