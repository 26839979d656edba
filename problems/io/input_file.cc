#include "rigel/problems/io/input_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/gzip.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

// Bytes reserved first if the size is unknown, as of a pipe: a usual match file.
constexpr size_t kFirstRoom = size_t{1} << 16;
// Bytes read at a time. After each piece a NUL byte ends the reading.
constexpr size_t kPiece = size_t{1} << 20;

std::string BytesText(size_t bytes) {
  // Bytes: limits are told in GiB.
  constexpr size_t kGibi = size_t{1} << 30;
  return bytes % kGibi == 0 ? std::to_string(bytes / kGibi) + " GiB"
                            : std::to_string(bytes) + " bytes";
}

class OpenFile {
 public:
  explicit OpenFile(const std::string& path)
      : own_(path != "-"), file_(own_ ? std::fopen(path.c_str(), "rb") : stdin) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (own_ && file_ != nullptr) std::fclose(file_);
  }
  std::FILE* get() const { return file_; }

 private:
  bool own_;
  std::FILE* file_;
};

enum class Contents { kText, kAnything };

// Of text it stops behind a NUL byte, unless gzip made it. False with what is wrong. `size` is a
// hint that saves copies: pipes have none, and files may grow meanwhile.
bool ReadAll(std::FILE* file, Contents contents, size_t size, size_t max_bytes, InputBytes* bytes,
             std::string* what) {
  const std::string no_memory = "cannot be read: not enough memory for it";
  if (!bytes->Reserve(size + 1)) {
    *what = no_memory;
    return false;
  }
  bool may_have_nul = contents == Contents::kAnything;
  for (;;) {
    if (bytes->room() == 0 && !bytes->Grow(max_bytes + 1)) {
      *what = no_memory;
      return false;
    }
    const char* const begin = bytes->end();
    const size_t count = std::fread(bytes->end(), 1, std::min(bytes->room(), kPiece), file);
    if (count == 0) break;
    bytes->Added(count);
    if (bytes->size() > max_bytes) {
      *what = "more than " + BytesText(max_bytes) + ", expected no more";
      return false;
    }
    may_have_nul = may_have_nul || IsGzip(bytes->text());
    if (!may_have_nul && std::memchr(begin, 0, count) != nullptr) return true;
  }
  if (std::ferror(file) == 0) return true;
  *what = "cannot be read: " + SystemMessage(errno);
  return false;
}

bool Fail(const std::string& path, const std::string& what, std::string* error) {
  *error = Printable(InputName(path)) + ": " + what;
  return false;
}

bool ReadFile(const std::string& path, Contents contents, size_t max_bytes, InputBytes* bytes,
              std::string* error) {
  *bytes = InputBytes();
  const OpenFile file(path);
  if (file.get() == nullptr) {
    return Fail(path, "cannot be opened: " + SystemMessage(errno), error);
  }
  size_t size = kFirstRoom;
  if (path != "-") {
    std::error_code no_size;
    const uintmax_t stated = std::filesystem::file_size(path, no_size);
    if (!no_size && stated > max_bytes) {
      return Fail(path,
                  std::to_string(stated) + " bytes, expected no more than " + BytesText(max_bytes),
                  error);
    }
    if (!no_size) size = static_cast<size_t>(stated);
  }
  std::string what;
  return ReadAll(file.get(), contents, std::min(size, max_bytes), max_bytes, bytes, &what) ||
         Fail(path, what, error);
}

}  // namespace

bool InputBytes::Reserve(size_t capacity) {
  if (capacity <= capacity_) return true;
  auto* const larger = static_cast<char*>(std::realloc(data_.get(), capacity));
  if (larger == nullptr) return false;
  static_cast<void>(data_.release());
  data_.reset(larger);
  capacity_ = capacity;
  return true;
}

bool InputBytes::Grow(size_t max) {
  return Reserve(std::min(std::max(2 * capacity_, kFirstRoom), max));
}

std::string InputName(const std::string& path) { return path == "-" ? "stdin" : path; }

bool ReadInputFile(const std::string& path, InputBytes* bytes, std::string* error,
                   size_t max_bytes) {
  if (!ReadFile(path, Contents::kText, max_bytes, bytes, error)) return false;
  if (!IsGzip(bytes->text())) return true;
  InputBytes plain;
  std::string what;
  if (!Gunzip(bytes->text(), max_bytes, &plain, &what)) return Fail(path, what, error);
  *bytes = std::move(plain);
  return true;
}

bool ReadBytes(const std::string& path, InputBytes* bytes, std::string* error, size_t max_bytes) {
  return ReadFile(path, Contents::kAnything, max_bytes, bytes, error);
}

bool CheckText(std::string_view* text, int64_t* line, std::string* what) {
  *line = 0;
  const std::string_view begin = text->substr(0, 2);
  if (begin == "\xff\xfe" || begin == "\xfe\xff") {
    *what = "UTF-16, by its byte order mark";
    return false;
  }
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text->substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    text->remove_prefix(kByteOrderMark.size());
  }
  // Finds UTF-16 without a mark and most binary files, also where the NUL is in a comment.
  const size_t nul = text->find('\0');
  if (nul == std::string_view::npos) return true;
  *line = 1 + std::count(text->begin(), text->begin() + static_cast<ptrdiff_t>(nul), '\n');
  *what = "a NUL byte";
  return false;
}

}  // namespace rigel
