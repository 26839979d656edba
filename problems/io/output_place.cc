#include "rigel/problems/io/output_place.h"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "rigel/problems/io/parse_number.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

// The number of an open file of this process if that is what NAME in DIRECTORY is, else -1.
int OwnDescriptor(const fs::path& directory, const std::string& name) {
  if (directory != "/proc/" + std::to_string(getpid()) + "/fd") return -1;
  int descriptor = -1;
  return ParseInteger(name, 0, &descriptor) ? descriptor : -1;
}

void SetKind(OutputPlace* place) {
  const mode_t mode = place->status.st_mode;
  place->kind = S_ISREG(mode)   ? OutputPlace::Kind::kRegular
                : S_ISDIR(mode) ? OutputPlace::Kind::kDirectory
                                : OutputPlace::Kind::kOther;
}

bool SameInode(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

}  // namespace

OutputPlace FollowLinks(const std::string& path) {
  OutputPlace place;
  std::error_code code;
  fs::path file = fs::absolute(path, code);
  constexpr int kMaxLinks = 40;  // as Linux has it
  for (int k = 0;; ++k) {
    if (k == kMaxLinks) {  // a loop: whoever opens it is told
      place.kind = OutputPlace::Kind::kOther;
      place.path = path;
      return place;
    }
    const fs::path directory = fs::canonical(file.parent_path(), code);
    if (code) break;
    file = directory / file.filename();
    place.descriptor = OwnDescriptor(directory, file.filename().string());
    if (place.descriptor >= 0) {
      place.kind = OutputPlace::Kind::kDescriptor;
      if (fstat(place.descriptor, &place.status) != 0) place.status = {};
      break;
    }
    const fs::path target = fs::read_symlink(file, code);
    if (code) break;
    file = target.is_absolute() ? target : directory / target;
  }
  place.path = file.string();
  if (place.descriptor < 0 && stat(place.path.c_str(), &place.status) == 0) SetKind(&place);
  return place;
}

bool SamePlace(const OutputPlace& a, const OutputPlace& b) {
  using Kind = OutputPlace::Kind;
  if (a.kind == Kind::kDescriptor && b.kind == Kind::kDescriptor) {
    return a.descriptor == b.descriptor ||
           (S_ISREG(a.status.st_mode) && SameInode(a.status, b.status));
  }
  if (a.kind == Kind::kNone && b.kind == Kind::kNone) {
    // The directory may be reached in two ways without a link, through a bind mount.
    struct stat in_a, in_b;
    const fs::path file_a(a.path), file_b(b.path);
    if (stat(file_a.parent_path().c_str(), &in_a) != 0 ||
        stat(file_b.parent_path().c_str(), &in_b) != 0) {
      return file_a.lexically_normal() == file_b.lexically_normal();
    }
    return SameInode(in_a, in_b) && file_a.filename() == file_b.filename();
  }
  if (a.kind == Kind::kNone || b.kind == Kind::kNone) return false;
  return S_ISREG(a.status.st_mode) && SameInode(a.status, b.status);
}

}  // namespace rigel
