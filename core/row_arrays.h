// The matches of one camera pair, as kernels read them: arrays of coordinates.
//
// F is the matrix of the camera pair, C = p2'F p1 the epipolar constraint. Each side of a match has
// a point p, which F multiplies, and J, how p moves with the pixel (row_point.h). The Sampson error
// is r = C / |(J1'F'p2, J2'F p1)|, in pixels.
#ifndef RIGEL_CORE_ROW_ARRAYS_H_
#define RIGEL_CORE_ROW_ARRAYS_H_

#include <cstddef>

#include "rigel/core/cpu_path.h"

namespace rigel {

// The kernels read whole vectors. So they read the arrays below beyond the last element, up to a
// multiple of this number. The caller must own that memory; its content does not matter.
inline constexpr int kKernelPadding = 8;

struct RowArrays {
  // The first two coordinates of p at time 1 and of p at time 2.
  const double* x1;
  const double* y1;
  const double* x2;
  const double* y2;
  int size;
  // Null for pinhole cameras, with a p of third coordinate 1 and J of the first two rows of the
  // identity. Else the arrays z1, z2, J1 and J2 (row by row), each `stride` after the one before.
  const double* general = nullptr;
  std::size_t stride = 0;
};
inline constexpr int kGeneralArrays = 14;  // two third coordinates, two times six derivatives  //
                                           // z1, z2, and six for each of J1 and J2

// The same rows from `begin` on, `size` of them.
static RIGEL_KERNEL_BODY RowArrays RowsFrom(const RowArrays& rows, int begin, int size) {
  return {rows.x1 + begin,
          rows.y1 + begin,
          rows.x2 + begin,
          rows.y2 + begin,
          size,
          rows.general == nullptr ? nullptr : rows.general + begin,
          rows.stride};
}

}  // namespace rigel

#endif  // RIGEL_CORE_ROW_ARRAYS_H_
