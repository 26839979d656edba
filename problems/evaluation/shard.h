// A shard: the part of a list of files that one of several runs works on.
#ifndef RIGEL_PROBLEMS_EVALUATION_SHARD_H_
#define RIGEL_PROBLEMS_EVALUATION_SHARD_H_

#include <string_view>
#include <utility>

namespace rigel {

struct Shard {
  int index = 0;  // 0 to count - 1
  int count = 1;

  // The items [first, second) of `n` are this shard's. Shards follow each other, so that what is
  // one drive stays together, and their sizes differ by one at most.
  std::pair<int, int> Range(int n) const;
};

// "i/n" with 0 <= i < n. False, *shard unchanged, if `text` is anything else.
bool ParseShard(std::string_view text, Shard* shard);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_SHARD_H_
