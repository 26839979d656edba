#include "rigel/problems/io/whole_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string_view>
#include <utility>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using Kind = OutputPlace::Kind;

// The names do not end in ".matches", so that a left-over is never read as a match file.
constexpr std::string_view kMark = ".rigel-tmp";
constexpr int kNumTemporaries = 10;  // as many runs can write one file at a time

// Files of one StagedFiles that stay open to hold their locks: a process may have about 1000 open
// files. Further files have no lock. A second run that writes them at the same moment would remove
// them as left-overs, and the first run fails with a message.
constexpr size_t kMaxLocks = 200;

bool CannotBeWritten(const std::string& name, const std::string& why, std::string* error) {
  *error = Printable(name) + ": cannot be written: " + why;
  return false;
}

std::string TemporaryPath(const std::string& path, int k) {
  // Bytes: 255 are the longest name of a file; the mark and a digit follow.
  constexpr size_t kMaxName = 255 - kMark.size() - 1;
  const fs::path file(path);
  std::string name = file.filename().string();
  if (name.size() > kMaxName) {
    const std::string rest = std::to_string(std::hash<std::string>()(name));
    name = name.substr(0, kMaxName - rest.size()) + rest;
  }
  return (file.parent_path() / (name + std::string(kMark) + std::to_string(k))).string();
}

bool WriteAll(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = write(descriptor, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    text.remove_prefix(static_cast<size_t>(count));
  }
  return true;
}

// The temporary, open and locked, if it is there and no living run has it; else -1.
int LockLeftOver(const std::string& temporary) {
  const int flags = O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK;
  int descriptor = open(temporary.c_str(), O_RDWR | flags);
  if (descriptor < 0 && errno == EACCES) descriptor = open(temporary.c_str(), O_RDONLY | flags);
  if (descriptor < 0) return -1;
  struct stat opened, there;
  // The other run may have renamed it in the meantime.
  if (fstat(descriptor, &opened) == 0 && S_ISREG(opened.st_mode) &&
      flock(descriptor, LOCK_EX | LOCK_NB) == 0 && stat(temporary.c_str(), &there) == 0 &&
      there.st_ino == opened.st_ino && there.st_dev == opened.st_dev) {
    return descriptor;
  }
  close(descriptor);
  return -1;
}

void RemoveLeftOver(const std::string& temporary) {
  const int lock = LockLeftOver(temporary);
  if (lock < 0) return;
  unlink(temporary.c_str());
  close(lock);
}

// Creates and locks a file that did not exist. -1 with errno set if that fails.
int CreateTemporary(const std::string& path, mode_t mode, std::string* temporary) {
  for (int k = 0; k < kNumTemporaries; ++k) RemoveLeftOver(TemporaryPath(path, k));
  for (int k = 0; k < kNumTemporaries; ++k) {
    *temporary = TemporaryPath(path, k);
    const int descriptor = open(temporary->c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor < 0) {
      if (errno == EEXIST) continue;
      return -1;
    }
    // Another run may have removed it as a left-over before it was locked. On a file system without
    // locks no run removes any.
    struct stat status;
    const bool lost = flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!lost && fstat(descriptor, &status) == 0 && status.st_nlink > 0) return descriptor;
    close(descriptor);
  }
  errno = EEXIST;
  return -1;
}

std::string NoTemporary(const std::string& path, int error_number) {
  const fs::path directory = fs::path(path).parent_path();
  if (error_number == ENOENT && !directory.empty() && !Exists(directory)) {
    return "the directory " + Printable(directory.string()) + " does not exist";
  }
  if (error_number == EEXIST) return "other runs are writing it";
  return "no temporary file beside it: " + SystemMessage(error_number);
}

// The open temporary gets the mode and the owner of the file that it replaces.
bool TakeModeAndOwner(const struct stat& status, int descriptor, const std::string& name,
                      std::string* error) {
  struct stat own;
  if (fstat(descriptor, &own) != 0) return CannotBeWritten(name, SystemMessage(errno), error);
  if ((own.st_uid != status.st_uid || own.st_gid != status.st_gid) &&
      fchown(descriptor, status.st_uid, status.st_gid) != 0) {
    return CannotBeWritten(
        name, "a new file would no longer have its owner and group; remove it first", error);
  }
  if (fchmod(descriptor, status.st_mode & 07777) != 0) {
    return CannotBeWritten(name, "its mode cannot be kept: " + SystemMessage(errno), error);
  }
  return true;
}

// Opens the temporary of a file; -1 with a message if that fails.
int OpenTemporary(const OutputPlace& place, const std::string& name, std::string* temporary,
                  std::string* error) {
  const bool replaces = place.kind == Kind::kRegular;
  // A file without write permission is not replaced.
  if (replaces && faccessat(AT_FDCWD, place.path.c_str(), W_OK, AT_EACCESS) != 0) {
    CannotBeWritten(name, SystemMessage(errno), error);
    return -1;
  }
  const mode_t mode = replaces ? 0600 : 0666;
  const int descriptor = CreateTemporary(place.path, mode, temporary);
  if (descriptor < 0) {
    CannotBeWritten(name, NoTemporary(place.path, errno), error);
    return -1;
  }
  if (!replaces || TakeModeAndOwner(place.status, descriptor, name, error)) return descriptor;
  unlink(temporary->c_str());
  close(descriptor);
  return -1;
}

