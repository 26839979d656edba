#include "rigel/tools/estimation_flags.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <map>
#include <sstream>

#include <gflags/gflags.h>

#include "rigel/core/angles.h"
#include "rigel/core/body_axes.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/message_groups.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/solver_choice.h"
#include "rigel/tools/tool.h"

DEFINE_string(
    matches, "",
    "match files (*.matches, *.matches.gz) and directories of them, comma separated; - is stdin; a "
    "comma in a path cannot be passed");
DEFINE_string(use, "all",
              "which matches are used: all, intra (same camera at both times) or inter");
DEFINE_string(
    prior, "file",
    "where the motion prior comes from: file, its lines; body, gravity, axis and normal are "
    "the body's down, see --down (no sensor at all); truth, exact, from the truth line");
DEFINE_string(
    down, "",
    "which way is down in the body frame: +x, -x, +y, -y, +z, -z or three numbers x,y,z; if empty "
    "the body axis nearest to the mean of the cameras' down directions, which is told");
DEFINE_string(
    forward, "",
    "which way the vehicle's front is in the body frame, for 2pt-ackermann and the error of "
    "--prior_noise_axis=roll: as --down; if empty the files' 'forward' line, else as the cameras "
    "look if they agree, else +x where -z is down, +z where +y is down");
DEFINE_double(prior_noise_deg, 0,
              "error of exactly that angle on the prior, its sign random per pair");
DEFINE_string(prior_noise_axis, "pitch",
              "the error turns about: pitch (the body's right), roll (its forward) or random");
DEFINE_double(prior_sigma_deg, 0,
              "the prior's stated 1-sigma for --use_prior_in_refine; 0: as in the file");
DEFINE_bool(use_prior_in_refine, false, "weigh the prior by its sigma in the refinement");
DEFINE_string(
    refine, "full",
    "what the refinement frees: none (no refinement; what is observable is then not known), full "
    "(rotation and translation), prior "
    "(the prior is exact), depths (a reference match is exact), prior-depths (both), bundle (full "
    "and the points: reprojection errors)");
DEFINE_bool(fix_translation_norm, false,
            "hold |t| at the file's distance, with --prior=truth at the true one");
DEFINE_bool(estimate_noise, false,
            "estimate the image noise from the residuals even where the file states it");
DEFINE_string(residual, "sampson",
              "sampson (pixels), angular, or algebraic (for comparison: not robust, and with "
              "intra-camera matches and a free scale it collapses to zero motion)");
DEFINE_string(loss, "cauchy",
              "robust loss of the refinement: none, huber, cauchy, tukey, truncated");
DEFINE_string(threshold_px, "auto",
              "inlier threshold on the Sampson error; 3 sigma of the noise is best. auto: 1.5, or "
              "1/300 of the shortest focal length where that is less");
DEFINE_double(confidence, 0.9999,
              "RANSAC stops when a sample of inliers was drawn with this probability");
DEFINE_int32(max_iterations, 10000, "largest number of RANSAC iterations");
DEFINE_double(time_limit_ms, 0,
              "a pair's estimate ends after so long with the best motion found by then; its status "
              "says so (0: no limit)");
DEFINE_uint64(seed, 1, "seed of all random numbers; the same seed gives the same result");
DEFINE_int32(threads, 1, "frame pairs estimated at the same time; the results do not depend on it");
DEFINE_string(shard, "",
              "i/n: only the i-th of n equal parts of the files, i from 0; each pair's result is "
              "that of the whole");
DEFINE_bool(no_times, false,
            "leave the times out of the results, which are then the same in every run");

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

const std::optional<double>& SigmaOf(const MotionPrior& prior, PriorKind kind) {
  if (kind == PriorKind::kVertical) return prior.gravity_sigma;
  return kind == PriorKind::kPlanar ? prior.normal_sigma : prior.axis_sigma;
}

}  // namespace

