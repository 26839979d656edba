// What the fuzz targets share. Each target is a file with LLVMFuzzerTestOneInput(): any bytes go
// into one entry of the library, and what must hold of the outcome is required. test/fuzz.sh runs
// them; an ordinary build links replay_main.cc instead of libFuzzer and runs the seeds as a test.
#ifndef RIGEL_TEST_FUZZ_FUZZ_H_
#define RIGEL_TEST_FUZZ_FUZZ_H_

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rigel::fuzz {

// Ends the process, which libFuzzer takes for a crash and keeps the input of.
inline void Require(bool condition, const std::string& what) {
  if (condition) return;
  std::fprintf(stderr, "fuzz: required: %s\n", what.c_str());
  std::abort();
}

// A message for a person: there, one line, and nothing in it that moves a terminal.
inline void RequireMessage(const std::string& message) {
  Require(!message.empty(), "a message");
  for (const char c : message) {
    Require(static_cast<unsigned char>(c) >= ' ' && c != '\x7f',
            "a message of printable characters: " + message);
  }
}

// The parts of an input that stands for several files, between lines "=====".
inline std::vector<std::string> Parts(const uint8_t* data, size_t size) {
  constexpr std::string_view kBetween = "=====\n";
  std::string_view text(reinterpret_cast<const char*>(data), size);
  std::vector<std::string> parts;
  for (size_t end; (end = text.find(kBetween)) != std::string_view::npos;) {
    parts.emplace_back(text.substr(0, end));
    text.remove_prefix(end + kBetween.size());
  }
  parts.emplace_back(text);
  return parts;
}

// Files for readers that want paths; gone when the process ends as it should.
class Folder {
 public:
  Folder() {
    path_ = (std::filesystem::temp_directory_path() / "rigel_fuzz_XXXXXX").string();
    Require(mkdtemp(path_.data()) != nullptr, "a temporary folder");
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string Path(const std::string& name) const { return path_ + "/" + name; }

  void Write(const std::string& name, std::string_view text) const {
    const std::filesystem::path path = Path(name);
    std::filesystem::create_directories(path.parent_path());
    std::FILE* file = std::fopen(path.c_str(), "wb");
    Require(file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size() &&
                std::fclose(file) == 0,
            "a file can be written");
  }

 private:
  std::string path_;
};

// Values from the input's bytes; zeros once they are used up.
class Bytes {
 public:
  Bytes(const uint8_t* data, size_t size) : data_(data), size_(size) {}

  bool Empty() const { return size_ == 0; }

  uint8_t Byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }

  // From 0 to `count` - 1, which is at most 256.
  int Choice(int count) { return Byte() % count; }

  bool Chance(int of_256) { return Byte() < of_256; }

  int Int() {
    uint32_t bits = 0;
    for (int k = 0; k < 4; ++k) bits = bits << 8 | Byte();
    int value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  // Any double at all: NaN, infinities, denormals.
  double AnyDouble() {
    uint64_t bits = 0;
    for (int k = 0; k < 8; ++k) bits = bits << 8 | Byte();
    double value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  double Uniform(double low, double high) {
    const int bits = Byte() << 8 | Byte();
    return low + (high - low) * bits / 65535.0;
  }

  // Mostly a sensible number, now and then any: of an input all of whose numbers are wild nothing
  // but the first check is tried.
  double Double(double low, double high) {
    const uint8_t kind = Byte();
    if (kind < 240) return Uniform(low, high);
    if (kind < 248) return AnyDouble();
    constexpr double kSpecial[] = {0.0,    -0.0,   1e-300, 5e-324, 1e300, 1.7976931348623157e308,
                                   -1e300, 1e-160, 1e160,  -1.0,   1e9,   1e-9};
    return kSpecial[Byte() % std::size(kSpecial)];
  }

 private:
  const uint8_t* data_;
  size_t size_;
};

}  // namespace rigel::fuzz

#endif  // RIGEL_TEST_FUZZ_FUZZ_H_
