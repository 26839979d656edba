#include "rigel/problems/whole_file.h"

#include <cerrno>
#include <cstdio>
#include <filesystem>
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

std::string CannotBeWritten(const std::string& path, const std::string& why) {
  return PrintablePath(path) + ": cannot be written: " + why;
}

std::string NoTemporary(const std::string& path, int error_number) {
  const std::filesystem::path directory = std::filesystem::path(path).parent_path();
  std::error_code ignored;
  if (error_number == ENOENT && !directory.empty() &&
      !std::filesystem::exists(directory, ignored)) {
    return CannotBeWritten(
        path, "the directory " + PrintablePath(directory.string()) + " does not exist");
  }
  return CannotBeWritten(
      path, "no temporary file beside it: " + std::generic_category().message(error_number));
}

}  // namespace

bool WriteWholeFile(const std::string& path, const std::string& text, std::string* error) {
  StagedFiles file;
  return file.Add(path, text, error) && file.Commit(error);
}

StagedFiles::~StagedFiles() {
  for (size_t k = committed_; k < files_.size(); ++k) std::remove(files_[k].first.c_str());
}

bool StagedFiles::Add(const std::string& path, const std::string& text, std::string* error) {
  std::string temporary;
  std::FILE* const file = CreateTemporary(path, &temporary);
  if (file == nullptr) {
    *error = NoTemporary(path, errno);
    return false;
  }
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  int error_number = errno;
  // A full disk may show only now, when the buffer is flushed.
  const bool closed = std::fclose(file) == 0;
  if (written && !closed) error_number = errno;
  if (!written || !closed) {
    std::remove(temporary.c_str());
    *error = CannotBeWritten(path, "the disk or the device refused it: " +
                                       std::generic_category().message(error_number));
    return false;
  }
  files_.emplace_back(temporary, path);
  return true;
}

bool StagedFiles::Commit(std::string* error) {
  while (committed_ < static_cast<int>(files_.size())) {
    const auto& [temporary, path] = files_[committed_];
    if (std::rename(temporary.c_str(), path.c_str()) != 0) {
      *error = CannotBeWritten(path, "the temporary file cannot take its place: " +
                                         std::generic_category().message(errno));
      return false;
    }
    ++committed_;
  }
  return true;
}

}  // namespace rigel
