// Error messages of the JSON library, for users.
#ifndef RIGEL_PROBLEMS_IO_JSON_MESSAGE_H_
#define RIGEL_PROBLEMS_IO_JSON_MESSAGE_H_

#include <exception>
#include <string>

namespace rigel {

// The message without "[json.exception.NAME.NUMBER] ", shortened in the middle if it is long, and
// printable, as it quotes the file.
std::string JsonMessage(const std::exception& exception);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_JSON_MESSAGE_H_
