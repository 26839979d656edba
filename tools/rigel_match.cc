// rigel_match: match files from the images of a rig.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <gflags/gflags.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "rigel/problems/images/euroc_sequence.h"
#include "rigel/problems/images/kitti_sequence.h"
#include "rigel/problems/images/rig_sequence.h"
#include "rigel/problems/images/sequence_matching.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/tools/outputs.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/sensor_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(rig, "", "rig file of the cameras (docs/formats.md)");
DEFINE_string(
    images, "",
    "with --rig: pattern of the images, as '{camera}/{frame}.jpg'. {camera} is a camera's name in "
    "the rig file, or its number; {frame} says the frame; * is any text beside {frame}. Without "
    "{frame} it is a folder. Default: 'images' of each camera in the rig file");
DEFINE_string(masks, "",
              "with --rig: pattern of masks, as '{camera}.png' or '{camera}/{frame}.png'; no key "
              "points where they are black");
DEFINE_string(frames, "name",
              "with --rig: images of one frame have the same {frame} (name), the same place in the "
              "order of their names (order), or about the same time stamp {frame} (time)");
DEFINE_double(time_unit_s, 1e-9, "with --frames=time: what {frame} counts, seconds");
DEFINE_string(camera_pairs, "overlap",
              "with --rig: cameras that are matched with each other: those whose fields of view "
              "overlap (overlap), all, none, or pairs of names or numbers, as 0-1,left-rear. Each "
              "camera is matched with itself");
DEFINE_string(kitti_root, "",
              "directory of the KITTI odometry data, with sequences/ and, for the truth, poses/");
DEFINE_string(sequence, "",
              "with --kitti_root: name of the sequence, for example 06; with --rig: name of the "
              "sequence in the match files. Default: the rig's");
DEFINE_string(euroc_root, "", "directory of a EuRoC sequence: mav0, or the one that holds mav0");
DEFINE_double(
    sync_tolerance_ms, -1,
    "with --euroc_root or --frames=time: maximum difference of the time stamps of the images of a "
    "frame, milliseconds. -1: a tenth of the frame interval");
DEFINE_string(
    output, "",
    "directory for the match files 000020-000021.matches, ...; created if missing. Must not hold "
    "match files, except with --resume");
DEFINE_bool(landmarks, true,
            "write the column landmark: rows of one number see one point. Also matches the images "
            "of one frame with each other. Default with --kitti_root and --euroc_root: only with "
            "--tracks or --landmarks");
DEFINE_string(tracks, "",
              "also write the landmarks of all frames, as a track file (docs/formats.md)");
DEFINE_int32(first, 0, "first frame");
DEFINE_int32(last, -1, "last frame; -1: the last of the sequence");
DEFINE_int32(stride, 1, "match frames that are this many frames apart");
DEFINE_string(features, "sift", "features: sift or orb");
DEFINE_int32(max_features, 2000, "maximum number of key points per image; the strongest are kept");
DEFINE_double(
    ratio, 0.8,
    "maximum ratio of Lowe's test: distance of the nearest descriptor to that of the second "
    "nearest; applied in both directions");
DEFINE_bool(resume, false,
            "continue an interrupted run with the same settings; existing files are kept");
DEFINE_int32(threads, 1, "number of threads, 1 to 1024. The files do not depend on it");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_match: makes match files from the images of a rig.\n"
    "\n"
    "  rigel_match --rig=rig.json --images='{camera}/{frame}.jpg' --output=DIR\n"
    "  rigel_match --kitti_root=KITTI --sequence=06 --first=20 --last=27 --output=DIR\n"
    "  rigel_match --euroc_root=EUROC/V1_01_easy --output=DIR\n"
    "\n"
    "Matches features of consecutive frames: of each camera with itself, and of cameras whose\n"
    "fields of view overlap. Matches are pairs of mutually nearest descriptors that pass the\n"
    "ratio test, without a check of the geometry. Pixels are those of the images; those of EuRoC\n"
    "are undistorted. If the data set has a ground truth, the files get times, truth and gravity.\n"
    "Frames count from 0. --attitude, --odometry and --gyro add priors from sensors, as\n"
    "rigel_convert does.\n";

bool IsKitti() { return !FLAGS_kitti_root.empty(); }

bool IsEuroc() { return !FLAGS_euroc_root.empty(); }

// What the flags say about the images.
struct DataSet {
  EurocOptions euroc;
  RigSequenceOptions rig;
};

