#include "rigel/problems/json_message.h"

namespace rigel {

std::string JsonMessage(const std::exception& exception) {
  const std::string message = exception.what();
  const std::string prefix = "[json.exception.";
  const size_t end = message.find("] ");
  if (message.compare(0, prefix.size(), prefix) != 0 || end == std::string::npos) return message;
  return message.substr(end + 2);
}

}  // namespace rigel
