#include "rigel/tools/estimation_flags.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <sstream>

#include <gflags/gflags.h>

#include "rigel/core/angles.h"
#include "rigel/core/body_axes.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/solver_choice.h"
#include "rigel/tools/tool.h"

DEFINE_string(
    matches, "",
    "input, comma separated: match files (*.matches, *.matches.gz) and directories of them; - is "
    "stdin. A path cannot contain a comma");
DEFINE_string(
    use, "all",
    "which matches are used: all, intra (both points from the same camera) or inter (from "
    "different cameras)");
DEFINE_string(
    prior, "file",
    "source of the motion prior: file (the lines of the match file), body (no sensor: gravity, "
    "axis and normal all point along --down) or truth (exact, from the truth line)");
DEFINE_string(
    down, "",
    "down direction of the body frame: +x, -x, +y, -y, +z, -z or three numbers x,y,z. If empty: "
    "the body axis nearest to the mean down direction of the cameras, printed to stderr");
DEFINE_string(
    forward, "",
    "forward direction of the body frame, written as --down. Used by the solver 2pt-ackermann "
    "and by --prior_noise_axis=roll. If empty: the file's 'forward' line; without one, the body "
    "axis along which the cameras look; if they look in different directions, +x for a down of "
    "-z and +z for a down of +y");
DEFINE_double(
    prior_noise_deg, 0,
    "error added to the prior, degrees: a rotation by exactly this angle, its sign random per "
    "pair");
DEFINE_string(
    prior_noise_axis, "pitch",
    "axis of the error of --prior_noise_deg: pitch (the body's right), roll (the body's forward) "
    "or random");
DEFINE_double(
    prior_sigma_deg, 0,
    "standard deviation of the prior, degrees, for --use_prior_in_refine. 0: as stated in the "
    "file");
DEFINE_bool(use_prior_in_refine, false,
            "add the prior to the refinement, weighted by its standard deviation");
DEFINE_string(
    refine, "full",
    "parameters of the refinement: none (no refinement: what is observable is then not known), "
    "full (rotation and translation), prior (motions that satisfy the prior exactly), depths "
    "(motions that satisfy one reference match exactly), prior-depths (both) or bundle (motion "
    "and 3D points, with reprojection errors)");
DEFINE_bool(fix_translation_norm, false,
            "hold |t| at the distance that the file states; with --prior=truth at the true |t|");
DEFINE_double(
    typical_length, 1,
    "length of the rig's motion, metres, that is expected where neither the matches nor a "
    "distance in the file say it: the centre of a weak prior, a factor of e either way");
DEFINE_string(
    residual, "sampson",
    "residual of the refinement: sampson (pixels), angular (angle on the viewing sphere times the "
    "mean focal length: pixels at the image centre) or algebraic (metres). "
    "algebraic is for comparison only: it is not robust, and it tends to zero motion if all "
    "matches are intra-camera and the scale is free");
DEFINE_double(calibration_sigma_deg, 0,
              "1-sigma error of the orientation of each camera, degrees per axis. It enters the "
              "stated covariances. Instead of the lines camera_sigma of the files; 0: these");
DEFINE_double(calibration_sigma_m, 0,
              "1-sigma error of the position of each camera, metres per axis, likewise");
DEFINE_string(loss, "tukey",
              "robust loss of the refinement: none, huber, cauchy, tukey or truncated");
DEFINE_string(
    threshold_px, "auto",
    "RANSAC inlier threshold on the Sampson error, pixels. Three standard deviations of the "
    "image noise work best. auto: 1.5, or 1/300 of the shortest focal length if that is less; the "
    "refinement then follows the noise of each camera pair. A number is kept");
DEFINE_double(
    confidence, 0.9999,
    "RANSAC stops when, with this probability, it has drawn a sample without outliers; between 0 "
    "and 1");
DEFINE_int32(max_iterations, 10000, "maximum number of RANSAC iterations");
DEFINE_double(
    time_limit_ms, 0,
    "time limit for each pair, milliseconds; 0: none. At the limit a pair gets the best motion "
    "so far, and its status says so");
DEFINE_uint64(seed, 1, "seed of the random numbers. The same seed gives the same results");
DEFINE_int32(threads, 1, "number of threads, 1 to 1024. Results do not depend on it");
DEFINE_string(
    shard, "",
    "i/n: process only part i of n equal parts of the files, i from 0 to n - 1. Each pair gets "
    "the same result as in a run over all files");
DEFINE_bool(no_times, false,
            "leave run times out of the results, which are then equal in every run");

namespace rigel {
namespace {

// As it was typed, more or less; std::to_string(1e308) has 300 digits.
std::string Text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

// The whole of `text` as a positive finite number.
bool ParsePositive(const std::string& text, double* value) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !(number > 0) ||
      !std::isfinite(number)) {
    return false;
  }
  *value = number;
  return true;
}