bool OptionsFromFlags(ComparisonOptions* options, std::string* error) {
  const auto wrong = [error](const std::string& flag, const std::string& value,
                             const std::string& expected) {
    *error = "--" + flag + "=" + value + ": expected " + expected;
    return false;
  };
  EstimateOptions& estimate = options->estimate;
  if (FLAGS_matches.empty()) {
    *error = "--matches is missing: name match files or directories";
    return false;
  }
  const std::vector<std::string> items = SplitCommas(FLAGS_matches);
  if (std::count(items.begin(), items.end(), "-") > 1) {
    return wrong("matches", FLAGS_matches, "'-' once: stdin can be read but once");
  }
  if (!ParseMatchUse(FLAGS_use, &options->use)) {
    return wrong("use", FLAGS_use, "all, intra or inter");
  }
  if (!ParsePriorSource(FLAGS_prior, &options->prior.source)) {
    return wrong("prior", FLAGS_prior, "file, body or truth");
  }
  if (!ParsePriorNoiseAxis(FLAGS_prior_noise_axis, &options->prior.noise_axis)) {
    return wrong("prior_noise_axis", FLAGS_prior_noise_axis, "pitch, roll or random");
  }
  const auto direction = [&](const std::string& flag, const std::string& value,
                             std::optional<Eigen::Vector3d>* stated) {
    if (value.empty()) return true;
    Eigen::Vector3d read;
    if (!ParseDirection(value, &read)) {
      return wrong(flag, value, "+x, -x, +y, -y, +z, -z or three numbers x,y,z");
    }
    *stated = read;
    return true;
  };
  BodyAxes axes;
  if (!direction("down", FLAGS_down, &options->prior.down) ||
      !direction("forward", FLAGS_forward, &options->prior.forward)) {
    return false;
  }
  if (!ResolveBodyAxes(Rig(), options->prior.down, options->prior.forward, &axes, error)) {
    *error = "--down and --forward: " + *error;
    return false;
  }
  if (!std::isfinite(FLAGS_prior_noise_deg) || std::abs(FLAGS_prior_noise_deg) > 180) {
    return wrong("prior_noise_deg", Text(FLAGS_prior_noise_deg), "-180 to 180");
  }
  if (!(FLAGS_prior_sigma_deg >= 0) || !std::isfinite(FLAGS_prior_sigma_deg)) {
    return wrong("prior_sigma_deg", Text(FLAGS_prior_sigma_deg), "a number from 0");
  }
  options->prior.noise = DegToRad(FLAGS_prior_noise_deg);
  if (FLAGS_prior_sigma_deg > 0) options->prior.sigma = DegToRad(FLAGS_prior_sigma_deg);
  options->prior.seed = FLAGS_seed;

  estimate.refine_motion = FLAGS_refine != "none";
  if (estimate.refine_motion && !ParseRefineForm(FLAGS_refine, &estimate.refine.form)) {
    return wrong("refine", FLAGS_refine, "none, full, prior, depths, prior-depths or bundle");
  }
  if (!ParseResidual(FLAGS_residual, &estimate.refine.residual)) {
    return wrong("residual", FLAGS_residual, "sampson, angular or algebraic");
  }
  if (!ParseLoss(FLAGS_loss, &estimate.refine.loss)) {
    return wrong("loss", FLAGS_loss, "none, huber, cauchy, tukey or truncated");
  }
  if (!estimate.refine_motion &&
      (FLAGS_fix_translation_norm || FLAGS_use_prior_in_refine || FLAGS_estimate_noise ||
       FLAGS_loss != "cauchy" || FLAGS_residual != "sampson")) {
    *error =
        "--loss, --residual, --fix_translation_norm, --use_prior_in_refine and --estimate_noise "
        "are of the refinement, which --refine=none leaves out";
    return false;
  }
  if (estimate.refine.residual == ResidualKind::kAlgebraic && FLAGS_loss != "cauchy") {
    *error = "--loss=" + FLAGS_loss + ": the algebraic residual is in metres and takes no loss";
    return false;
  }
  if (estimate.refine_motion && estimate.refine.form == RefineForm::kBundle &&
      estimate.refine.residual != ResidualKind::kSampson) {
    *error = "--residual=" + FLAGS_residual + ": --refine=bundle has reprojection errors";
    return false;
  }
  estimate.refine.use_prior = FLAGS_use_prior_in_refine;
  estimate.refine.scale = FLAGS_fix_translation_norm ? ScaleMode::kFixed : ScaleMode::kAuto;
  options->prior.true_distance = FLAGS_fix_translation_norm;
  options->use_stated_noise = !FLAGS_estimate_noise;
  if (FLAGS_threshold_px == "auto") {
    estimate.ransac.threshold_px = kAutoThresholdPx;
  } else if (!ParsePositive(FLAGS_threshold_px, &estimate.ransac.threshold_px)) {
    return wrong("threshold_px", FLAGS_threshold_px, "auto or a positive number");
  }
  estimate.ransac.confidence = FLAGS_confidence;
  estimate.ransac.max_iterations = FLAGS_max_iterations;
  estimate.ransac.seed = FLAGS_seed;
  if (!estimate.ransac.IsValid(error)) {
    *error = "--" + *error;
    return false;
  }
  if (!(FLAGS_time_limit_ms >= 0) || !std::isfinite(FLAGS_time_limit_ms)) {
    return wrong("time_limit_ms", Text(FLAGS_time_limit_ms), "a number from 0");
  }
  if (FLAGS_time_limit_ms > 0) estimate.time_limit = 1e-3 * FLAGS_time_limit_ms;
  if (FLAGS_threads < 1 || FLAGS_threads > 1024) {
    return wrong("threads", std::to_string(FLAGS_threads), "1 to 1024");
  }
  options->num_threads = FLAGS_threads;
  Shard shard;
  if (!FLAGS_shard.empty() && !ParseShard(FLAGS_shard, &shard)) {
    return wrong("shard", FLAGS_shard, "i/n with i from 0 to n - 1");
  }
  return true;
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

InputFiles ListInput() {
  InputFiles input;
  std::vector<std::string> errors, notes;
  input.paths = ListMatchFiles(FLAGS_matches, &errors, &notes);
  input.all_there = errors.empty();
  for (const std::string& note : notes) std::cerr << note << "\n";
  for (const std::string& error : errors) std::cerr << error << "\n";
  input.all = input.paths;
  input.total = static_cast<int>(input.all.size());
  if (input.total == 0) std::cerr << "nothing to read in " << PrintablePath(FLAGS_matches) << "\n";
  Shard shard;
  if (ParseShard(FLAGS_shard, &shard)) {
    const auto [begin, end] = shard.Range(input.total);
    input.paths = {input.paths.begin() + begin, input.paths.begin() + end};
    input.first = begin;
    input.shard = shard;
  }
  return input;
}

std::vector<std::string> OutputFlags() { return {"csv", "json", "no_times", "shard", "threads"}; }

std::function<void(const RefineProgress&)> ShowRefinement(Progress* progress) {
  return [progress](const RefineProgress& at) {
    progress->Note([&] {
      return "refinement, round " + std::to_string(at.round) + ", iteration " +
             std::to_string(at.iteration) + ", cost " + Text(at.cost);
    });
  };
}

bool TimesAreGiven() { return !FLAGS_no_times; }

void ReportDoubts(const std::string& solver, const std::vector<DoubtedMotion>& motions) {
  if (solver == kAutoSolver) return;
  int count = 0;
  const DoubtedMotion* first = nullptr;
  for (const DoubtedMotion& motion : motions) {
    if (motion.doubt.empty()) continue;
    ++count;
    if (first == nullptr) first = &motion;
  }
  if (count == 0) return;
  const bool prior = FindSolver(solver)->prior != PriorKind::kNone;
  std::cerr << "doubtful: " << solver << ": " << count << " of " << motions.size()
            << (motions.size() == 1 ? " motion, " : " motions, ")
            << (count == 1 ? "" : "the first ") << PrintablePath(first->pair) << ": "
            << first->doubt << "; "
            << (prior ? "is the prior right (--solver=auto does without it where it is not), or "
                        "are many of the matches outliers?"
                      : "are most of the matches outliers?")
            << "\n";
}

void ReportUnweighedPriors(const ComparisonOptions& options,
                           const std::vector<std::string>& solvers,
                           const std::vector<FramePair>& pairs) {
  if (!options.estimate.refine.use_prior || !options.estimate.refine_motion) return;
  std::vector<PriorKind> kinds;
  for (const std::string& name : solvers) {
    if (name == kAutoSolver) {
      kinds.insert(kinds.end(), {PriorKind::kPlanar, PriorKind::kVertical, PriorKind::kAxis});
    }
    const SolverInfo* info = FindSolver(name);
    if (info != nullptr && info->prior != PriorKind::kNone) kinds.push_back(info->prior);
  }
  if (kinds.empty()) {
    std::cerr << "--use_prior_in_refine: no prior is weighed, the solver uses none\n";
    return;
  }
  // A pair without the prior itself fails, with a message of its own.
  const auto unweighed = [&](const FramePair& pair) {
    return std::any_of(kinds.begin(), kinds.end(), [&](PriorKind kind) {
      return HasPrior(pair.prior, kind) && !SigmaOf(pair.prior, kind).has_value();
    });
  };
  const auto count = std::count_if(pairs.begin(), pairs.end(), unweighed);
  if (count == 0) return;
  std::cerr << "--use_prior_in_refine: no sigma of the prior is stated in " << count << " of "
            << pairs.size() << " pairs, it is not weighed there; state --prior_sigma_deg\n";
}

void ReportSuggestedAxes(const ComparisonOptions& options, const std::vector<std::string>& solvers,
                         const std::vector<AppliedAxes>& applied) {
  // More than a camera is tilted on a vehicle.
  constexpr double kFarOffDeg = 25.0;
  const bool uses_forward =
      std::count(solvers.begin(), solvers.end(), "2pt-ackermann") > 0 ||
      (options.prior.noise != 0.0 && options.prior.noise_axis != PriorNoiseAxis::kRandom);
  std::map<std::string, int> counts;
  double off_deg = 0.0;
  for (const AppliedAxes& pair : applied) {
    std::string text;
    if (pair.down_suggested) {
      text = "--down=" + DirectionText(pair.axes.down);
      off_deg = std::max(off_deg, RadToDeg(pair.cameras_off_down));
    }
    if (pair.forward_suggested && uses_forward) {
      text += (text.empty() ? "--forward=" : " --forward=") + DirectionText(pair.axes.forward);
    }
    if (!text.empty()) ++counts[text];
  }
  if (counts.empty()) return;
  std::string line;
  for (const auto& [text, count] : counts) {
    line += (line.empty() ? "" : ", ") + text;
    if (counts.size() > 1)
      line += " in " + std::to_string(count) + (count == 1 ? " file" : " files");
  }
  line += counts.size() > 1 ? ": taken from the cameras of the rigs"
                            : ": taken from the cameras of the rig";
  if (off_deg > kFarOffDeg) {
    line += ", whose mean down is " + std::to_string(static_cast<int>(std::lround(off_deg))) +
            " degrees off it; state it if it is another";
  }
  std::cerr << line << "\n";
}

void ReportGrouped(const std::vector<std::string>& messages,
                   const std::vector<std::string>& files) {
  for (const std::string& line : GroupMessages(messages, files)) std::cerr << line << "\n";
}

std::string FailureMessage(const FramePair& pair, const std::string& solver,
                           const std::string& message) {
  // Some messages name the solver themselves.
  const bool named = message.find(solver) != std::string::npos;
  std::string text = PrintablePath(pair.name) + ": " + (named ? "" : solver + ": ") + message;
  const SolverInfo* info = FindSolver(solver);
  if (info != nullptr && !HasPrior(pair.prior, info->prior)) {
    const std::string lines = info->prior == PriorKind::kVertical
                                  ? "'gravity1' and 'gravity2' lines"
                              : info->prior == PriorKind::kPlanar ? "a 'normal' line"
                                                                  : "an 'axis' line";
    text += "; add " + lines + " to the file, or use --prior=body or the solver auto";
  }
  return text;
}

}  // namespace rigel
