// rigel_simulate: match files of synthetic scenes.
#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <gflags/gflags.h>

#include "rigel/core/body_axes.h"
#include "rigel/core/parallel.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/rig_file.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/problems/scenes/driven_motion.h"
#include "rigel/problems/scenes/street.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/tools/output_directory.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/tool.h"

DEFINE_string(
    output, "",
    "directory for the match files 000000.matches, ...; created if missing. It must not hold "
    "other match files");
DEFINE_string(scene, "box", "box, or street: a car on a street, with the cameras of --rig");
DEFINE_string(rig, "",
              "with --scene=street: rig file (JSON, docs/formats.md) of the cameras, of any lens");
DEFINE_double(ground_m, 0.35,
              "with --scene=street: how far the ground is below the body's origin, metres. Without "
              "it that of the rig file, if it says so");
DEFINE_double(distance_m, 1, "with --scene=street: |t| of each pair, metres");
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
DEFINE_string(
    camera_noise_px, "",
    "the same for each camera, separated by commas: 0.2,0.5. Replaces --noise_px. The files have "
    "columns sigma1 and sigma2, and their noise_px is the root mean square");
DEFINE_string(
    noise_model, "gaussian",
    "gaussian, mixture (Gaussian, 80 percent of 0.6 and 20 percent of 3 of the stated deviation), "
    "laplace, or t3 (Student's t with 3 degrees of freedom)");
DEFINE_double(rotation_deg, 1,
              "rotation angle of each pair, degrees. With --scene=street its yaw, the sign random");
DEFINE_string(rotation_axis, "y", "rotation axis: y (Y of the body) or random");
DEFINE_string(motion, "forward",
              "direction of translation: forward, random, sideways or planar; |t| is 1 m. Or turn: "
              "the rotation alone, or still: no motion. With --scene=street car: forward on an arc "
              "(Ackermann), with pitch and roll of N(0, 0.2 degrees); or turn: the yaw alone; or "
              "still");
DEFINE_double(inter_share, 0, "share of matches between different cameras, 0 to 1");
DEFINE_double(outlier_share, 0,
              "share of outliers, 0 to 1: their second point is uniform in the image");
DEFINE_double(
    moving_share, 0,
    "share of matches on a car that moves by itself, 0 to 1; it moves 0.5 to 2 m. These are not "
    "counted as outliers");
DEFINE_double(
    calibration_sigma_deg, 0,
    "1-sigma error of the calibration, degrees: each camera that sees the scene is turned by this "
    "about each axis. The files state the rig without it. The error is the same in all pairs");
DEFINE_double(calibration_sigma_m, 0,
              "the same of the positions of the cameras, metres along each axis");
DEFINE_bool(state_calibration_sigma, false,
            "write a line camera_sigma for each camera, with --calibration_sigma_deg and "
            "--calibration_sigma_m");
DEFINE_string(
    camera_times, "",
    "seconds that each camera fires after the times of its pair, separated by commas. The "
    "files have lines camera_time and time. By default as the rig file says, else 0");
DEFINE_double(interval_s, 0.1, "seconds between the times of a pair, if cameras have other times");
DEFINE_bool(
    match_scores, false,
    "write match scores like Lowe's ratio, lower for inliers than for outliers. Off: all scores "
    "are 0");
DEFINE_uint64(seed, 1, "seed of the random numbers. The same seed gives the same files");
DEFINE_string(poses, "",
              "directory of KITTI odometry poses (00.txt, ...), or one such file: one pair per two "
              "consecutive frames, with their motion. Replaces --pairs, --motion, --rotation_deg, "
              "--rotation_axis and --distance_m");
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
    "planar motion also the normal. Of each match they say whether it is an inlier, and where its\n"
    "points are without noise (columns inlier u0 v0 u20 v20).\n"
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
    "the first frame of the sequence.\n"
    "\n"
    "  rigel_simulate --output=DIR --scene=street --rig=rig.json --rotation_deg=2\n"
    "\n"
    "A car on a street, with any rig: the ground, facades 7 to 13 m to either side and 12 m high,\n"
    "points at 30 to 200 m, and a quarter of the points nearer than these. Each match is seen by\n"
    "its cameras at their times; matches between cameras are of those that share a view. Moving\n"
    "cars are ahead and behind. With --poses the car drives as recorded.\n";

// What is simulated.
struct Simulation {
  bool on_street = false;
  SceneOptions box;
  StreetOptions street;
  std::vector<DrivenMotion> motions;
  int num_pairs = 0;

