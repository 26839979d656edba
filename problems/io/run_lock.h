// A lock file: one run at a time works where it lies.
#ifndef RIGEL_PROBLEMS_IO_RUN_LOCK_H_
#define RIGEL_PROBLEMS_IO_RUN_LOCK_H_

#include <string>

namespace rigel {

// Held (flock) until the object or the process ends, however it ends: the file of a killed run
// locks nothing.
class RunLock {
 public:
  RunLock() = default;
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  // Removes the file.
  ~RunLock();

  // Makes the file if it is not there. False with a message, one line of printable text, if another
  // run has it or it cannot be made. A file system that knows no locks lets every run through.
  bool Take(const std::string& path, std::string* error);

 private:
  std::string path_;
  int descriptor_ = -1;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_RUN_LOCK_H_