// False with a message if a flag was given that the kind of data set does not have.
bool CheckGivenFlags(std::string* error) {
  const bool is_rig = !FLAGS_rig.empty();
  const std::vector<std::string> of_rig = {"images", "masks", "frames", "time_unit_s",
                                           "camera_pairs"};
  const std::string flag = is_rig ? "" : FirstGiven(of_rig);
  if (!flag.empty()) return Refuse("--" + flag + ": has an effect with --rig only", error);
  if (IsEuroc() && IsGiven("sequence")) {
    return Refuse("--sequence: has no effect with --euroc_root, which is one sequence", error);
  }
  if (is_rig && FLAGS_frames != "time" &&
      !FirstGiven({"time_unit_s", "sync_tolerance_ms"}).empty()) {
    return Refuse("--" + FirstGiven({"time_unit_s", "sync_tolerance_ms"}) +
                      ": has an effect with --frames=time only",
                  error);
  }
  if (IsKitti() && IsGiven("sync_tolerance_ms")) {
    return Refuse("--sync_tolerance_ms: KITTI has one time stamp for both images of a frame",
                  error);
  }
  return true;
}

bool RigFromFlags(RigSequenceOptions* options, std::string* error) {
  options->images = FLAGS_images;
  options->masks = FLAGS_masks;
  options->camera_pairs = FLAGS_camera_pairs;
  options->name = FLAGS_sequence;
  if (!ParseFrameOrder(FLAGS_frames, &options->order)) {
    return WrongValue("frames", FLAGS_frames, "name, order or time", error);
  }
  constexpr double kMaxRounding = 1e-3;  // nanoseconds, of a unit that is a whole number of them
  const double unit_ns = FLAGS_time_unit_s * 1e9;
  options->time_unit_ns = std::llround(std::clamp(unit_ns, 0.0, 2e9));
  if (!(std::abs(unit_ns - static_cast<double>(options->time_unit_ns)) < kMaxRounding) ||
      !options->IsValid(error)) {
    return Refuse("--time_unit_s: expected whole nanoseconds, 1e-9 to 1", error);
  }
  return true;
}

bool DataSetFromFlags(DataSet* data, std::string* error) {
  const int kinds = (IsKitti() ? 1 : 0) + (IsEuroc() ? 1 : 0) + (FLAGS_rig.empty() ? 0 : 1);
  if (kinds > 1) {
    return Refuse("--rig, --kitti_root and --euroc_root: expected one of them", error);
  }
  if (kinds == 0) {
    return Refuse("--rig, --kitti_root or --euroc_root is missing: name a rig file or a data set",
                  error);
  }
  if (IsKitti() && FLAGS_sequence.empty()) {
    return Refuse("--sequence is missing: name a sequence, as 06", error);
  }
  if (FLAGS_sequence.find_first_of("/ \t\n\r") != std::string::npos || FLAGS_sequence == "." ||
      FLAGS_sequence == "..") {
    return Refuse("--sequence: expected the name of a directory, without blanks and slashes",
                  error);
  }
  if (!CheckGivenFlags(error)) return false;
  if (IsGiven("sync_tolerance_ms")) {
    data->euroc.sync_tolerance_ms = FLAGS_sync_tolerance_ms;
    data->rig.sync_tolerance_ms = FLAGS_sync_tolerance_ms;
    if (!data->euroc.IsValid(error)) {
      *error = "--" + *error;
      return false;
    }
  }
  return FLAGS_rig.empty() || RigFromFlags(&data->rig, error);
}

// Whether the files get the column `landmark`.
bool LandmarksFromFlags(bool* landmarks, std::string* error) {
  const bool by_default = !FLAGS_rig.empty() || !FLAGS_tracks.empty();
  *landmarks = IsGiven("landmarks") ? FLAGS_landmarks : by_default;
  if (*landmarks || FLAGS_tracks.empty()) return true;
  return Refuse("--tracks: needs the landmarks that --landmarks=false leaves out", error);
}

bool SettingsFromFlags(SequenceMatchingOptions* options, DataSet* data, std::string* error) {
  if (!DataSetFromFlags(data, error)) return false;
  if (FLAGS_output.empty()) {
    return Refuse("--output is missing: name a directory", error);
  }
  if (!ParseFeatureType(FLAGS_features, &options->features.type)) {
    return WrongValue("features", FLAGS_features, "sift or orb", error);
  }
  if (IsGiven("last") && FLAGS_last < 0) {
    return WrongValue("last", std::to_string(FLAGS_last), "0 or more", error);
  }
  if (!CheckThreads(FLAGS_threads, 1, error)) return false;
  if (!LandmarksFromFlags(&options->landmarks, error)) return false;
  options->features.max_features = FLAGS_max_features;
  options->features.ratio = FLAGS_ratio;
  options->first = FLAGS_first;
  options->last = FLAGS_last;
  options->stride = FLAGS_stride;
  options->num_threads = FLAGS_threads;
  options->resume = FLAGS_resume;
  if (!CheckSensorFlags(error)) return false;
  if (options->IsValid(error)) return true;
  *error = "--" + *error;
  return false;
}