  SceneMatchOptions* matches() {
    return on_street ? static_cast<SceneMatchOptions*>(&street) : &box;
  }

  bool MakePair(int k, FramePair* pair, std::string* error) const {
    if (motions.empty()) {
      return on_street ? MakeStreetPair(street, k, pair, error)
                       : MakeScenePair(box, k, pair, error);
    }
    return on_street ? MakeDrivenPair(street, k, motions[k], pair, error)
                     : MakeDrivenPair(box, k, motions[k], pair, error);
  }
};

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
std::string WriteFiles(const Simulation& simulation) {
  const int num_pairs = simulation.num_pairs;
  Progress progress(ProgramName(), num_pairs);
  std::vector<std::string> errors(num_pairs);
  std::atomic<int> failed{num_pairs};  // the first
  ParallelFor(num_pairs, FLAGS_threads, [&](int k) {
    if (k > failed) return;
    const std::string path = (std::filesystem::path(FLAGS_output) / FileName(k)).string();
    FramePair pair;
    std::string error;
    if (!simulation.MakePair(k, &pair, &error)) {
      errors[k] = PrintablePath(path) + ": " + error;
    } else if (!WriteMatchFile(path, pair, &error)) {
      errors[k] = error;
    }
    if (!errors[k].empty()) LowerTo(k, &failed);
    progress.Step();
  });
  return failed < num_pairs ? errors[failed] : "";
}

bool NumbersFromFlag(const char* flag, const std::string& text, std::vector<double>* numbers,
                     std::string* error) {
  for (const std::string& word : SplitCommas(text)) {
    double number;
    if (!ParseFinite(word, &number)) {
      return WrongValue(flag, word, "numbers, separated by commas", error);
    }
    numbers->push_back(number);
  }
  return true;
}

bool MatchesFromFlags(SceneMatchOptions* options, std::string* error) {
  if (!NumbersFromFlag("camera_noise_px", FLAGS_camera_noise_px, &options->camera_noise_px,
                       error) ||
      !NumbersFromFlag("camera_times", FLAGS_camera_times, &options->camera_times, error)) {
    return false;
  }
  if (!options->camera_noise_px.empty() && IsGiven("noise_px")) {
    return Refuse("--noise_px: --camera_noise_px replaces it", error);
  }
  if (!ParseNoiseShape(FLAGS_noise_model, &options->noise_model)) {
    return WrongValue("noise_model", FLAGS_noise_model, "gaussian, mixture, laplace or t3", error);
  }
  options->num_matches = FLAGS_num_matches;
  options->noise_px = FLAGS_noise_px;
  options->inter_share = FLAGS_inter_share;
  options->outlier_share = FLAGS_outlier_share;
  options->moving_share = FLAGS_moving_share;
  options->calibration_sigma_deg = FLAGS_calibration_sigma_deg;
  options->calibration_sigma_m = FLAGS_calibration_sigma_m;
  options->state_calibration_sigma = FLAGS_state_calibration_sigma;
  options->interval_s = FLAGS_interval_s;
  options->match_scores = FLAGS_match_scores;
  options->seed = FLAGS_seed;
  return true;
}

bool BoxFromFlags(SceneOptions* options, std::string* error) {
  const std::string flag = FirstGiven({"rig", "ground_m", "distance_m"});
  if (!flag.empty()) return Refuse("--" + flag + ": is of --scene=street", error);
  if (!ParseMotionPattern(FLAGS_motion, &options->motion)) {
    const std::string street = FLAGS_motion == "car" ? ". A car needs --scene=street" : "";
    return WrongValue("motion", FLAGS_motion,
                      "forward, random, sideways, planar, turn or still" + street, error);
  }
  if (!ParseRotationAxisPattern(FLAGS_rotation_axis, &options->rotation_axis)) {
    return WrongValue("rotation_axis", FLAGS_rotation_axis, "y or random", error);
  }
  options->num_cameras = FLAGS_num_cameras;
  options->ring = FLAGS_ring;
  options->rotation_deg = FLAGS_rotation_deg;
  if (options->IsValid(error)) return true;
  *error = "--" + *error;
  return false;
}

