// rigel_match: match files from the images of a stereo rig.
#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <gflags/gflags.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "rigel/problems/images/euroc_sequence.h"
#include "rigel/problems/images/kitti_sequence.h"
#include "rigel/problems/images/sequence_matching.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/sensor_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(kitti_root, "",
              "directory of the KITTI odometry data, with sequences/ and, for the truth, poses/");
DEFINE_string(sequence, "", "with --kitti_root: name of the sequence, for example 06");
DEFINE_string(euroc_root, "", "directory of a EuRoC sequence: mav0, or the one that holds mav0");
DEFINE_double(
    sync_tolerance_ms, -1,
    "with --euroc_root: maximum difference of the time stamps of the two images of a frame, "
    "milliseconds. -1: a tenth of the frame interval");
DEFINE_string(
    output, "",
    "directory for the match files 000020-000021.matches, ...; created if missing. Must not hold "
    "match files, except with --resume");
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
    "rigel_match: makes match files from the images of a stereo rig.\n"
    "\n"
    "  rigel_match --kitti_root=KITTI --sequence=06 --first=20 --last=27 --output=DIR\n"
    "  rigel_match --euroc_root=EUROC/V1_01_easy --output=DIR\n"
    "\n"
    "Matches features of consecutive frames, in all four combinations of the left and the right\n"
    "camera: pairs of mutually nearest descriptors that pass the ratio test, without a check of\n"
    "the geometry. Pixels are undistorted: cameras are pinholes. If the data set has a ground\n"
    "truth, the files get times, truth and gravity. Frames count from 0; a frame of EuRoC is a\n"
    "pair of images of one time. --attitude, --odometry and --gyro add priors from sensors, as\n"
    "rigel_convert does.\n";

bool IsKitti() { return !FLAGS_kitti_root.empty(); }

bool DataSetFromFlags(EurocOptions* euroc, std::string* error) {
  if (IsKitti() && !FLAGS_euroc_root.empty()) {
    return Refuse("--kitti_root and --euroc_root: expected one of them", error);
  }
  if (!IsKitti() && FLAGS_euroc_root.empty()) {
    return Refuse("--kitti_root or --euroc_root is missing: name the data set's directory", error);
  }
  if (IsKitti() && FLAGS_sequence.empty()) {
    return Refuse("--sequence is missing: name a sequence, as 06", error);
  }
  if (FLAGS_sequence.find_first_of("/ \t\n\r") != std::string::npos || FLAGS_sequence == "." ||
      FLAGS_sequence == "..") {
    return Refuse("--sequence: expected the name of a directory, without blanks and slashes",
                  error);
  }
  if (!IsKitti() && IsGiven("sequence")) {
    return Refuse("--sequence: has no effect with --euroc_root, which is one sequence", error);
  }
  if (!IsGiven("sync_tolerance_ms")) return true;
  if (IsKitti()) {
    return Refuse("--sync_tolerance_ms: KITTI has one time stamp for both images of a frame",
                  error);
  }
  euroc->sync_tolerance_ms = FLAGS_sync_tolerance_ms;
  if (euroc->IsValid(error)) return true;
  *error = "--" + *error;
  return false;
}

bool SettingsFromFlags(SequenceMatchingOptions* options, EurocOptions* euroc, std::string* error) {
  if (!DataSetFromFlags(euroc, error)) return false;
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
bool ReadSequence(const EurocOptions& euroc, ImageSequence* sequence, std::string* error) {
  if (IsKitti() ? !ReadKittiSequence(FLAGS_kitti_root, FLAGS_sequence, sequence, error)
                : !ReadEurocSequence(FLAGS_euroc_root, euroc, sequence, error)) {
    return false;
  }
  for (const std::string& note : sequence->notes) std::cerr << note << "\n";
  if (std::none_of(sequence->frames.begin(), sequence->frames.end(),
                   [](const ImageFrame& frame) { return frame.world_from_body.has_value(); })) {
    std::cerr << "sequence " << PrintablePath(sequence->name)
              << " has no ground truth: the files get no truth and no gravity\n";
  }
  return true;
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
  EurocOptions euroc;
  ImageSequence sequence;
  std::string error;
  if (!SettingsFromFlags(&options, &euroc, &error)) return UsageError(error);
  // Pairs run beside each other; threads of OpenCV within one would only be in their way. What
  // OpenCV logs is said in the program's own words.
  cv::setNumThreads(1);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  if (!ReadSequence(euroc, &sequence, &error)) return Failure(error);
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
  return ExitCode(summary.errors.empty() && summary.missing.empty());
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
