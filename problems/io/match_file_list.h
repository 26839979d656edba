// Which match files a list of paths stands for.
#ifndef RIGEL_PROBLEMS_IO_MATCH_FILE_LIST_H_
#define RIGEL_PROBLEMS_IO_MATCH_FILE_LIST_H_

#include <string>
#include <vector>

namespace rigel {

// Expands a comma-separated list of files and directories, in the order given.
// - A directory means the match files in it, not those in its subdirectories. If all names have
//   numbers, the files are in the order of these, else in byte order. If the two orders differ, a
//   line of *notes (may be null) says so.
// - A file may have any name. "-" is stdin, once.
// - Empty items are skipped. A file that is named twice is listed twice.
// One message is appended to *errors for each item that is not there, cannot be listed, or is a
// directory without match files. So it is for each compressed file whose plain copy is there too:
// the plain one is taken. The other items are still returned.
std::vector<std::string> ListMatchFiles(const std::string& comma_separated,
                                        std::vector<std::string>* errors,
                                        std::vector<std::string>* notes = nullptr);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MATCH_FILE_LIST_H_
