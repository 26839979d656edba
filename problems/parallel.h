// A loop over independent items on several threads.
#ifndef RIGEL_PROBLEMS_PARALLEL_H_
#define RIGEL_PROBLEMS_PARALLEL_H_

#include <atomic>
#include <thread>
#include <vector>

namespace rigel {

// body(k) for k = 0..n-1, each once, on `num_threads` threads (at least one). The order is not
// defined, so body(k) must write to places of its own; it must not throw.
template <class Body>
void ParallelFor(int n, int num_threads, const Body& body) {
  if (num_threads <= 1 || n <= 1) {
    for (int k = 0; k < n; ++k) body(k);
    return;
  }
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int k = next++; k < n; k = next++) body(k);
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < num_threads && i < n; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
}

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_PARALLEL_H_
