// Match files: any bytes either parse to a valid frame pair, which then survives being written and
// read again, or give a one-line message.
#include "rigel/problems/io/match_file.h"
#include "rigel/test/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  rigel::FramePair pair, again;
  std::string error;
  if (!rigel::ParseMatches(text, "fuzz", &pair, &error)) {
    rigel::fuzz::RequireMessage(error);
    return 0;
  }
  Require(pair.IsValid(&error), "what was read is valid: " + error);
  Require(rigel::ParseMatches(rigel::FormatMatches(pair), "again", &again, &error),
          "what was written can be read: " + error);
  Require(again.matches.size() == pair.matches.size(), "all matches come back");
  Require(again.columns.landmark == pair.columns.landmark &&
              again.columns.sigma1 == pair.columns.sigma1 &&
              again.columns.affine == pair.columns.affine &&
              again.columns.inlier == pair.columns.inlier &&
              again.columns.exact == pair.columns.exact,
          "their columns come back");
  return 0;
}
