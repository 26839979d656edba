// Where the path of an output leads: what is there, and whether two paths are one file.
#ifndef RIGEL_PROBLEMS_IO_OUTPUT_PLACE_H_
#define RIGEL_PROBLEMS_IO_OUTPUT_PLACE_H_

#include <sys/stat.h>
#include <sys/types.h>

#include <string>

namespace rigel {

struct OutputPlace {
  enum class Kind {
    kNone,        // nothing is there yet
    kRegular,     // a file that can be replaced
    kDirectory,   //
    kOther,       // a device, a FIFO, a socket, a loop of links: written to, never replaced
    kDescriptor,  // an open file of this process: /dev/stdout and its like
  };
  Kind kind = Kind::kNone;
  std::string path;       // behind all links
  int descriptor = -1;    // of kDescriptor
  struct stat status {};  // of what is there; not of kNone
};

// Follows the links of `path`, also those that lead to nothing yet.
OutputPlace FollowLinks(const std::string& path);

// Whether both are one regular file, by any spelling, link or hard link, or will be one when they
// are written, or are one open file of this process. Devices and FIFOs are never one.
bool SamePlace(const OutputPlace& a, const OutputPlace& b);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_OUTPUT_PLACE_H_
