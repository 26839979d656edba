// The loop over independent items.
#include "rigel/core/parallel.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <new>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(ParallelFor, RunsEachItemOnceOnAnyNumberOfThreads) {
  for (const int threads : {-1, 0, 1, 2, 3, 16, 200}) {
    for (const int n : {0, 1, 2, 7, 100}) {
      std::vector<std::atomic<int>> count(n);
      ParallelFor(n, threads, [&](int k) { ++count[k]; });
      for (int k = 0; k < n; ++k)
        EXPECT_EQ(count[k].load(), 1) << threads << " threads, item " << k;
    }
  }
}

TEST(ParallelFor, ANegativeCountIsNone) {
  ParallelFor(-3, 4, [](int) { FAIL(); });
}

TEST(ParallelFor, OneThreadRunsInOrderOnTheCallersOwn) {
  std::vector<int> order;
  const auto caller = std::this_thread::get_id();
  ParallelFor(5, 1, [&](int k) {
    order.push_back(k);
    EXPECT_EQ(std::this_thread::get_id(), caller);
  });
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(ParallelFor, WhatAnItemThrowsIsThrownWhenAllThreadsHaveEnded) {
  for (const int threads : {1, 4}) {
    std::atomic<int> count{0};
    EXPECT_THROW(ParallelFor(1000, threads,
                             [&](int k) {
                               if (k == 10) throw std::bad_alloc();
                               ++count;
                             }),
                 std::bad_alloc);
    EXPECT_LT(count, 1000);
  }
}

// Items that wait for each other finish only if there are as many threads.
TEST(ParallelFor, HasAsManyThreadsAsAskedFor) {
  constexpr int kThreads = 3;
  std::atomic<int> arrived{0};
  std::mutex mutex;
  std::set<std::thread::id> ids;
  ParallelFor(kThreads, kThreads, [&](int) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      ids.insert(std::this_thread::get_id());
    }
    ++arrived;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (arrived < kThreads && std::chrono::steady_clock::now() < give_up) {
      std::this_thread::yield();
    }
  });
  EXPECT_EQ(ids.size(), static_cast<size_t>(kThreads));
}

}  // namespace
}  // namespace rigel