bool CheckMatches(std::string* error) {
  if (FLAGS_matches.empty()) {
    return Refuse("--matches is missing: name match files or directories", error);
  }
  const std::vector<std::string> items = SplitCommas(FLAGS_matches);
  if (std::count(items.begin(), items.end(), "-") > 1) {
    return WrongValue("matches", FLAGS_matches, "'-' once: stdin can be read only once", error);
  }
  return true;
}

// An empty value states nothing.
bool ReadDirection(const std::string& flag, const std::string& value,
                   std::optional<Eigen::Vector3d>* stated, std::string* error) {
  if (value.empty()) return true;
  Eigen::Vector3d read;
  if (!ParseDirection(value, &read)) {
    return WrongValue(flag, value, "+x, -x, +y, -y, +z, -z or three numbers x,y,z", error);
  }
  *stated = read;
  return true;
}

bool ReadPriorFlags(PriorSourceOptions* prior, std::string* error) {
  if (!ParsePriorSource(FLAGS_prior, &prior->source)) {
    return WrongValue("prior", FLAGS_prior, "file, body or truth", error);
  }
  if (!ParsePriorNoiseAxis(FLAGS_prior_noise_axis, &prior->noise_axis)) {
    return WrongValue("prior_noise_axis", FLAGS_prior_noise_axis, "pitch, roll or random", error);
  }
  if (!ReadDirection("down", FLAGS_down, &prior->down, error) ||
      !ReadDirection("forward", FLAGS_forward, &prior->forward, error)) {
    return false;
  }
  BodyAxes axes;
  if (!ResolveBodyAxes(Rig(), prior->down, prior->forward, &axes, error)) {
    *error = "--down and --forward: " + *error;
    return false;
  }
  if (!std::isfinite(FLAGS_prior_noise_deg) || std::abs(FLAGS_prior_noise_deg) > 180) {
    return WrongValue("prior_noise_deg", Text(FLAGS_prior_noise_deg), "-180 to 180", error);
  }
  if (!(FLAGS_prior_sigma_deg >= 0) || !std::isfinite(FLAGS_prior_sigma_deg)) {
    return WrongValue("prior_sigma_deg", Text(FLAGS_prior_sigma_deg), "a number from 0", error);
  }
  prior->noise = DegToRad(FLAGS_prior_noise_deg);
  if (FLAGS_prior_sigma_deg > 0) prior->sigma = DegToRad(FLAGS_prior_sigma_deg);
  prior->true_distance = FLAGS_fix_translation_norm;
  prior->seed = FLAGS_seed;
  return true;
}

// What does not go together.
bool CheckRefinement(const EstimateOptions& estimate, std::string* error) {
  if (!estimate.refine_motion &&
      (FLAGS_fix_translation_norm || FLAGS_use_prior_in_refine || FLAGS_typical_length != 1 ||
       FLAGS_calibration_sigma_deg != 0 || FLAGS_calibration_sigma_m != 0 ||
       FLAGS_loss != "tukey" || FLAGS_residual != "sampson")) {
    return Refuse(
        "--loss, --residual, --fix_translation_norm, --use_prior_in_refine, --typical_length and "
        "--calibration_sigma_... have no effect without a refinement (--refine=none)",
        error);
  }
  if (estimate.refine.residual == ResidualKind::kAlgebraic && FLAGS_loss != "tukey") {
    return Refuse(
        "--loss=" + FLAGS_loss + ": the algebraic residual is in metres and takes no loss", error);
  }
  if (estimate.refine_motion && estimate.refine.form == RefineForm::kBundle &&
      estimate.refine.residual != ResidualKind::kSampson) {
    return Refuse("--residual=" + FLAGS_residual + ": --refine=bundle has reprojection errors",
                  error);
  }
  return true;
}

bool ReadRefinementFlags(EstimateOptions* estimate, std::string* error) {
  RefineSettings& refine = estimate->refine;
  estimate->refine_motion = FLAGS_refine != "none";
  if (estimate->refine_motion && !ParseRefineForm(FLAGS_refine, &refine.form)) {
    return WrongValue("refine", FLAGS_refine, "none, full, prior, depths, prior-depths or bundle",
                      error);
  }
  if (!ParseResidual(FLAGS_residual, &refine.residual)) {
    return WrongValue("residual", FLAGS_residual, "sampson, angular or algebraic", error);
  }
  if (!ParseLoss(FLAGS_loss, &refine.loss)) {
    return WrongValue("loss", FLAGS_loss, "none, huber, cauchy, tukey or truncated", error);
  }
  refine.use_prior = FLAGS_use_prior_in_refine;
  refine.hold_distance = FLAGS_fix_translation_norm;
  refine.typical_length = FLAGS_typical_length;
  if (!(refine.typical_length > 0) || !std::isfinite(refine.typical_length)) {
    return WrongValue("typical_length", Text(FLAGS_typical_length), "a positive number", error);
  }
  return CheckRefinement(*estimate, error);
}

