// The version of the library.
#ifndef RIGEL_PROBLEMS_IO_VERSION_H_
#define RIGEL_PROBLEMS_IO_VERSION_H_

namespace rigel {

// "0.2.0", as in CMake's project().
const char* RigelVersion();

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_VERSION_H_
