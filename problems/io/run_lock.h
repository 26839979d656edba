// A lock file: only one run at a time works in its directory.
#ifndef RIGEL_PROBLEMS_IO_RUN_LOCK_H_
#define RIGEL_PROBLEMS_IO_RUN_LOCK_H_

#include <string>

namespace rigel {

// The lock (flock) is held until the object or the process ends. The lock file of a killed run does
// not lock.
class RunLock {
 public:
  RunLock() = default;
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  // Removes the file.
  ~RunLock();

  // Creates the file if it does not exist. False with a message, one line of printable text, if
  // another run holds the lock or the file cannot be created. Always succeeds on a file system
  // without locks.
  bool Take(const std::string& path, std::string* error);

 private:
  std::string path_;
  int descriptor_ = -1;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_RUN_LOCK_H_
