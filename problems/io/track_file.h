// Track files: the observations of landmarks over the frames of a drive, format `rigtracks 1`.
//
//   format rigtracks 1
//   camera K MODEL PARAMETER ... WIDTH HEIGHT QW QX QY QZ SX SY SZ
//   camera_sigma K ROT_DEG POS_M [FOCAL_FRACTION]
//   camera_time K DT
//   frame F [TIME]
//   truth F QW QX QY QZ TX TY TZ
//   gravity F GX GY GZ
//   gravity_sigma_deg S
//   distance F G D SIGMA
//   noise_px S
//   sequence NAME
//   observations N
//   LANDMARK FRAME CAMERA U V [SIGMA]    (N rows)
//
// As match files (match_file.h) but for this: a `frame` line declares each frame, whose number is
// from 0. `truth` is world_from_body, `gravity` the unit direction "down" in the body frame at that
// time, `distance` the length of t between two frames. A row says where a camera sees a landmark in
// a frame, at most once, with the 1-sigma noise of that pixel in all rows or in none.
//
// No function here logs, throws on what a file holds, or ends the process. An error message is one
// line of printable text: "path:line: what was wrong, what was expected".
#ifndef RIGEL_PROBLEMS_IO_TRACK_FILE_H_
#define RIGEL_PROBLEMS_IO_TRACK_FILE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/pose.h"
#include "rigel/core/rig.h"

namespace rigel {

struct TrackFrame {
  int number = 0;
  std::optional<double> time;              // seconds
  std::optional<Pose> world_from_body;     // ground truth
  std::optional<Eigen::Vector3d> gravity;  // unit, "down" in the body frame
};

struct TrackDistance {
  int frame1 = 0, frame2 = 0;
  double distance = 0.0, sigma = 0.0;  // metres
};

struct Observation {
  int64_t landmark = 0;
  int frame = 0;
  int camera = 0;
  Pixel pixel = Pixel::Zero();
  std::optional<double> sigma;  // pixels, 1 sigma
};

struct Tracks {
  std::string name;      // for messages; a file's path
  std::string sequence;  // may be empty
  Rig rig;
  std::vector<TrackFrame> frames;  // by their numbers
  std::vector<TrackDistance> distances;
  std::optional<double> gravity_sigma;  // radians
  std::optional<double> noise_px;
  std::vector<Observation> observations;
};

// Reads the track file `path`, which may be compressed by gzip, or stdin if it is "-". False with a
// message if the file cannot be read or breaks the format in any way; *tracks is then unchanged.
bool ReadTrackFile(const std::string& path, Tracks* tracks, std::string* error);

// The same for text in memory; `name` stands for the path in messages and in tracks->name.
bool ParseTracks(std::string_view text, const std::string& name, Tracks* tracks,
                 std::string* error);

// The text of a track file. Numbers read back as the same, as those of match files do. Does not
// check `tracks`; sigmas are left out unless all observations have one.
std::string FormatTracks(const Tracks& tracks);

// Writes `tracks` to `path`, compressed if its name ends in ".gz", completely or not at all. False
// with a message if that fails, or if a reader would refuse the text.
bool WriteTrackFile(const std::string& path, const Tracks& tracks, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_TRACK_FILE_H_
