#include "rigel/problems/io/run_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/printable.h"

namespace rigel {

RunLock::~RunLock() {
  if (descriptor_ < 0) return;
  unlink(path_.c_str());
  close(descriptor_);
}

bool RunLock::Take(const std::string& path, std::string* error) {
  // Each try that fails has met another run just as it removed the file. That is rare, and the loop
  // has to end.
  constexpr int kMaxTries = 100;
  for (int k = 0; k < kMaxTries; ++k) {
    const int descriptor =
        open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (descriptor < 0) {
      *error = Printable(path) + ": cannot be written: " + SystemMessage(errno);
      return false;
    }
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(descriptor);
      *error = Printable(path) + ": another run is at work in this directory";
      return false;
    }
    // The run that had it may have removed the file between the two calls.
    struct stat opened, there;
    if (fstat(descriptor, &opened) == 0 && stat(path.c_str(), &there) == 0 &&
        opened.st_ino == there.st_ino && opened.st_dev == there.st_dev) {
      path_ = path;
      descriptor_ = descriptor;
      return true;
    }
    close(descriptor);
  }
  *error = Printable(path) + ": other runs make and remove it";
  return false;
}

}  // namespace rigel
