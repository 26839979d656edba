// Vectors for kernel files (cpu_path.h): kLanes numbers side by side, in one register or two.
// Explicit vectors, as g++ keeps several sums of one plain loop in registers only where they are of
// this type.
#ifndef RIGEL_CORE_KERNEL_LANES_H_
#define RIGEL_CORE_KERNEL_LANES_H_

#include "rigel/core/cpu_path.h"

namespace rigel {

// Doubles: one register with AVX2, two without. The same on all machines, so that sums are, too.
constexpr int kLanes = 4;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

// static and always inlined, so that no copy is shared with code for other processors.
// By value: a reference to a vector of lower alignment loses it with clang. (Nothing is returned by
// a call, so kernel files are built with -Wno-psabi.)
static RIGEL_KERNEL_BODY Lanes LanesAt(const double* values) {
  Lanes lanes;
  __builtin_memcpy(&lanes, values, sizeof(lanes));
  return lanes;
}

static RIGEL_KERNEL_BODY double SumOf(const Lanes& a) { return (a[0] + a[2]) + (a[1] + a[3]); }

}  // namespace rigel

#endif  // RIGEL_CORE_KERNEL_LANES_H_
