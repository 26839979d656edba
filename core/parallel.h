// A loop over independent items on several threads.
#ifndef RIGEL_CORE_PARALLEL_H_
#define RIGEL_CORE_PARALLEL_H_

#include <atomic>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace rigel {

// body(k) for k = 0..n-1, each once, on `num_threads` threads (at least one), or on as many as the
// system gives. The order is not defined, so body(k) must write to places of its own. What it
// throws first is thrown here, when all threads have ended; no more items are begun then.
template <class Body>
void ParallelFor(int n, int num_threads, const Body& body) {
  if (num_threads <= 1 || n <= 1) {
    for (int k = 0; k < n; ++k) body(k);
    return;
  }
  std::atomic<int> next{0};
  std::exception_ptr thrown;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (int k = next++; k < n; k = next++) body(k);
    } catch (...) {
      next = n;
      const std::lock_guard<std::mutex> lock(mutex);
      if (thrown == nullptr) thrown = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  try {
    for (int i = 1; i < num_threads && i < n; ++i) threads.emplace_back(work);
  } catch (const std::system_error&) {
    // A limit on processes: those that are there do the work.
  } catch (const std::bad_alloc&) {
  }
  work();
  for (std::thread& thread : threads) thread.join();
  if (thrown != nullptr) std::rethrow_exception(thrown);
}

}  // namespace rigel

#endif  // RIGEL_CORE_PARALLEL_H_
