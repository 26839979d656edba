// Which vector instructions a kernel may use: chosen when the program runs, so that one portable
// binary takes what the machine has.
//
// A kernel is a file of plain loops. Its body is always inlined, in one function for each path;
// that of AVX2 has RIGEL_TARGET_AVX2. The body has no templates of Eigen or the standard library:
// the linker could take their copies with AVX2 instructions for the whole program. Built with
// -ffp-contract=off and with sums over a fixed number of lanes, every path gives the same bits.
#ifndef RIGEL_CORE_CPU_PATH_H_
#define RIGEL_CORE_CPU_PATH_H_

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define RIGEL_HAS_AVX2_PATH 1
#define RIGEL_TARGET_AVX2 __attribute__((target("avx2")))
#define RIGEL_KERNEL_BODY inline __attribute__((always_inline))
#else
#define RIGEL_HAS_AVX2_PATH 0
#define RIGEL_TARGET_AVX2
#define RIGEL_KERNEL_BODY inline
#endif

namespace rigel {

enum class CpuPath { kBaseline, kAvx2 };

// The best path of this machine and build; found once.
CpuPath BestCpuPath();

}  // namespace rigel

#endif  // RIGEL_CORE_CPU_PATH_H_
