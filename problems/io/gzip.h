// Compression by gzip (RFC 1952), in memory.
#ifndef RIGEL_PROBLEMS_IO_GZIP_H_
#define RIGEL_PROBLEMS_IO_GZIP_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "rigel/problems/io/input_file.h"

namespace rigel {

// Whether the bytes begin as those that gzip writes; no text does.
bool IsGzip(std::string_view bytes);

// Appends what `compressed` holds, one member or several, to `bytes`, which is empty; stops behind
// a NUL, which no text has. False with what is wrong if it is cut off or damaged, holds more than
// max_bytes or more than there is memory for.
bool Gunzip(std::string_view compressed, size_t max_bytes, InputBytes* bytes, std::string* what);

// The same text gives the same bytes. Empty if there is no memory for it.
std::string Gzip(std::string_view text);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_GZIP_H_
