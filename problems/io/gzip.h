// Compression by gzip (RFC 1952), in memory.
#ifndef RIGEL_PROBLEMS_IO_GZIP_H_
#define RIGEL_PROBLEMS_IO_GZIP_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "rigel/problems/io/input_file.h"

namespace rigel {

// True if the bytes begin with the magic number of gzip. No text does.
bool IsGzip(std::string_view bytes);

// Decompresses one or several members into `bytes`, which is empty. Ends after a NUL byte, which no
// text has. False with what is wrong if the data is cut off or damaged, or holds more than
// max_bytes or more than the memory.
bool Gunzip(std::string_view compressed, size_t max_bytes, InputBytes* bytes, std::string* what);

// The same text gives the same bytes. Empty if there is no memory for it.
std::string Gzip(std::string_view text);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_GZIP_H_
