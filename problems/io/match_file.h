// Match files: frame pairs as UTF-8 text, format `rigmatch 1`.
//
//   format rigmatch 1
//   camera K MODEL PARAMETER ... WIDTH HEIGHT QW QX QY QZ SX SY SZ
//   camera_sigma K ROT_DEG POS_M [FOCAL_FRACTION]
//   camera_time K DT
//   time T1 T2
//   truth QW QX QY QZ TX TY TZ
//   gravity1 GX GY GZ
//   gravity2 GX GY GZ
//   gravity_sigma_deg S
//   axis NX NY NZ
//   axis_sigma_deg S
//   normal NX NY NZ
//   normal_sigma_deg S
//   forward FX FY FZ
//   rotation QW QX QY QZ SIGMA_DEG
//   distance D SIGMA
//   noise_px S
//   sequence NAME
//   columns NAME ...
//   matches N
//   I U V J U2 V2 SCORE                  (N rows)
//
// `columns` names the columns of the rows, each once, in any order. Without it they are `i u v j u2
// v2 score`, which all files have. The others are those of MatchColumns: `landmark sigma1 sigma2
// depth1 depth_sigma a11 a12 a21 a22 affine_sigma inlier u0 v0 u20 v20`. Of `a11 a12 a21 a22`, the
// affine frame, all four or none are there, and so of `u0 v0 u20 v20`, the exact pixels.
//
// `format`, `matches` and at least `camera 0` are required. Header lines come in any order
// before `matches`. `rotation` is checked and not kept. `#` starts a comment line, blank lines are
// ignored, columns are separated by blanks or tabs. MODEL and its parameters are those of
// rigel/core/camera.h, and pixels are what this camera records. Lengths are metres, times seconds,
// sigmas of directions degrees (radians in MotionPrior); frames and quaternion order as in
// rigel/core/pose.h and rigel/core/rig.h.
//
// No function here logs, throws on what a file holds, or ends the process. An error message is
// one line of printable text: "path:line: what was wrong, what was expected", without the line
// where there is none.
#ifndef RIGEL_PROBLEMS_IO_MATCH_FILE_H_
#define RIGEL_PROBLEMS_IO_MATCH_FILE_H_

#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/frame_pair.h"

namespace rigel {

// Reads the match file `path`, which may be compressed by gzip, or stdin if it is "-"; pair->name
// becomes `path`, of stdin "stdin". False with a message if the file cannot be read, is larger than
// 2 GiB or breaks the format in any way; *pair is then unchanged. What is returned
// passes FramePair::IsValid, its directions are of unit length and its sigmas are positive.
// Directions and quaternions that are off unit length by up to 1e-3 are normalized.
bool ReadMatchFile(const std::string& path, FramePair* pair, std::string* error);

// The same for text in memory; `name` stands for the path in messages and in pair->name.
bool ParseMatches(std::string_view text, const std::string& name, FramePair* pair,
                  std::string* error);

// The text of a match file. Every number is the shortest that reads back as the same double, with
// two exceptions. Rotations pass through a quaternion; they agree to about 1e-15. A sigma passes
// through degrees; it may move by one unit in the last place, once. Does not check `pair`. A column
// without an entry for each match is left out, and so are all of a pair without matches.
std::string FormatMatches(const FramePair& pair);

// Writes `pair` to `path`, compressed if its name ends in ".gz": to a temporary file beside it,
// which then takes its place, so that `path` is never half a file. False with a message if that
// fails, or if a reader would not get the same pair back; nothing is then written. So it is with a
// number that is not finite, an image size of 0, one time without the other, or a blank in the name
// of the sequence. pair.name is not stored.
bool WriteMatchFile(const std::string& path, const FramePair& pair, std::string* error);

// The text as a file of that name has it: compressed by gzip if the name ends in ".gz".
std::string MatchFileBytes(const std::string& path, const std::string& text);

// A path (or a message that holds one) as one line that is safe to show: control characters, marks
// that turn the direction of writing and bytes that are not UTF-8 in hexadecimal.
std::string PrintablePath(const std::string& path);

// Whether a directory's file of that name is a match file: "NAME.matches" or "NAME.matches.gz".
bool IsMatchFileName(const std::string& name);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MATCH_FILE_H_
