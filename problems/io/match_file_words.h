// The words of a match file, for its reader and its writer; track files share some.
#ifndef RIGEL_PROBLEMS_IO_MATCH_FILE_WORDS_H_
#define RIGEL_PROBLEMS_IO_MATCH_FILE_WORDS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "rigel/core/camera.h"

namespace rigel::match_file {

enum KeywordId {
  kFormat,
  kCamera,
  kCameraSigma,
  kCameraTime,
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
  kRotation,
  kDistance,
  kNoise,
  kSequence,
  kColumns,
  kMatches,
  kNumKeywords,
};

struct Keyword {
  std::string_view name;
  std::string_view usage;  // the whole line; its words name the columns in messages
  size_t columns;          // or kAnyColumns
  bool repeats = false;    // whether several lines may begin with it
};

// Words of a line that says itself how many it has.
inline constexpr size_t kAnyColumns = 0;

// The lines of cameras, which track files have too.
inline constexpr Keyword kCameraLine = {
    "camera", "camera K MODEL PARAMETER ... WIDTH HEIGHT QW QX QY QZ SX SY SZ", kAnyColumns, true};
inline constexpr Keyword kCameraSigmaLine = {
    "camera_sigma", "camera_sigma K ROT_DEG POS_M [FOCAL_FRACTION]", kAnyColumns, true};
inline constexpr Keyword kCameraTimeLine = {"camera_time", "camera_time K DT", 3, true};

inline constexpr std::array<Keyword, kNumKeywords> kKeywords = {{
    {"format", "format rigmatch 1", 3},
    kCameraLine,
    kCameraSigmaLine,
    kCameraTimeLine,
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
    {"rotation", "rotation QW QX QY QZ SIGMA_DEG", 6},
    {"distance", "distance D SIGMA", 3},
    {"noise_px", "noise_px S", 2},
    {"sequence", "sequence NAME", 2},
    {"columns", "columns NAME ...", kAnyColumns},
    {"matches", "matches N", 2},
}};

// The columns of a row. All rows have the first ones, up to kScore.
enum ColumnId {
  kCamera1,
  kU1,
  kV1,
  kCamera2,
  kU2,
  kV2,
  kScore,
  kLandmark,
  kSigma1,
  kSigma2,
  kDepth1,
  kDepthSigma,
  kA11,
  kA12,
  kA21,
  kA22,
  kAffineSigma,
  kInlier,
  kExactU1,
  kExactV1,
  kExactU2,
  kExactV2,
  kNumColumns,
};

inline constexpr std::array<std::string_view, kNumColumns> kColumnNames = {
    "i",      "u",      "v",           "j",   "u2",  "v2",  "score", "landmark",     "sigma1",
    "sigma2", "depth1", "depth_sigma", "a11", "a12", "a21", "a22",   "affine_sigma", "inlier",
    "u0",     "v0",     "u20",         "v20"};
inline constexpr size_t kNumDefaultColumns = kScore + 1;

// Of a camera's line: its keyword, number, model, image size, quaternion and position.
inline constexpr size_t kCameraColumns = 12;
// Words of the longest line: `columns` with the name of each, or a camera with most parameters.
inline constexpr size_t kMaxColumns =
    std::max<size_t>(kNumColumns + 1, kCameraColumns + Camera::kMostParameters);

}  // namespace rigel::match_file

#endif  // RIGEL_PROBLEMS_IO_MATCH_FILE_WORDS_H_