bool ReadRansacFlags(RansacOptions* ransac, std::string* error) {
  if (FLAGS_threshold_px == "auto") {
    ransac->threshold_px = kAutoThresholdPx;
  } else if (!ParsePositive(FLAGS_threshold_px, &ransac->threshold_px)) {
    return WrongValue("threshold_px", FLAGS_threshold_px, "auto or a positive number", error);
  }
  ransac->confidence = FLAGS_confidence;
  ransac->max_iterations = FLAGS_max_iterations;
  ransac->seed = FLAGS_seed;
  if (ransac->IsValid(error)) return true;
  *error = "--" + *error;
  return false;
}

}  // namespace

bool OptionsFromFlags(ComparisonOptions* options, std::string* error) {
  if (!CheckMatches(error)) return false;
  if (!ParseMatchUse(FLAGS_use, &options->use)) {
    return WrongValue("use", FLAGS_use, "all, intra or inter", error);
  }
  if (!ReadPriorFlags(&options->prior, error) || !ReadRefinementFlags(&options->estimate, error) ||
      !ReadRansacFlags(&options->estimate.ransac, error)) {
    return false;
  }
  if (!(FLAGS_time_limit_ms >= 0) || !std::isfinite(FLAGS_time_limit_ms)) {
    return WrongValue("time_limit_ms", Text(FLAGS_time_limit_ms), "a number from 0", error);
  }
  for (const auto& [name, value] : {std::pair("calibration_sigma_deg", FLAGS_calibration_sigma_deg),
                                    std::pair("calibration_sigma_m", FLAGS_calibration_sigma_m)}) {
    if (!(value >= 0) || !std::isfinite(value)) {
      return WrongValue(name, Text(value), "a number from 0", error);
    }
  }
  options->calibration_rotation_sigma = DegToRad(FLAGS_calibration_sigma_deg);
  options->calibration_position_sigma = FLAGS_calibration_sigma_m;
  if (FLAGS_time_limit_ms > 0) options->estimate.time_limit = 1e-3 * FLAGS_time_limit_ms;
  if (!CheckThreads(FLAGS_threads, 1, error)) return false;
  options->num_threads = FLAGS_threads;
  Shard shard;
  if (!FLAGS_shard.empty() && !ParseShard(FLAGS_shard, &shard)) {
    return WrongValue("shard", FLAGS_shard, "i/n with i from 0 to n - 1", error);
  }
  return true;
}

bool SolverFromFlag(const std::string& solver, EstimateOptions* estimate, std::string* error) {
  if (!IsSolverName(solver)) {
    return WrongValue("solver", solver, "one of " + SolverNamesWithAuto(), error);
  }
  estimate->solver = solver;
  return CanRefine(*estimate, solver, error);
}

bool CanRefine(const EstimateOptions& estimate, const std::string& solver, std::string* error) {
  EstimateOptions options = estimate;
  options.solver = solver;
  if (options.IsValid(error)) return true;
  const SolverInfo* info = FindSolver(solver);
  if (info != nullptr && info->prior == PriorKind::kNone) {
    *error = "--refine=" + FLAGS_refine + ": " + solver + " has no prior to hold exact";
  }
  return false;
}

bool ReadsStdin() {
  const std::vector<std::string> items = SplitCommas(FLAGS_matches);
  return std::find(items.begin(), items.end(), "-") != items.end();
}

int ListInput(const std::vector<OutputFlag>& outputs, InputFiles* input) {
  std::vector<std::string> errors, notes;
  input->all = ListMatchFiles(FLAGS_matches, &errors, &notes);
  input->all_there = errors.empty();
  for (const std::string& note : notes) std::cerr << note << "\n";
  for (const std::string& error : errors) std::cerr << error << "\n";
  const int total = static_cast<int>(input->all.size());
  if (total == 0) std::cerr << "nothing to read in " << PrintablePath(FLAGS_matches) << "\n";
  Shard shard;
  if (ParseShard(FLAGS_shard, &shard)) input->shard = shard;
  const auto [begin, end] = shard.Range(total);
  input->paths = {input->all.begin() + begin, input->all.begin() + end};
  input->first = begin;
  std::string error;
  if (!OutputsAreNoInputs(outputs, input->all, &error)) return UsageError(error);
  return ExitCode(total > 0);
}

std::vector<std::string> OutputFlags() { return {"csv", "json", "no_times", "shard", "threads"}; }

bool TimesAreGiven() { return !FLAGS_no_times; }

}  // namespace rigel
