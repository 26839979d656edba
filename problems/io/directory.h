// What is there in the file system, without exceptions.
#ifndef RIGEL_PROBLEMS_IO_DIRECTORY_H_
#define RIGEL_PROBLEMS_IO_DIRECTORY_H_

#include <filesystem>
#include <functional>
#include <string>

namespace rigel {

// False also where the path cannot be looked at.
bool Exists(const std::filesystem::path& path);
bool IsDirectory(const std::filesystem::path& path);

// Calls entry(name, is_directory) for each entry of a directory, in no order. False with a message,
// one line that names the directory, if it cannot be listed.
bool ListDirectory(const std::filesystem::path& directory,
                   const std::function<void(const std::string& name, bool is_directory)>& entry,
                   std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_DIRECTORY_H_
