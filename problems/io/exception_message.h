// Error messages of the system and of libraries, in one line for users.
#ifndef RIGEL_PROBLEMS_IO_EXCEPTION_MESSAGE_H_
#define RIGEL_PROBLEMS_IO_EXCEPTION_MESSAGE_H_

#include <exception>
#include <string>

namespace rigel {

// The system's message for an error number (errno).
std::string SystemMessage(int error_number);

// The message of the exception; "not enough memory" for std::bad_alloc and its like.
std::string ExceptionMessage(const std::exception& exception);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_EXCEPTION_MESSAGE_H_
