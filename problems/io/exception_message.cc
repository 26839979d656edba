#include "rigel/problems/io/exception_message.h"

#include <new>
#include <stdexcept>
#include <system_error>

#include "rigel/problems/io/printable.h"

namespace rigel {

std::string SystemMessage(int error_number) {
  return std::generic_category().message(error_number);
}

std::string ExceptionMessage(const std::exception& exception) {
  const std::string message = exception.what();
  // A container that would be larger than any memory throws length_error; OpenCV its own.
  if (dynamic_cast<const std::bad_alloc*>(&exception) != nullptr ||
      dynamic_cast<const std::length_error*>(&exception) != nullptr ||
      message.find("Insufficient memory") != std::string::npos) {
    return "not enough memory";
  }
  return Printable(message);
}

}  // namespace rigel
