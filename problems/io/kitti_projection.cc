#include "rigel/problems/io/kitti_projection.h"

#include <array>
#include <vector>

#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/text_lines.h"

namespace rigel {

bool ParseKittiProjection(std::string_view numbers, RigCamera* camera, std::string* error) {
  const std::vector<std::string_view> words = SplitAtBlanks(numbers);
  std::array<double, 12> p;
  if (words.size() != p.size()) {
    *error = std::to_string(words.size()) + " numbers, expected 12: the rows of a 3x4 matrix";
    return false;
  }
  for (size_t k = 0; k < p.size(); ++k) {
    if (!ParseFinite(words[k], &p[k])) {
      *error = "number " + std::to_string(k + 1) + " is " + Quoted(words[k]) +
               ", expected a finite number";
      return false;
    }
  }
  if (!(p[0] > 0) || !(p[5] > 0) || p[1] != 0 || p[4] != 0 || p[8] != 0 || p[9] != 0 ||
      p[10] != 1) {
    *error = "expected the projection of a rectified camera: FX 0 CX A 0 FY CY B 0 0 1 C";
    return false;
  }
  camera->intrinsics = Camera::Pinhole(p[0], p[5], p[2], p[6]);
  const Eigen::Vector3d t((p[3] - p[2] * p[11]) / p[0], (p[7] - p[6] * p[11]) / p[5], p[11]);
  camera->Q.setIdentity();
  // 0 - t, and not -t: no minus sign before the zeros of the left camera.
  camera->s = Eigen::Vector3d::Zero() - t;
  return true;
}

}  // namespace rigel
