// The directory of a program's results.
#ifndef RIGEL_TOOLS_OUTPUT_DIRECTORY_H_
#define RIGEL_TOOLS_OUTPUT_DIRECTORY_H_

#include <functional>
#include <string>
#include <vector>

namespace rigel {

// Makes the directory and those above it if they are missing. False with a message if it cannot be
// made.
bool MakeDirectory(const std::string& directory, std::string* error);

// Whether all match files of the directory are those that this run writes, by `is_own` of their
// names: others would later be read as if they were of this run. False with a message if there are
// others, or if the directory cannot be listed.
bool HoldsNoOtherMatchFiles(const std::string& directory,
                            const std::function<bool(const std::string& name)>& is_own,
                            std::string* error);

// Where changed copies of these match files go in `directory`. Empty with a message if two would be
// one file, one its own source, or the directory holds match files that are not of this run or have
// no comment line that begins with `mark`. `instead` ends the message of one that is its source.
std::vector<std::string> CopyTargets(const std::vector<std::string>& paths,
                                     const std::string& directory, const std::string& mark,
                                     const std::string& instead, std::string* error);

}  // namespace rigel

#endif  // RIGEL_TOOLS_OUTPUT_DIRECTORY_H_
