// rigel_simulate: match files of the synthetic scene.
#include <atomic>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <gflags/gflags.h>

#include "rigel/core/parallel.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/problems/scenes/driven_motion.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/tools/output_directory.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/tool.h"

DEFINE_string(
    output, "",
    "directory for the match files 000000.matches, ...; created if missing. It must not hold "
    "other match files");
DEFINE_int32(pairs, 50, "number of frame pairs, one per file");
DEFINE_int32(num_cameras, 2, "number of cameras of the rig: 1 to 4, with --ring 1 to 16");
DEFINE_bool(
    ring, false,
    "place the cameras on a circle of 1 m radius around the vertical axis of the body, at equal "
    "angles, looking outwards. Matches between cameras are between neighbours, whose fields of "
    "view overlap from 5 cameras on");
DEFINE_int32(num_matches, 200, "number of matches per pair");
DEFINE_double(noise_px, 0.5,
              "standard deviation of the image noise, pixels, on each coordinate in both views");
DEFINE_double(rotation_deg, 1, "rotation angle of each pair, degrees");
DEFINE_string(rotation_axis, "y", "rotation axis: y (Y of the body) or random");
DEFINE_string(motion, "forward",
              "direction of translation: forward, random, sideways or planar; |t| is 1 m");
DEFINE_double(inter_share, 0, "share of matches between different cameras, 0 to 1");
DEFINE_double(outlier_share, 0,
              "share of outliers, 0 to 1: their second point is uniform in the image");
DEFINE_double(
    moving_share, 0,
    "share of matches on a car that moves by itself, 0 to 1; it moves 0.5 to 2 m. These are not "
    "counted as outliers");
DEFINE_bool(
    match_scores, false,
    "write match scores like Lowe's ratio, lower for inliers than for outliers. Off: all scores "
    "are 0");
DEFINE_uint64(seed, 1, "seed of the random numbers. The same seed gives the same files");
DEFINE_string(
    poses, "",
    "directory of KITTI odometry poses (00.txt, ...): one pair per two consecutive frames, with "
    "their motion. Replaces --pairs, --motion, --rotation_deg and --rotation_axis");
DEFINE_int32(every, 1, "with --poses: take every n-th pair of consecutive frames");
DEFINE_int32(threads, 1, "number of threads, 1 to 1024. The files do not depend on it");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_simulate: makes match files of a synthetic scene with known motion.\n"
    "\n"
    "  rigel_simulate --output=DIR --pairs=50 --motion=random --outlier_share=0.3\n"
    "\n"
    "The rig has two cameras that look forward, 1 m apart (640 x 480 pixels, focal length 400\n"
    "pixels), each moved by N(0, 0.05 m) and rotated by N(0, 0.1 rad) per axis. A third and a\n"
    "fourth camera are above and below them. Points are uniform in the image of view 1, at 5 to\n"
    "30 m. The files hold the true motion, the image noise and the exact gravity and axis, for\n"
    "planar motion also the normal.\n"
    "\n"
    "  rigel_simulate --output=DIR --ring --num_cameras=8 --rotation_deg=10\n"
    "\n"
    "A rig that looks all around.\n"
    "\n"
    "  rigel_simulate --output=DIR --motion=random --moving_share=0.3\n"
    "\n"
    "With a car, a box 5 to 15 m in front of the rig, that moves over the ground and turns by up\n"
    "to 3 degrees between the frames. Its matches agree on a motion that is not that of the rig.\n"
    "\n"
    "  rigel_simulate --output=DIR --poses=KITTI/poses --num_matches=300\n"
    "\n"
    "The same rig and points with the motions of recorded drives. The body is KITTI's left\n"
    "camera, the sequence is the name of the file with the poses, and gravity is the vertical of\n"
    "the first frame of the sequence.\n";

std::string FileName(int k) {
  char name[32];
  std::snprintf(name, sizeof(name), "%06d.matches", k);
  return name;
}

bool IsOwn(const std::string& name, int num_pairs) {
  int k = -1;
  std::from_chars(name.data(), name.data() + name.size(), k);
  return k >= 0 && k < num_pairs && name == FileName(k);
}

// The lesser of the two, whatever other threads do.
void LowerTo(int k, std::atomic<int>* least) {
  for (int now = *least; k < now && !least->compare_exchange_weak(now, k);) {
  }
}