bool Refused(const std::string& name, int error_number, std::string* error) {
  return CannotBeWritten(name, "the disk or the device refused it: " + SystemMessage(error_number),
                         error);
}

// Writes to a device, a FIFO or an open file.
bool WriteTo(const OutputPlace& place, const std::string& name, const std::string& text,
             std::string* error) {
  if (place.kind == Kind::kDescriptor) {
    return WriteAll(place.descriptor, text) || Refused(name, errno, error);
  }
  const int descriptor = open(place.path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
  if (descriptor < 0) return CannotBeWritten(name, SystemMessage(errno), error);
  const bool written = WriteAll(descriptor, text);
  const int error_number = errno;
  const bool closed = close(descriptor) == 0;
  if (written && closed) return true;
  return Refused(name, written ? errno : error_number, error);
}

}  // namespace

bool WriteWholeFile(const std::string& path, const std::string& text, std::string* error) {
  StagedFiles file;
  return file.Add(path, text, error) && file.Commit(error);
}

bool CanWriteWholeFile(const std::string& path, std::string* error) {
  const OutputPlace place = FollowLinks(path);
  switch (place.kind) {
    case Kind::kDirectory:
      return CannotBeWritten(path, "it is a directory", error);
    case Kind::kDescriptor:
      return true;
    case Kind::kOther:
      return faccessat(AT_FDCWD, place.path.c_str(), W_OK, AT_EACCESS) == 0 ||
             CannotBeWritten(path, SystemMessage(errno), error);
    case Kind::kNone:
    case Kind::kRegular:
      break;
  }
  StagedFiles nothing;
  return nothing.Add(path, "", error);
}

StagedFiles::~StagedFiles() {
  for (size_t k = committed_; k < files_.size(); ++k) {
    if (!files_[k].temporary.empty()) unlink(files_[k].temporary.c_str());
    if (files_[k].lock >= 0) close(files_[k].lock);
  }
}

bool StagedFiles::Add(const std::string& path, const std::string& text, std::string* error) {
  File file;
  file.place = FollowLinks(path);
  file.name = path;
  if (file.place.kind == Kind::kDirectory) {
    return CannotBeWritten(path, "it is a directory", error);
  }
  if (file.place.kind == Kind::kOther || file.place.kind == Kind::kDescriptor) {
    file.text = text;
    files_.push_back(std::move(file));
    return true;
  }
  const int descriptor = OpenTemporary(file.place, path, &file.temporary, error);
  if (descriptor < 0) return false;
  files_.push_back(file);  // from here on it is removed if it comes to nothing
  files_.back().lock = descriptor;
  if (!WriteAll(descriptor, text)) return Refused(path, errno, error);
  // Some file systems report a full disk only at close(). A copy is closed, as the lock has to
  // stay.
  const int copy = fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  if (copy >= 0 && close(copy) != 0) return Refused(path, errno, error);
  if (files_.size() > kMaxLocks) {
    close(descriptor);
    files_.back().lock = -1;
  }
  return true;
}

bool StagedFiles::Commit(std::string* error) {
  while (committed_ < static_cast<int>(files_.size())) {
    File& file = files_[committed_];
    if (file.temporary.empty()) {
      if (!WriteTo(file.place, file.name, file.text, error)) return false;
    } else if (std::rename(file.temporary.c_str(), file.place.path.c_str()) != 0) {
      return CannotBeWritten(
          file.name, "the temporary file cannot take its place: " + SystemMessage(errno), error);
    }
    if (file.lock >= 0) close(file.lock);
    ++committed_;
  }
  return true;
}

void RemoveLeftOvers(const std::string& directory,
                     const std::function<bool(const std::string& name)>& is_ours) {
  std::vector<std::string> temporaries;
  std::string ignored;
  const auto add = [&](const std::string& name, bool /*is_directory*/) {
    const size_t mark = name.rfind(kMark);
    if (mark != std::string::npos && mark + kMark.size() + 1 == name.size() &&
        is_ours(name.substr(0, mark))) {
      temporaries.push_back((fs::path(directory) / name).string());
    }
  };
  ListDirectory(directory, add, &ignored);
  for (const std::string& temporary : temporaries) RemoveLeftOver(temporary);
}

bool FinishLeftOver(const std::string& path,
                    const std::function<bool(const std::string& temporary)>& accept) {
  const std::string place = FollowLinks(path).path;
  for (int k = 0; k < kNumTemporaries; ++k) {
    const std::string temporary = TemporaryPath(place, k);
    const int lock = LockLeftOver(temporary);
    if (lock < 0) continue;
    const bool done = accept(temporary) && std::rename(temporary.c_str(), place.c_str()) == 0;
    close(lock);
    if (done) return true;
  }
  return false;
}

}  // namespace rigel
