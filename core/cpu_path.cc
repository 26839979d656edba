#include "rigel/core/cpu_path.h"

namespace rigel {

CpuPath BestCpuPath() {
#if RIGEL_HAS_AVX2_PATH
  static const CpuPath best = __builtin_cpu_supports("avx2") ? CpuPath::kAvx2 : CpuPath::kBaseline;
  return best;
#else
  return CpuPath::kBaseline;
#endif
}

}  // namespace rigel
