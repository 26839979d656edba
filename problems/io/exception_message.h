// What the system or an exception of a library says, in one line for people.
#ifndef RIGEL_PROBLEMS_IO_EXCEPTION_MESSAGE_H_
#define RIGEL_PROBLEMS_IO_EXCEPTION_MESSAGE_H_

#include <exception>
#include <string>

namespace rigel {

// What the system says of an error number (errno).
std::string SystemMessage(int error_number);

// "not enough memory" for std::bad_alloc and what else says so.
std::string ExceptionMessage(const std::exception& exception);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_EXCEPTION_MESSAGE_H_
