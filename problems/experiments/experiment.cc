#include "rigel/problems/experiments/experiment.h"

#include <algorithm>
#include <cmath>

#include "rigel/core/angles.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {
namespace {

using Names = std::vector<std::string>;
using Values = std::vector<double>;

const Names kMotions = {"forward", "random", "sideways"};
const Names kRandomMotion = {"random"};

std::vector<ExperimentSpec> MakeCatalogue() {
  const Names general = {"17pt-li", "6pt-stewenius", "6pt-ventura",    "4pt-lee",
                         "4pt-liu", "4pt-approx",    "4pt-axis-approx"};
  const Names planar = {"17pt-li", "6pt-stewenius", "2pt-choi", "3pt-approx"};
  // Beyond the paper 6pt-stewenius, 0.3 ms a sample, would take most of the time.
  const Names outliers = {"17pt-li", "4pt-lee", "4pt-liu", "4pt", "4pt-approx", "4pt-axis-approx"};
  const Names angles = {"4pt-lee",
                        "4pt-liu",
                        "4pt-approx",
                        "4pt-approx-polished",
                        "4pt",
                        "4pt-axis-approx",
                        "4pt-axis-approx-polished"};
  const Names counts = {"17pt-li", "6pt-ventura", "4pt-lee",
                        "4pt-liu", "4pt-approx",  "4pt-axis-approx"};
  const Names scale = {"17pt-li", "6pt-ventura", "5pt+1",          "4pt-lee",
                       "4pt-liu", "4pt-approx",  "4pt-axis-approx"};
  const Names kitti = {"17pt-li", "6pt-stewenius", "6pt-ventura",     "4pt-lee",
                       "4pt-liu", "4pt-approx",    "4pt-axis-approx", "3pt-approx"};
  const Values tenths = {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1};
  const Values angular = {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.75, 1};
  using V = ExperimentVariable;
  return {
      {"image-noise",
       "image noise of 0 to 1 px",
       V::kImageNoise,
       "noise_px",
       "image noise [px]",
       false,
       kMotions,
       {0, 0.25, 0.5, 0.75, 1},
       tenths,
       general},
      {"pitch-noise", "error of the prior in pitch, 0 to 1 deg, at 0.5 px", V::kPitch, "pitch_deg",
       "pitch error of the prior [deg]", false, kMotions, angular, tenths, general},
      {"roll-noise", "error of the prior in roll, 0 to 1 deg, at 0.5 px", V::kRoll, "roll_deg",
       "roll error of the prior [deg]", false, kMotions, angular, tenths, general},
      {"planar-image-noise",
       "planar motion, image noise of 0 to 1 px",
       V::kImageNoise,
       "noise_px",
       "image noise [px]",
       true,
       kMotions,
       {0, 0.2, 0.4, 0.8, 1},
       tenths,
       planar},
      {"planar-vibration",
       "planar motion and vertical shocks of 0 to 2 % of |t|, at 0.5 px",
       V::kVibration,
       "vibration_percent",
       "vibration, 1 sigma [% of |t|]",
       true,
       kMotions,
       {0, 0.5, 1, 2},
       {0, 0.2, 0.4, 0.6, 0.8, 1, 1.2, 1.4, 1.6, 1.8, 2},
       planar},
      {"kitti-motions",
       "the motions of the KITTI odometry drives, simulated points, 20 % outliers",
       V::kNone,
       "",
       "",
       false,
       {"driven"},
       {},
       {},
       kitti},
      {"rotation-angle",
       "rotation of 0 to 20 deg: where the first order breaks",
       V::kRotation,
       "rotation_deg",
       "rotation angle [deg]",
       false,
       kRandomMotion,
       {0, 1, 2, 5, 10, 20},
       {0, 0.5, 1, 2, 3, 5, 7.5, 10, 15, 20},
       angles},
      {"outliers",
       "outliers among the matches, 0 to 80 %",
       V::kOutliers,
       "outlier_percent",
       "outliers [%]",
       false,
       kRandomMotion,
       {0, 20, 40, 60, 80},
       {0, 10, 20, 30, 40, 50, 60, 70, 80},
       outliers},
      {"match-count",
       "20 to 1000 matches",
       V::kMatchCount,
       "matches",
       "matches",
       false,
       kRandomMotion,
       {20, 50, 100, 200, 500},
       {20, 30, 50, 100, 200, 300, 500, 1000},
       counts},
      {"inter-share",
       "matches between the cameras, 0 to 100 %: the scale",
       V::kInterShare,
       "inter_percent",
       "matches between cameras [%]",
       false,
       kRandomMotion,
       {0, 5, 10, 25, 50, 100},
       {0, 2, 5, 10, 20, 30, 50, 75, 100},
       scale},
  };
}

// Motion pattern of a point; a random planar motion stays in the plane.
MotionPattern PatternOf(const ExperimentSpec& spec, const std::string& motion) {
  MotionPattern pattern = MotionPattern::kRandom;
  ParseMotionPattern(motion, &pattern);
  return spec.planar && pattern == MotionPattern::kRandom ? MotionPattern::kPlanar : pattern;
}

// 1-sigma image noise at a point.
double NoiseAt(const ExperimentSpec& spec, const ExperimentPoint& point) {
  return spec.variable == ExperimentVariable::kImageNoise ? *point.x : 0.5;
}

bool MakeDriven(const ExperimentPlan& plan, const ExperimentPoint& point, int index,
                FramePair* pair, std::string* error) {
  SceneOptions scene;
  scene.num_matches = 300;
  scene.outlier_share = 0.2;
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

const std::vector<ExperimentSpec>& ExperimentCatalogue() {
  static const std::vector<ExperimentSpec> catalogue = MakeCatalogue();
  return catalogue;
}

const ExperimentSpec* FindExperiment(std::string_view name) {
  for (const ExperimentSpec& spec : ExperimentCatalogue()) {
    if (name == spec.name) return &spec;
  }
  return nullptr;
}

std::string ExperimentNames() {
  std::string names;
  for (const ExperimentSpec& spec : ExperimentCatalogue()) {
    names += (names.empty() ? "" : ", ") + std::string(spec.name);
  }
  return names;
}

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
