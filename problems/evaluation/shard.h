// A shard: the part of a list of files that one of several runs works on.
#ifndef RIGEL_PROBLEMS_EVALUATION_SHARD_H_
#define RIGEL_PROBLEMS_EVALUATION_SHARD_H_

#include <string_view>
#include <utility>

namespace rigel {

struct Shard {
  int index = 0;  // 0 to count - 1
  int count = 1;

  // This shard has the items [first, second) of `n`. Shards are contiguous, so that a drive stays
  // together, and their sizes differ by at most one.
  std::pair<int, int> Range(int n) const;
};

// "i/n" with 0 <= i < n. False, *shard unchanged, if `text` is anything else.
bool ParseShard(std::string_view text, Shard* shard);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_SHARD_H_
