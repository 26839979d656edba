#include "rigel/tools/progress.h"

#include <unistd.h>

#include <iostream>
#include <utility>

namespace rigel {

Progress::Progress(std::string what, int total)
    : what_(std::move(what)), total_(total), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (terminal_ && shown_) std::cerr << "\r\033[K" << std::flush;
}

void Progress::Step() {
  if (!terminal_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  Show("");
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

void Progress::Show(const std::string& note) {
  shown_ = true;
  std::cerr << "\r" << what_ << ": " << done_ << " of " << total_ << note << "\033[K" << std::flush;
}

}  // namespace rigel
