// Vectors for kernel files (cpu_path.h): kLanes numbers side by side, in one register or two.
// Explicit vectors, as g++ keeps several sums of one plain loop in registers only where they are of
// this type.
#ifndef RIGEL_CORE_KERNEL_LANES_H_
#define RIGEL_CORE_KERNEL_LANES_H_

#include "rigel/core/cpu_path.h"

namespace rigel {

constexpr int kLanes = 4;
typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));
typedef double StoredLanes
    __attribute__((vector_size(kLanes * sizeof(double)), aligned(sizeof(double)), may_alias));

// static and always inlined, so that no copy is shared with code for other processors.
static RIGEL_KERNEL_BODY const StoredLanes& LanesAt(const double* values) {
  return *reinterpret_cast<const StoredLanes*>(values);
}

static RIGEL_KERNEL_BODY double SumOf(const Lanes& a) { return (a[0] + a[2]) + (a[1] + a[3]); }

}  // namespace rigel

#endif  // RIGEL_CORE_KERNEL_LANES_H_
