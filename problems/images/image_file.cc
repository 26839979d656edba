#include "rigel/problems/images/image_file.h"

#include <cstdint>
#include <string_view>

#include <opencv2/imgcodecs.hpp>

#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

// Checked here, as libpng would write a message to stderr.
bool IsCutOffPng(std::string_view bytes) {
  constexpr std::string_view kBegin = "\x89PNG";
  constexpr std::string_view kEnd = "IEND\xae\x42\x60\x82";
  return bytes.substr(0, kBegin.size()) == kBegin && bytes.rfind(kEnd) == std::string_view::npos;
}

// Pixels of an image and bytes of a file. Both are far above those of any camera. They bound the
// memory: a small file can announce a large image, so that both are checked before anything is
// decoded.
constexpr int64_t kMaxPixels = 200000000;
constexpr size_t kMaxImageBytes = size_t{1} << 30;

// Width times height by the head of a PNG or a JPEG; 0 if there is none. Of other kinds OpenCV
// decodes at most 2^30 pixels.
int64_t AnnouncedPixels(std::string_view bytes) {
  const auto number = [&](size_t begin, size_t count) {
    int64_t value = 0;
    for (size_t k = begin; k < begin + count; ++k) {
      value = 256 * value + static_cast<unsigned char>(bytes[k]);
    }
    return value;
  };
  if (bytes.substr(0, 4) == "\x89PNG") {
    return bytes.size() < 24 ? 0 : number(16, 4) * number(20, 4);
  }
  if (bytes.substr(0, 2) != "\xff\xd8") return 0;
  // Segments: ff, kind, length with these two bytes; the frame's are c0 to cf but for three.
  for (size_t k = 2; k + 9 < bytes.size() && bytes[k] == '\xff';) {
    const auto kind = static_cast<int>(number(k + 1, 1));
    if (kind >= 0xc0 && kind <= 0xcf && kind != 0xc4 && kind != 0xc8 && kind != 0xcc) {
      return number(k + 5, 2) * number(k + 7, 2);
    }
    k += kind == 0xff ? 1 : 2 + static_cast<size_t>(number(k + 2, 2));
  }
  return 0;
}

}  // namespace

bool ReadImage(const std::string& path, cv::Mat* image, std::string* error) {
  InputBytes input;
  if (!ReadBytes(path, &input, error, kMaxImageBytes)) return false;
  const std::string_view bytes = input.text();
  if (IsCutOffPng(bytes)) {
    *error = Printable(path) + ": the image is cut off";
    return false;
  }
  const auto too_large = [&](int64_t pixels) {
    *error = Printable(path) + ": " + std::to_string(pixels) + " pixels, expected at most " +
             std::to_string(kMaxPixels / 1000000) + " million";
    return false;
  };
  const int64_t announced = AnnouncedPixels(bytes);
  if (announced > kMaxPixels) return too_large(announced);
  if (!bytes.empty()) {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U,
                          const_cast<char*>(bytes.data()));  // it is only read
    *image = cv::imdecode(encoded, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  }
  if (static_cast<int64_t>(image->total()) > kMaxPixels) {
    return too_large(static_cast<int64_t>(image->total()));
  }
  if (!image->empty()) return true;
  *error = Printable(path) + ": not an image that can be decoded" +
           (bytes.empty() ? ": the file is empty" : "");
  return false;
}

}  // namespace rigel
