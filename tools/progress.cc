#include "rigel/tools/progress.h"

#include <unistd.h>

#include <iostream>
#include <utility>

#include "rigel/problems/io/progress_text.h"

namespace rigel {

Progress::Progress(std::string what, int total)
    : what_(std::move(what)), total_(total), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (terminal_ && shown_) std::cerr << "\r\033[K" << std::flush;
}

void Progress::Step() {
  constexpr std::chrono::seconds kBetweenLines(30);  // of a file: a night has a thousand
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  if (terminal_) {
    Show("");
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - noted_ < kBetweenLines) return;
  noted_ = now;
  std::cerr << Text() + "\n" << std::flush;
}

void Progress::Note(const std::function<std::string()>& text) {
  if (!terminal_) return;
  // Milliseconds: often enough to see it move, and no work for the terminal.
  constexpr std::chrono::milliseconds kPause(300);
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - noted_ < kPause) return;
  noted_ = now;
  Show("; " + text());
}

std::string Progress::Text() const {
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
  return what_ + ": " + ProgressText(done_, total_, elapsed.count());
}

void Progress::Show(const std::string& note) {
  shown_ = true;
  std::cerr << "\r" << Text() << note << "\033[K" << std::flush;
}

}  // namespace rigel
