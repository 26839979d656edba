// The median of values whose order does not matter.
#ifndef RIGEL_CORE_MEDIAN_H_
#define RIGEL_CORE_MEDIAN_H_

#include <algorithm>
#include <vector>

namespace rigel {

// The upper one of the two in the middle of an even number. `values` must not be empty and hold no
// NaN; they are reordered.
template <class T>
T MedianInPlace(std::vector<T>* values) {
  const auto middle = values->begin() + static_cast<long>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

}  // namespace rigel

#endif  // RIGEL_CORE_MEDIAN_H_
