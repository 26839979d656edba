// How far a run is, on stderr where that is a terminal.
#ifndef RIGEL_TOOLS_PROGRESS_H_
#define RIGEL_TOOLS_PROGRESS_H_

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

namespace rigel {

// "what: k of n" on stderr, on a terminal only. Thread-safe.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();
  void Step();
  // Adds what is going on, a few times a second at most: "what: k of n; text()".
  void Note(const std::function<std::string()>& text);

 private:
  void Show(const std::string& note);

  std::string what_;
  int total_;
  int done_ = 0;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point noted_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
};

}  // namespace rigel

#endif  // RIGEL_TOOLS_PROGRESS_H_
