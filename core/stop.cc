#include "rigel/core/stop.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "rigel/core/enum_names.h"

namespace rigel {
namespace {

constexpr EnumName<StopReason> kStopReasonNames[] = {{StopReason::kNone, "none"},
                                                     {StopReason::kTimeLimit, "time limit"},
                                                     {StopReason::kCancelled, "cancelled"}};

}  // namespace

const char* StopReasonName(StopReason reason) { return NameOf(kStopReasonNames, reason); }

bool IsValidTimeLimit(const std::optional<double>& time_limit, std::string* error) {
  if (!time_limit.has_value() || (*time_limit >= 0 && std::isfinite(*time_limit))) return true;
  *error = "time_limit must be finite and not negative";
  return false;
}

Stop::Stop(const std::optional<double>& time_limit, const std::atomic<bool>* cancel)
    : time_limit_(time_limit), start_(std::chrono::steady_clock::now()), cancel_(cancel) {}

bool Stop::Asked() {
  if (reason_ != StopReason::kNone) return true;
  if (cancel_ != nullptr && cancel_->load(std::memory_order_relaxed)) {
    reason_ = StopReason::kCancelled;
  } else if (time_limit_.has_value() && !(*SecondsLeft() > 0)) {
    reason_ = StopReason::kTimeLimit;
  }
  return reason_ != StopReason::kNone;
}

std::string Stop::Message() const {
  if (reason_ == StopReason::kNone) return "";
  if (reason_ == StopReason::kCancelled) return StopReasonName(reason_);
  std::ostringstream text;
  text << "stopped at the time limit of " << 1e3 * *time_limit_ << " ms";
  return text.str();
}

std::optional<double> Stop::SecondsLeft() const {
  if (!time_limit_.has_value()) return std::nullopt;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
  return std::max(0.0, *time_limit_ - passed.count());
}

}  // namespace rigel
