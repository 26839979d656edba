// The target of an output path: what kind of file it is, and whether two paths are the same file.
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

// Follows the links of `path`, also links to files that do not exist yet.
OutputPlace FollowLinks(const std::string& path);

// True if both are the same regular file, by any spelling, link or hard link, or will be when they
// are written, or are the same open file of this process. False for devices and FIFOs.
bool SamePlace(const OutputPlace& a, const OutputPlace& b);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_OUTPUT_PLACE_H_
