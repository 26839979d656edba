// Many frame pairs on all cores. EstimateMotion() keeps no state: each thread takes the next pair,
// and the result of a pair is the same on any number of threads.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <thread>
#include <vector>

#include "drive.h"
#include "rigel/refine/estimate_motion.h"

namespace {

std::vector<rigel::MotionEstimate> EstimateAll(const std::vector<rigel::FramePair>& pairs,
                                               unsigned num_threads,
                                               const std::atomic<bool>* cancel) {
  rigel::EstimateOptions options;
  options.cancel = cancel;  // set it from any thread: running estimates end with what they have
  std::vector<rigel::MotionEstimate> estimates(pairs.size());
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t k = next++; k < pairs.size(); k = next++) {
      estimates[k] = rigel::EstimateMotion(options, pairs[k]);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned k = 0; k < num_threads; ++k) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  return estimates;
}

}  // namespace

int main() {
  std::vector<rigel::FramePair> pairs;
  for (int k = 0; k < 24; ++k) pairs.push_back(MatchFrames(k, k + 1));

  std::atomic<bool> cancel{false};
  const unsigned cores = std::max(2U, std::thread::hardware_concurrency());
  const std::vector<rigel::MotionEstimate> all = EstimateAll(pairs, cores, &cancel);
  const std::vector<rigel::MotionEstimate> one = EstimateAll(pairs, 1, &cancel);

  int same = 0, right = 0;
  for (size_t k = 0; k < pairs.size(); ++k) {
    const rigel::Pose &pose = all[k].pose, &again = one[k].pose;
    same += pose.R == again.R && pose.t == again.t;
    const int frame = static_cast<int>(k);
    const rigel::Pose error = pose * TrueMotion(frame, frame + 1).Inverse();
    right += all[k].HasMotion() && rigel::LogSO3(error.R).norm() < 0.005 && error.t.norm() < 0.1;
  }
  const int n = static_cast<int>(pairs.size());
  std::printf("%u threads, %d pairs: %d right, %d the same as on one thread\n", cores, n, right,
              same);
  return right == n && same == n ? 0 : 1;
}
