#include "rigel/tools/estimation_messages.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <sstream>

#include "rigel/core/angles.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/message_groups.h"
#include "rigel/refine/solver_choice.h"

namespace rigel {
namespace {

const std::optional<double>& SigmaOf(const MotionPrior& prior, PriorKind kind) {
  if (kind == PriorKind::kVertical) return prior.gravity_sigma;
  return kind == PriorKind::kPlanar ? prior.normal_sigma : prior.axis_sigma;
}

}  // namespace

std::function<void(const RefineProgress&)> ShowRefinement(Progress* progress) {
  return [progress](const RefineProgress& at) {
    progress->Note([&] {
      std::ostringstream cost;
      cost << at.cost;
      return "refinement, round " + std::to_string(at.round) + ", iteration " +
             std::to_string(at.iteration) + ", cost " + cost.str();
    });
  };
}

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
            << (prior
                    ? "check the prior (--solver=auto drops a wrong one) and the share of outliers"
                    : "check the share of outliers")
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
    std::cerr << "--use_prior_in_refine: has no effect, the solver uses no prior\n";
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
  std::cerr << "--use_prior_in_refine: the prior has no standard deviation in " << count << " of "
            << pairs.size() << " pairs and is not used there; set --prior_sigma_deg\n";
}

void ReportSuggestedAxes(const ComparisonOptions& options, const std::vector<std::string>& solvers,
                         const std::vector<AppliedAxes>& applied) {
  // Degrees: more than a camera is tilted on a vehicle.
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
            " degrees from it; set --down if this is wrong";
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
