#include "rigel/problems/experiments/experiment_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigel/core/angles.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/prior_source.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {
namespace {

// Pixels, 1 sigma: the paper's noise where another variable is studied.
constexpr double kDefaultNoisePx = 0.5;
// Matches of a pair with the motion of a drive, and the share of outliers: both as in the
// catalogue's description of kitti-motions.
constexpr int kDrivenMatches = 300;
constexpr double kDrivenOutliers = 0.2;

// Motion pattern of a point; a random planar motion stays in the plane.
MotionPattern PatternOf(const ExperimentSpec& spec, const std::string& motion) {
  MotionPattern pattern = MotionPattern::kRandom;
  ParseMotionPattern(motion, &pattern);
  return spec.planar && pattern == MotionPattern::kRandom ? MotionPattern::kPlanar : pattern;
}

// 1-sigma image noise at a point.
double NoiseAt(const ExperimentSpec& spec, const ExperimentPoint& point) {
  return spec.variable == ExperimentVariable::kImageNoise ? *point.x : kDefaultNoisePx;
}

bool MakeDriven(const ExperimentPlan& plan, const ExperimentPoint& point, int index,
                FramePair* pair, std::string* error) {
  SceneOptions scene;
  scene.num_matches = kDrivenMatches;
  scene.outlier_share = kDrivenOutliers;
  scene.seed = plan.options.seed;
  const auto first =
      std::find_if(plan.driven.begin(), plan.driven.end(),
                   [&](const DrivenMotion& m) { return m.sequence == point.sequence; });
  // A pair's random numbers are those of its place among all motions, thinned or not.
  const int k = static_cast<int>(first - plan.driven.begin()) + index * plan.options.every;
  PriorSourceOptions prior;
  prior.source = PriorSource::kTruth;
  return MakeDrivenPair(scene, k, plan.driven[k], pair, error) &&
         ApplyPriorSource(prior, k, pair, error);
}

}  // namespace

ExperimentOptions WithDefaults(ExperimentOptions options) {
  if (options.pairs == 0) options.pairs = options.quick ? kQuickPairs : kFullPairs;
  if (options.every == 0) options.every = options.quick ? kQuickEvery : kEvery;
  return options;
}

bool PlanExperiment(const ExperimentSpec& spec, const ExperimentOptions& options,
                    ExperimentPlan* plan, std::string* error) {
  ExperimentPlan result;
  result.spec = &spec;
  result.options = WithDefaults(options);
  if (spec.variable == ExperimentVariable::kNone) {
    if (!ReadDrivenMotions(options.poses, 1, &result.driven, error)) return false;
    for (const DrivenMotion& motion : result.driven) {
      if (result.points.empty() || result.points.back().sequence != motion.sequence) {
        result.points.push_back({spec.motions.front(), motion.sequence, std::nullopt});
      }
    }
  }
  for (const std::string& motion : spec.motions) {
    for (const double x : options.quick ? spec.quick_values : spec.values) {
      result.points.push_back({motion, "", x});
    }
  }
  *plan = std::move(result);
  return true;
}

int CountPairs(const ExperimentPlan& plan, const ExperimentPoint& point) {
  if (plan.spec->variable != ExperimentVariable::kNone) return plan.options.pairs;
  const auto motions =
      std::count_if(plan.driven.begin(), plan.driven.end(),
                    [&](const DrivenMotion& m) { return m.sequence == point.sequence; });
  return (static_cast<int>(motions) + plan.options.every - 1) / plan.options.every;
}

bool MakeExperimentPair(const ExperimentPlan& plan, const ExperimentPoint& point, int index,
                        FramePair* pair, std::string* error) {
  const ExperimentSpec& spec = *plan.spec;
  if (spec.variable == ExperimentVariable::kNone) {
    return MakeDriven(plan, point, index, pair, error);
  }
  const double x = *point.x;
  SceneOptions scene;
  scene.motion = PatternOf(spec, point.motion);
  // About body Y the axis and the vertical would be the same prior.
  if (!spec.planar) scene.rotation_axis = RotationAxisPattern::kRandom;
  scene.noise_px = NoiseAt(spec, point);
  scene.seed = plan.options.seed;
  PriorSourceOptions prior;
  prior.seed = plan.options.seed;
  switch (spec.variable) {
    case ExperimentVariable::kPitch:
    case ExperimentVariable::kRoll:
      prior.noise = DegToRad(x);
      prior.noise_axis = spec.variable == ExperimentVariable::kPitch ? PriorNoiseAxis::kPitch
                                                                     : PriorNoiseAxis::kRoll;
      break;
    case ExperimentVariable::kRotation:
      scene.rotation_deg = x;
      break;
    case ExperimentVariable::kOutliers:
      scene.outlier_share = x / 100.0;
      break;
    case ExperimentVariable::kMatchCount:
      scene.num_matches = static_cast<int>(std::lround(x));
      break;
    case ExperimentVariable::kInterShare:
      scene.inter_share = x / 100.0;
      break;
    case ExperimentVariable::kImageNoise:
    case ExperimentVariable::kVibration:
    case ExperimentVariable::kNone:
      break;
  }
  if (!MakeScenePair(scene, index, pair, error)) return false;
  if (spec.variable == ExperimentVariable::kVibration) {
    Random random =
        Random::Stream(plan.options.seed ^ 0x736f636b73ULL, static_cast<uint64_t>(index));
    Pose truth = *pair->truth;
    truth.t.y() += x / 100.0 * truth.t.norm() * random.Normal();
    const MotionPrior exact = pair->prior;
    if (!MakeScenePair(scene, index, truth, pair, error)) return false;
    pair->prior = exact;
  }
  // The plane of planar motion that is not of the pattern "planar".
  if (spec.planar) pair->prior.normal = Eigen::Vector3d::UnitY();
  return ApplyPriorSource(prior, index, pair, error);
}

}  // namespace rigel