// Makes and writes all files. The message of the first that failed, in their order; empty if none
// did. After a failure no more are begun.
std::string WriteFiles(const SceneOptions& options, const std::vector<DrivenMotion>& motions,
                       int num_pairs) {
  Progress progress(ProgramName(), num_pairs);
  std::vector<std::string> errors(num_pairs);
  std::atomic<int> failed{num_pairs};  // the first
  ParallelFor(num_pairs, FLAGS_threads, [&](int k) {
    if (k > failed) return;
    const std::string path = (std::filesystem::path(FLAGS_output) / FileName(k)).string();
    FramePair pair;
    std::string error;
    const bool made = motions.empty() ? MakeScenePair(options, k, &pair, &error)
                                      : MakeDrivenPair(options, k, motions[k], &pair, &error);
    if (!made) {
      errors[k] = PrintablePath(path) + ": " + error;
    } else if (!WriteMatchFile(path, pair, &error)) {
      errors[k] = error;
    }
    if (!errors[k].empty()) LowerTo(k, &failed);
    progress.Step();
  });
  return failed < num_pairs ? errors[failed] : "";
}

bool SceneFromFlags(SceneOptions* options, std::string* error) {
  if (!ParseMotionPattern(FLAGS_motion, &options->motion)) {
    return WrongValue("motion", FLAGS_motion, "forward, random, sideways or planar", error);
  }
  if (!ParseRotationAxisPattern(FLAGS_rotation_axis, &options->rotation_axis)) {
    return WrongValue("rotation_axis", FLAGS_rotation_axis, "y or random", error);
  }
  options->num_cameras = FLAGS_num_cameras;
  options->ring = FLAGS_ring;
  options->num_matches = FLAGS_num_matches;
  options->noise_px = FLAGS_noise_px;
  options->rotation_deg = FLAGS_rotation_deg;
  options->inter_share = FLAGS_inter_share;
  options->outlier_share = FLAGS_outlier_share;
  options->moving_share = FLAGS_moving_share;
  options->match_scores = FLAGS_match_scores;
  options->seed = FLAGS_seed;
  if (options->IsValid(error)) return true;
  *error = "--" + *error;
  return false;
}

bool SettingsFromFlags(SceneOptions* options, std::string* error) {
  if (FLAGS_output.empty()) return Refuse("--output is missing: name a directory", error);
  if (FLAGS_pairs < 1) return Refuse("--pairs: expected at least 1", error);
  if (!SceneFromFlags(options, error)) return false;
  if (FLAGS_every < 1) return Refuse("--every: expected at least 1", error);
  if (!CheckThreads(FLAGS_threads, 1, error)) return false;
  const std::string flag = FirstGiven({"pairs", "motion", "rotation_deg", "rotation_axis"});
  if (!FLAGS_poses.empty() && !flag.empty()) {
    return Refuse("--" + flag + ": the motions are those of --poses", error);
  }
  if (FLAGS_poses.empty() && IsGiven("every")) {
    return Refuse("--every: there are no recorded motions without --poses", error);
  }
  return true;
}

// False with a message if other match files are in the directory, or it cannot be made.
bool PrepareOutput(int num_pairs, std::string* error) {
  const auto is_own = [&](const std::string& name) { return IsOwn(name, num_pairs); };
  if (!MakeDirectory(FLAGS_output, error) || !HoldsNoOtherMatchFiles(FLAGS_output, is_own, error)) {
    return false;
  }
  RemoveLeftOvers(FLAGS_output, [](const std::string& name) {
    return std::filesystem::path(name).extension() == ".matches";
  });
  return true;
}

int Run() {
  SceneOptions options;
  std::vector<DrivenMotion> motions;
  std::string error;
  if (!SettingsFromFlags(&options, &error)) return UsageError(error);
  if (!FLAGS_poses.empty() && !ReadDrivenMotions(FLAGS_poses, FLAGS_every, &motions, &error)) {
    return Failure(error);
  }
  const int num_pairs = motions.empty() ? FLAGS_pairs : static_cast<int>(motions.size());
  if (!PrepareOutput(num_pairs, &error)) return Failure(error);

  error = WriteFiles(options, motions, num_pairs);
  if (!error.empty()) return Failure(error);
  std::cerr << "wrote " << num_pairs << " match files to " << PrintablePath(FLAGS_output) << "\n";
  return kExitDone;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
