#include "rigel/problems/evaluation/shard.h"

#include <cstdint>

#include "rigel/problems/io/parse_number.h"

namespace rigel {

std::pair<int, int> Shard::Range(int n) const {
  const auto begin = [&](int64_t i) { return static_cast<int>(i * n / count); };
  return {begin(index), begin(int64_t{index} + 1)};
}

bool ParseShard(std::string_view text, Shard* shard) {
  const size_t slash = text.find('/');
  Shard parsed;
  if (slash == std::string_view::npos || !ParseInteger(text.substr(0, slash), 0, &parsed.index) ||
      !ParseInteger(text.substr(slash + 1), 0, &parsed.count) || parsed.index >= parsed.count) {
    return false;
  }
  *shard = parsed;
  return true;
}

}  // namespace rigel
