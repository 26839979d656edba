// Groups equal messages of many files into one line with a count.
#ifndef RIGEL_PROBLEMS_IO_MESSAGE_GROUPS_H_
#define RIGEL_PROBLEMS_IO_MESSAGE_GROUPS_H_

#include <string>
#include <vector>

namespace rigel {

// The messages in their order. Each begins with the printable name of one of `files` (Printable())
// and a colon. Of those that are equal but for the name only the first is there, with "(N files
// alike)" behind it. What begins with no such name, or names a line of the file, stands for itself.
std::vector<std::string> GroupMessages(const std::vector<std::string>& messages,
                                       const std::vector<std::string>& files);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MESSAGE_GROUPS_H_
