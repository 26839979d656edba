// libFuzzer target of the match file reader: any bytes either parse to a valid frame pair, which
// then survives being written and read again, or give a one-line message.
//
//   match_file_fuzzer CORPUS_DIR     (a folder with a few .matches files to start from)
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "rigel/problems/match_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  rigel::FramePair pair, again;
  std::string error;
  if (rigel::ParseMatches(text, "fuzz", &pair, &error)) {
    if (!pair.IsValid(&error)) std::abort();
    if (!rigel::ParseMatches(rigel::FormatMatches(pair), "again", &again, &error)) std::abort();
    if (again.matches.size() != pair.matches.size()) std::abort();
  } else if (error.empty() || error.find('\n') != std::string::npos) {
    std::abort();
  }
  return 0;
}
