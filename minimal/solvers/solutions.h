// The list of motions that a minimal solver finds: fixed capacity, no heap.
#ifndef RIGEL_MINIMAL_SOLVERS_SOLUTIONS_H_
#define RIGEL_MINIMAL_SOLVERS_SOLUTIONS_H_

#include <array>

#include "rigel/core/pose.h"

namespace rigel {

// Those of 6pt-stewenius, the most that a solver of the catalogue has.
inline constexpr int kMaxSolutions = 64;

struct Solution : Pose {
  // False if the sample does not determine |t| (pure translation seen by intra-camera matches, a
  // central sample). The baseline between the cameras of the reference match then has unit length.
  bool has_scale = true;
};
static_assert(kSameLayoutEverywhere<Solution>, "no member of Solution may be aligned");

class Solutions {
 public:
  int size() const { return size_; }
  bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }
  const Solution& operator[](int k) const { return items_[k]; }
  Solution& operator[](int k) { return items_[k]; }
  const Solution* begin() const { return items_.data(); }
  const Solution* end() const { return items_.data() + size_; }

  // The slot for one more solution, to be filled by the caller. Beyond the capacity the last slot
  // is handed out again.
  Solution& Append() {
    if (size_ < kMaxSolutions) ++size_;
    return items_[size_ - 1];
  }

 private:
  int size_ = 0;
  std::array<Solution, kMaxSolutions> items_;
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SOLVERS_SOLUTIONS_H_