// All but what the rig file says.
bool StreetFromFlags(StreetOptions* options, std::string* error) {
  if (FLAGS_rig.empty()) return Refuse("--rig is missing: name a rig file (JSON)", error);
  const std::string flag = FirstGiven({"num_cameras", "ring", "rotation_axis"});
  if (!flag.empty()) return Refuse("--" + flag + ": is of --scene=box", error);
  if (IsGiven("motion") && !ParseStreetMotion(FLAGS_motion, &options->motion)) {
    return WrongValue("motion", FLAGS_motion, "car, turn or still, the motions on the street",
                      error);
  }
  options->ground_m = FLAGS_ground_m;
  options->rotation_deg = FLAGS_rotation_deg;
  options->distance_m = FLAGS_distance_m;
  // As many cameras as these flags have numbers, at least two: the rig is known later.
  const int num_cameras = static_cast<int>(
      std::max({size_t{2}, options->camera_noise_px.size(), options->camera_times.size()}));
  if (options->AreNumbersValid(error) && options->AreMatchesValid(num_cameras, error)) return true;
  *error = "--" + *error;
  return false;
}

// Whether no flag asks for a motion that --motion does not have.
bool MotionFlagsFit(std::string* error) {
  const bool still = FLAGS_motion == "still";
  if (!still && FLAGS_motion != "turn") return true;
  const std::string flag = FirstGiven(still ? std::vector<std::string>{"rotation_deg", "distance_m"}
                                            : std::vector<std::string>{"distance_m"});
  if (flag.empty()) return true;
  return Refuse("--" + flag + ": --motion=" + FLAGS_motion + " has none", error);
}

bool SettingsFromFlags(Simulation* simulation, std::string* error) {
  if (FLAGS_output.empty()) return Refuse("--output is missing: name a directory", error);
  if (FLAGS_pairs < 1) return Refuse("--pairs: expected at least 1", error);
  if (FLAGS_scene != "box" && FLAGS_scene != "street") {
    return WrongValue("scene", FLAGS_scene, "box or street", error);
  }
  simulation->on_street = FLAGS_scene == "street";
  if (!MatchesFromFlags(simulation->matches(), error)) return false;
  if (simulation->on_street ? !StreetFromFlags(&simulation->street, error)
                            : !BoxFromFlags(&simulation->box, error)) {
    return false;
  }
  if (!MotionFlagsFit(error)) return false;
  if (FLAGS_every < 1) return Refuse("--every: expected at least 1", error);
  if (!CheckThreads(FLAGS_threads, 1, error)) return false;
  const std::string flag =
      FirstGiven({"pairs", "motion", "rotation_deg", "rotation_axis", "distance_m"});
  if (!FLAGS_poses.empty() && !flag.empty()) {
    return Refuse("--" + flag + ": the motions are those of --poses", error);
  }
  if (FLAGS_poses.empty() && IsGiven("every")) {
    return Refuse("--every: there are no recorded motions without --poses", error);
  }
  return true;
}

// Takes the rig of the file, its axes and its ground. False with a message if it cannot be read.
bool TakeRig(StreetOptions* street, std::string* error) {
  RigFile file;
  if (!ReadRigFile(FLAGS_rig, &file, error)) return false;
  if (!ResolveBodyAxes(file.rig, file.down, file.forward, &street->axes, error)) {
    *error = PrintablePath(FLAGS_rig) + ": " + *error;
    return false;
  }
  street->rig = file.rig;
  if (file.ground_m && !IsGiven("ground_m")) street->ground_m = *file.ground_m;
  if (!file.down || !file.forward) {
    std::cerr << PrintablePath(FLAGS_rig) << ": taken from the cameras: down "
              << DirectionText(street->axes.down) << ", forward "
              << DirectionText(street->axes.forward) << "\n";
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
  Simulation simulation;
  std::string error;
  if (!SettingsFromFlags(&simulation, &error)) return UsageError(error);
  if (simulation.on_street) {
    if (!TakeRig(&simulation.street, &error)) return Failure(error);
    if (!simulation.street.IsValid(&error)) return UsageError("--" + error);
  }
  std::vector<DrivenMotion>& motions = simulation.motions;
  if (!FLAGS_poses.empty() && !ReadDrivenMotions(FLAGS_poses, FLAGS_every, &motions, &error)) {
    return Failure(error);
  }
  simulation.num_pairs = motions.empty() ? FLAGS_pairs : static_cast<int>(motions.size());
  if (!PrepareOutput(simulation.num_pairs, &error)) return Failure(error);

  error = WriteFiles(simulation);
  if (!error.empty()) return Failure(error);
  std::cerr << "wrote " << simulation.num_pairs << " match files to " << PrintablePath(FLAGS_output)
            << "\n";
  return kExitDone;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
