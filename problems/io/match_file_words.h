// The words of a match file, for its reader and its writer.
#ifndef RIGEL_PROBLEMS_IO_MATCH_FILE_WORDS_H_
#define RIGEL_PROBLEMS_IO_MATCH_FILE_WORDS_H_

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace rigel::match_file {

enum KeywordId {
  kFormat,
  kCamera,
  kTime,
  kTruth,
  kGravity1,
  kGravity2,
  kGravitySigma,
  kAxis,
  kAxisSigma,
  kNormal,
  kNormalSigma,
  kForward,
  kDistance,
  kNoise,
  kSequence,
  kMatches,
  kNumKeywords,
};

struct Keyword {
  std::string_view name;
  std::string_view usage;  // the whole line; its words name the columns in messages
  size_t columns;
};

// Words of the longest line, that of a camera.
inline constexpr size_t kMaxColumns = 16;
inline constexpr std::array<Keyword, kNumKeywords> kKeywords = {{
    {"format", "format rigmatch 1", 3},
    {"camera", "camera K pinhole FX FY CX CY WIDTH HEIGHT QW QX QY QZ SX SY SZ", 16},
    {"time", "time T1 T2", 3},
    {"truth", "truth QW QX QY QZ TX TY TZ", 8},
    {"gravity1", "gravity1 GX GY GZ", 4},
    {"gravity2", "gravity2 GX GY GZ", 4},
    {"gravity_sigma_deg", "gravity_sigma_deg S", 2},
    {"axis", "axis NX NY NZ", 4},
    {"axis_sigma_deg", "axis_sigma_deg S", 2},
    {"normal", "normal NX NY NZ", 4},
    {"normal_sigma_deg", "normal_sigma_deg S", 2},
    {"forward", "forward FX FY FZ", 4},
    {"distance", "distance D SIGMA", 3},
    {"noise_px", "noise_px S", 2},
    {"sequence", "sequence NAME", 2},
    {"matches", "matches N", 2},
}};

}  // namespace rigel::match_file

#endif  // RIGEL_PROBLEMS_IO_MATCH_FILE_WORDS_H_
