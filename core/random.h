// Random numbers from an explicit seed, the same on every platform.
//
// The standard fixes std::mt19937_64 but not its distributions, so those are made here. Draw once
// in an expression, or in a braced list: in f(a.Uniform(), a.Uniform()) and a.Uniform() *
// a.Normal() the order is the compiler's.
#ifndef RIGEL_CORE_RANDOM_H_
#define RIGEL_CORE_RANDOM_H_

#include <cstdint>

#include <Eigen/Core>

namespace rigel {

// SplitMix64 (Steele, Lea, Flood 2014): one 64-bit word of state, so that making one for every
// frame pair costs nothing.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  // A generator whose numbers do not depend on how many were drawn from others: stream `index`
  // of `seed`.
  static Random Stream(uint64_t seed, uint64_t index);

  uint64_t Next() {
    uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  // Uniform in [0, n), n > 0. The bias of the multiply-shift is below n / 2^32.
  int Index(int n) { return static_cast<int>(((Next() >> 32) * static_cast<uint64_t>(n)) >> 32); }

  // Uniform in [0, 1) and in [low, high).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  // Normal with mean 0 and standard deviation 1 (Box-Muller).
  double Normal();
  Eigen::Vector3d NormalVector3();

  // Uniform on the unit sphere.
  Eigen::Vector3d UnitVector3();

 private:
  uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace rigel

#endif  // RIGEL_CORE_RANDOM_H_
