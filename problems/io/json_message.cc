#include "rigel/problems/io/json_message.h"

#include "rigel/problems/io/printable.h"

namespace rigel {

std::string JsonMessage(const std::exception& exception) {
  std::string message = exception.what();
  // It quotes what it last read, be it a string of megabytes.
  constexpr size_t kMaxHalf = 150;
  if (message.size() > 2 * kMaxHalf) {
    message.replace(kMaxHalf, message.size() - 2 * kMaxHalf, "...");
  }
  const std::string prefix = "[json.exception.";
  const size_t end = message.find("] ");
  if (message.compare(0, prefix.size(), prefix) == 0 && end != std::string::npos) {
    message = message.substr(end + 2);
  }
  return Printable(message);
}

}  // namespace rigel
