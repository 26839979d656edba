#include "rigel/problems/evaluation/shard.h"

#include <charconv>
#include <cstdint>
#include <system_error>

namespace rigel {
namespace {

bool ParseWhole(std::string_view text, int* value) {
  const char* const end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, *value);
  return status == std::errc() && stop == end && *value >= 0;
}

}  // namespace

std::pair<int, int> Shard::Range(int n) const {
  const auto begin = [&](int64_t i) { return static_cast<int>(i * n / count); };
  return {begin(index), begin(int64_t{index} + 1)};
}

bool ParseShard(std::string_view text, Shard* shard) {
  const size_t slash = text.find('/');
  Shard parsed;
  if (slash == std::string_view::npos || !ParseWhole(text.substr(0, slash), &parsed.index) ||
      !ParseWhole(text.substr(slash + 1), &parsed.count) || parsed.index >= parsed.count) {
    return false;
  }
  *shard = parsed;
  return true;
}

}  // namespace rigel