// Says on stderr what the sequence lacks. False with a message if it cannot be read.
bool ReadSequence(const DataSet& data, ImageSequence* sequence, std::string* error) {
  const bool is_rig = !FLAGS_rig.empty();
  const bool read = IsKitti() ? ReadKittiSequence(FLAGS_kitti_root, FLAGS_sequence, sequence, error)
                    : IsEuroc() ? ReadEurocSequence(FLAGS_euroc_root, data.euroc, sequence, error)
                                : ReadRigSequence(FLAGS_rig, data.rig, sequence, error);
  if (!read) return false;
  for (const std::string& note : sequence->notes) std::cerr << note << "\n";
  if (is_rig) return true;
  if (std::none_of(sequence->frames.begin(), sequence->frames.end(),
                   [](const ImageFrame& frame) { return frame.world_from_body.has_value(); })) {
    std::cerr << "sequence " << PrintablePath(sequence->name)
              << " has no ground truth: the files get no truth and no gravity\n";
  }
  return true;
}

// False with a message if the file of the tracks is one that is read.
bool TracksAreNoInput(const ImageSequence& sequence, std::string* error) {
  if (FLAGS_tracks.empty()) return true;
  std::vector<std::string> inputs;
  if (!FLAGS_rig.empty()) inputs.push_back(FLAGS_rig);
  for (const ImageFrame& frame : sequence.frames) {
    for (const auto* paths : {&frame.images, &frame.masks}) {
      std::copy_if(paths->begin(), paths->end(), std::back_inserter(inputs),
                   [](const std::string& path) { return !path.empty(); });
    }
  }
  return OutputsAreNoInputs({{"tracks", FLAGS_tracks}}, inputs, error);
}

// Says on stderr what was written and what could not be.
void Report(const SequenceMatchingSummary& summary) {
  // Lines of messages. If the images of a whole range are missing, a few names are enough.
  constexpr size_t kMaxMissing = 5;
  for (const std::string& note : summary.notes) std::cerr << note << "\n";
  const size_t shown = std::min(summary.missing.size(), kMaxMissing);
  for (size_t k = 0; k < shown; ++k) std::cerr << summary.missing[k] << "\n";
  if (summary.missing.size() > shown) {
    std::cerr << "and " << summary.missing.size() - shown << " more images that cannot be opened\n";
  }
  for (const std::string& message : summary.errors) std::cerr << message << "\n";
  const int failed = summary.num_pairs - summary.written - summary.kept;
  std::cerr << "wrote " << summary.written << " match files to " << PrintablePath(FLAGS_output);
  if (summary.kept > 0) std::cerr << ", kept " << summary.kept;
  if (failed > 0) std::cerr << "; " << failed << " could not be made";
  std::cerr << "\n";
}

int Run() {
  SequenceMatchingOptions options;
  DataSet data;
  ImageSequence sequence;
  std::string error;
  if (!SettingsFromFlags(&options, &data, &error)) return UsageError(error);
  // Pairs run beside each other; threads of OpenCV within one would only be in their way. What
  // OpenCV logs is said in the program's own words.
  cv::setNumThreads(1);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  if (!ReadSequence(data, &sequence, &error)) return Failure(error);
  if (!TracksAreNoInput(sequence, &error)) return UsageError(error);
  SensorSource sensors;
  if (HasSensors()) {
    if (!sensors.Load(&error)) return Failure(error);
    options.header_lines = [&](const FramePair& pair) { return sensors.Lines(pair); };
    options.header_settings = SensorSource::Settings();
  }

  std::unique_ptr<Progress> progress;
  SequenceMatchingSummary summary;
  const bool ran = MatchSequence(
      options, sequence, FLAGS_output,
      [&](int todo) { progress = std::make_unique<Progress>(ProgramName(), todo); },
      [&] { progress->Step(); }, &summary, &error);
  progress.reset();
  if (!ran) return Failure(error);
  Report(summary);
  sensors.Report();
  const bool all_made = summary.errors.empty() && summary.missing.empty();
  if (!FLAGS_tracks.empty() && !all_made) {
    std::cerr << "no tracks were written: they need all match files; make the missing ones with "
                 "--resume\n";
  } else if (!FLAGS_tracks.empty()) {
    TracksSummary tracks;
    const std::string path = FLAGS_tracks == "-" ? "/dev/stdout" : FLAGS_tracks;
    if (!WriteTracks(options, sequence, FLAGS_output, path, &tracks, &error)) {
      return Failure(error);
    }
    std::cerr << "wrote " << tracks.landmarks << " landmarks with " << tracks.observations
              << " observations to " << PrintablePath(FLAGS_tracks) << "\n";
  }
  return ExitCode(all_made);
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
