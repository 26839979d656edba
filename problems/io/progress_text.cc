#include "rigel/problems/io/progress_text.h"

#include <cmath>

#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

// 45 s, 12 min, 3 h 20 min.
std::string Duration(double seconds) {
  constexpr double kSecondsPerMinute = 60.0, kMinutesPerHour = 60.0;
  constexpr double kMostSeconds = 100.0;  // beyond, minutes are easier to read
  if (seconds < kMostSeconds) return FormatNumber(std::ceil(seconds), 0) + " s";
  const double minutes = std::ceil(seconds / kSecondsPerMinute);
  const double hours = std::floor(minutes / kMinutesPerHour);
  const std::string rest = FormatNumber(minutes - hours * kMinutesPerHour, 0) + " min";
  return hours > 0 ? FormatNumber(hours, 0) + " h " + rest : rest;
}

}  // namespace

std::string ProgressText(int done, int total, double seconds) {
  std::string text = std::to_string(done) + " of " + std::to_string(total);
  if (done < 1 || !(seconds > 0)) return text;
  const double each = seconds / done;
  constexpr double kSlow = 1.0;  // seconds each: rates below one a second are hard to read
  constexpr double kFast = 0.1;  // no decimals of a rate above ten a second
  text += each > kSlow ? ", " + FormatNumber(each, 1) + " s each"
                       : ", " + FormatNumber(1.0 / each, each < kFast ? 0 : 1) + " per second";
  return done < total ? text + ", " + Duration((total - done) * each) + " left" : text;
}

}  // namespace rigel
