#include "rigel/problems/io/gzip.h"

#include <algorithm>
#include <cstring>

#include <zlib.h>

namespace rigel {
namespace {

constexpr int kGzipWindow = MAX_WBITS + 16;  // with gzip's header and check sum

// zlib takes pointers to what it only reads as well.
Bytef* Mutable(const char* bytes) { return reinterpret_cast<Bytef*>(const_cast<char*>(bytes)); }

bool OnlyZeros(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](char c) { return c == 0; });
}

class Inflater {
 public:
  explicit Inflater(std::string_view compressed) {
    stream_.next_in = Mutable(compressed.data());
    stream_.avail_in = static_cast<uInt>(compressed.size());
    ready_ = inflateInit2(&stream_, kGzipWindow) == Z_OK;
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() {
    if (ready_) inflateEnd(&stream_);
  }

  bool ready() const { return ready_; }

  // What is left of the compressed bytes.
  std::string_view rest() const {
    return {reinterpret_cast<const char*>(stream_.next_in), stream_.avail_in};
  }

  // Fills the room of `bytes` as far as there is something; a status of zlib.
  int Step(InputBytes* bytes) {
    stream_.next_out = Mutable(bytes->end());
    stream_.avail_out = static_cast<uInt>(bytes->room());
    const uInt room = stream_.avail_out;
    const int status = inflate(&stream_, Z_NO_FLUSH);
    bytes->Added(room - stream_.avail_out);
    return status;
  }

  bool NextMember() { return inflateReset(&stream_) == Z_OK; }

 private:
  z_stream stream_{};
  bool ready_ = false;
};

}  // namespace

bool IsGzip(std::string_view bytes) { return bytes.substr(0, 2) == "\x1f\x8b"; }

bool Gunzip(std::string_view compressed, size_t max_bytes, InputBytes* bytes, std::string* what) {
  Inflater inflater(compressed);
  bool memory = inflater.ready();
  while (memory) {
    memory = bytes->room() > 0 || bytes->Grow(max_bytes + 1);
    if (!memory) break;
    const char* const begin = bytes->end();
    const int status = inflater.Step(bytes);
    if (bytes->size() > max_bytes) {
      *what = "gzip data of more than " + std::to_string(max_bytes) + " bytes, expected no more";
      return false;
    }
    if (std::memchr(begin, 0, static_cast<size_t>(bytes->end() - begin)) != nullptr) return true;
    if (status == Z_STREAM_END) {
      // Padding of zeros is usual; what else follows is another member.
      if (OnlyZeros(inflater.rest())) return true;
      if (!IsGzip(inflater.rest()) || !inflater.NextMember()) {
        *what = "damaged: " + std::to_string(inflater.rest().size()) +
                " bytes after the end of its gzip data";
        return false;
      }
    } else if (status == Z_MEM_ERROR) {
      memory = false;
    } else if (status == Z_BUF_ERROR && inflater.rest().empty()) {
      *what = "cut off: its gzip data ends before its end";
      return false;
    } else if (status != Z_OK && status != Z_BUF_ERROR) {
      *what = "damaged: its gzip data cannot be decompressed";
      return false;
    }
  }
  *what = "cannot be read: not enough memory for it";
  return false;
}

std::string Gzip(std::string_view text) {
  z_stream stream{};
  constexpr int kMemoryLevel = 8;  // memory against speed: zlib's own default
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    return "";
  }
  std::string compressed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = Mutable(text.data());
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = Mutable(compressed.data());
  stream.avail_out = static_cast<uInt>(compressed.size());
  const bool done = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  compressed.resize(done ? stream.total_out : 0);
  deflateEnd(&stream);
  return compressed;
}

}  // namespace rigel
