// The bytes of files that a program is given: text, plain, compressed by gzip or from stdin, and
// other files as they are.
#ifndef RIGEL_PROBLEMS_IO_INPUT_FILE_H_
#define RIGEL_PROBLEMS_IO_INPUT_FILE_H_

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

namespace rigel {

// Bytes. A larger file, compressed or decompressed, is refused: it bounds the memory.
inline constexpr size_t kMaxInputBytes = size_t{2} << 30;

// Bytes that are not cleared before they are filled.
class InputBytes {
 public:
  std::string_view text() const { return {data_.get(), size_}; }
  char* end() { return data_.get() + size_; }
  size_t size() const { return size_; }
  size_t room() const { return capacity_ - size_; }

  // `count` more bytes were written at end().
  void Added(size_t count) { size_ += count; }

  // Room for `capacity` bytes in all. False if there is no memory for it.
  bool Reserve(size_t capacity);

  // Makes room for at least one more byte, and at most `max` in all; size() < max. False if there
  // is no memory for it.
  bool Grow(size_t max);

 private:
  struct Free {
    void operator()(char* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<char, Free> data_;
  size_t capacity_ = 0;
  size_t size_ = 0;
};

// The path as messages name it: "-" is stdin.
std::string InputName(const std::string& path);

// Reads a text file, or stdin if the path is "-", and decompresses gzip data. Reading ends after a
// NUL byte, which no text has: CheckText() then reports it. False with a message of one line if the
// file cannot be read, is damaged, or is larger than max_bytes or than the memory.
bool ReadInputFile(const std::string& path, InputBytes* bytes, std::string* error,
                   size_t max_bytes = kMaxInputBytes);

// Reads a file as it is: nothing is decompressed, a NUL byte is one of many. False with a message
// as above.
bool ReadBytes(const std::string& path, InputBytes* bytes, std::string* error, size_t max_bytes);

// Removes the byte order mark of UTF-8. False if the text has another encoding or is no text: *what
// says what was found, *line where (0: no line).
bool CheckText(std::string_view* text, int64_t* line, std::string* what);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_INPUT_FILE_H_
