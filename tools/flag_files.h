// The flag files that the command line names: --flagfile=FILE, with one flag a line.
//
// gflags itself follows the flag files that a flag file or an environment variable names, without
// an end where they name each other. Here a flag file is one level deep and of limited size.
#ifndef RIGEL_TOOLS_FLAG_FILES_H_
#define RIGEL_TOOLS_FLAG_FILES_H_

#include <string>
#include <vector>

namespace rigel {

// Reads the flag files of the command line. A message if one cannot be read or names another flag
// file; empty if all is well.
std::string FlagFilesError(int argc, char** argv);

// Those that FlagFilesError() read: inputs of the program, too.
const std::vector<std::string>& FlagFiles();

}  // namespace rigel

#endif  // RIGEL_TOOLS_FLAG_FILES_H_
