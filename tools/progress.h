// How far a run is, on stderr.
#ifndef RIGEL_TOOLS_PROGRESS_H_
#define RIGEL_TOOLS_PROGRESS_H_

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

namespace rigel {

// "what: k of n", the rate and the time that is left (progress_text.h). On a terminal the line
// moves on; elsewhere a line appears every half minute, so that short runs have none. Thread-safe.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();
  void Step();
  // Adds what is going on, on a terminal and a few times a second at most: "what: k of n; text()".
  void Note(const std::function<std::string()>& text);

 private:
  std::string Text() const;
  void Show(const std::string& note);

  std::string what_;
  int total_;
  int done_ = 0;
  bool terminal_;
  bool shown_ = false;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point noted_ = begin_;  // the last note or line
  std::mutex mutex_;
};

}  // namespace rigel

#endif  // RIGEL_TOOLS_PROGRESS_H_
