// When a long computation ends before it is done: a limit on its time, or a flag.
#ifndef RIGEL_CORE_STOP_H_
#define RIGEL_CORE_STOP_H_

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

namespace rigel {

enum class StopReason {
  kNone,       // nothing stopped it
  kTimeLimit,  // its time was over
  kCancelled,  // the caller's flag was set
};

const char* StopReasonName(StopReason reason);  // "none", "time limit", "cancelled"

// A limit that makes sense: none, or finite and not negative. False with a message if not.
bool IsValidTimeLimit(const std::optional<double>& time_limit, std::string* error);

// A loop calls Asked() again and again and ends once it is true. It stays true from then on.
// Without a limit and a flag a call costs nothing.
class Stop {
 public:
  Stop() = default;
  // `time_limit` is valid, in seconds from now. `cancel` may be null and must outlive this object;
  // any thread may set it.
  Stop(const std::optional<double>& time_limit, const std::atomic<bool>* cancel);

  bool Asked();

  StopReason reason() const { return reason_; }
  // "stopped at the time limit of 50 ms", "cancelled"; empty if nothing stopped it.
  std::string Message() const;

  // What is left of the limit, from 0; nothing without a limit.
  std::optional<double> SecondsLeft() const;

 private:
  std::optional<double> time_limit_;
  std::chrono::steady_clock::time_point start_;
  const std::atomic<bool>* cancel_ = nullptr;
  StopReason reason_ = StopReason::kNone;
};

}  // namespace rigel

#endif  // RIGEL_CORE_STOP_H_
