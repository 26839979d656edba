#include "rigel/problems/whole_file.h"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "rigel/problems/match_file.h"

namespace rigel {
namespace {

// Creates a file that did not exist, named after `path`. Its name does not end in ".matches", so
// that a left-over is never read. Null with errno set if that fails.
std::FILE* CreateTemporary(const std::string& path, std::string* temporary) {
  constexpr int kMaxTries = 100;
  for (int k = 0; k < kMaxTries; ++k) {
    *temporary = path + ".tmp" + std::to_string(k);
    std::FILE* const file = std::fopen(temporary->c_str(), "wbx");
    if (file != nullptr || errno != EEXIST) return file;
  }
  return nullptr;
}

}  // namespace

bool WriteWholeFile(const std::string& path, const std::string& text, std::string* error) {
  const auto fail = [&](const char* what, int error_number) {
    *error = PrintablePath(path) + ": cannot be written: " + what + ": " +
             std::generic_category().message(error_number);
    return false;
  };
  std::string temporary;
  std::FILE* const file = CreateTemporary(path, &temporary);
  if (file == nullptr) return fail("no temporary file beside it", errno);
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  int error_number = errno;
  // A full disk may show only now, when the buffer is flushed.
  const bool closed = std::fclose(file) == 0;
  if (written && !closed) error_number = errno;
  if (!written || !closed) {
    std::remove(temporary.c_str());
    return fail("the disk or the device refused it", error_number);
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    error_number = errno;
    std::remove(temporary.c_str());
    return fail("the temporary file cannot take its place", error_number);
  }
  return true;
}

}  // namespace rigel
