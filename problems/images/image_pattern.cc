#include "rigel/problems/images/image_pattern.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <vector>

#include "rigel/problems/io/directory.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFrame = kFrameField;

// Whether a name fits the pattern; *frame is then its longest text at the first {frame}, and what
// is at a further one is the same.
bool Fits(std::string_view pattern, std::string_view name, std::string_view* frame) {
  if (pattern.empty()) return name.empty();
  if (pattern[0] == '*') {
    for (size_t n = 0; n <= name.size(); ++n) {
      if (Fits(pattern.substr(1), name.substr(n), frame)) return true;
    }
    return false;
  }
  if (pattern.substr(0, kFrame.size()) != kFrame) {
    return !name.empty() && name[0] == pattern[0] && Fits(pattern.substr(1), name.substr(1), frame);
  }
  const std::string_view rest = pattern.substr(kFrame.size());
  if (!frame->empty()) {
    return name.substr(0, frame->size()) == *frame && Fits(rest, name.substr(frame->size()), frame);
  }
  for (size_t n = name.size(); n > 0; --n) {
    *frame = name.substr(0, n);
    if (Fits(rest, name.substr(n), frame)) return true;
  }
  *frame = {};
  return false;
}

bool IsImageName(const fs::path& name) {
  std::string end = name.extension().string();
  std::transform(end.begin(), end.end(), end.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  constexpr std::string_view kEnds[] = {".jpg", ".jpeg", ".png", ".bmp", ".tif", ".tiff",
                                        ".pgm", ".ppm",  ".pnm", ".jp2", ".webp"};
  return std::find(std::begin(kEnds), std::end(kEnds), end) != std::end(kEnds);
}

}  // namespace

std::string FillField(std::string text, const std::string& field, const std::string& value) {
  for (size_t at = text.find(field); at != std::string::npos;
       at = text.find(field, at + value.size())) {
    text.replace(at, field.size(), value);
  }
  return text;
}

bool FindImages(const std::string& pattern, std::map<std::string, std::string>* images,
                std::string* error) {
  const size_t field = pattern.find(kFrame);
  const bool is_folder = field == std::string::npos;
  // The part with {frame}: what is before and after it has the slashes.
  const size_t slash = is_folder ? pattern.size() : pattern.rfind('/', field);
  const size_t begin = is_folder ? slash : slash == std::string::npos ? 0 : slash + 1;
  const size_t end = is_folder ? slash : std::min(pattern.find('/', field), pattern.size());
  const std::string folder = is_folder ? pattern : begin == 0 ? "." : pattern.substr(0, begin);
  const std::string part = is_folder ? "{frame}.*" : pattern.substr(begin, end - begin);
  const std::string after = pattern.substr(end);

  images->clear();
  if (!IsDirectory(folder)) return true;
  std::string twice;
  const auto add = [&](const std::string& name, bool is_directory) {
    std::string_view fits;
    if (is_directory != !after.empty() || !Fits(part, name, &fits)) return;
    if (is_folder && !IsImageName(name)) return;
    const std::string frame(fits);
    const std::string path =
        (fs::path(folder) / name).string() + FillField(after, kFrameField, frame);
    if (!after.empty() && !Exists(path)) return;
    const auto [known, is_new] = images->emplace(frame, path);
    if (is_new) return;
    twice = Printable(std::max(path, known->second)) + ": a second image of frame " +
            Quoted(frame) + ", expected only " + Printable(std::min(path, known->second));
  };
  if (!ListDirectory(folder, add, error)) return false;
  *error = twice;
  return twice.empty();
}

}  // namespace rigel
