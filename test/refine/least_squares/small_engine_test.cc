// The small least-squares engine against Refine(): one cost, one minimum.
#include "rigel/refine/least_squares/small_engine.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "rigel/core/rig_centre.h"
#include "rigel/refine/least_squares/epipolar_residuals.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/refine.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

std::vector<char> AllOf(const GroupedMatches& matches) {
  return std::vector<char>(matches.size(), 1);
}

// With no prior.
bool Minimize(SmallEngine* engine, const LeastSquaresOptions& options,
              const std::vector<char>& mask, Pose* pose) {
  return engine->Minimize(options, mask, PriorResiduals(), 1.0, pose);
}

double Cost(const EpipolarResiduals& residuals, LossKind kind, double scale, const Pose& pose) {
  std::vector<GroupLinearization> groups;
  residuals.Linearize(pose, nullptr, &groups);
  const auto loss = MakeLoss(kind, scale);
  double sum = 0.0;
  for (int k = 0; k < residuals.size(); ++k) {
    const double r = residuals.Evaluate(groups, k, 0, nullptr);
    double rho[3] = {r * r, 1, 0};
    if (loss) loss->Evaluate(r * r, rho);
    sum += rho[0];
  }
  return sum;
}

TEST(PackedMatches, HoldTheMatchesOfWeightAboveZeroGroupByGroup) {
  SceneOptions scene;
  scene.inter_share = 0.5;
  scene.num_matches = 50;
  const FramePair pair = ScenePair(scene, 0);
  // With another noise for each pixel, so that the rows are of the general form.
  MatchColumns columns;
  for (size_t k = 0; k < pair.matches.size(); ++k) columns.sigma1.push_back(1.0 + 0.01 * k);
  const GroupedMatches matches(pair.rig, pair.matches, columns);
  std::vector<double> weights(matches.size());
  for (size_t k = 0; k < weights.size(); ++k) weights[k] = 0.5 * (k % 3);
  PackedMatches packed;
  packed.Set(matches, weights);
  ASSERT_EQ(packed.groups.size(), matches.groups().size());
  int n = 0;
  for (size_t g = 0; g < packed.groups.size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    const RowArrays pixels = matches.Rows(group);
    int in_group = 0;
    for (int k = 0; k < group.size; ++k) {
      if (weights[group.begin + k] == 0.0) continue;
      EXPECT_EQ(packed.weights[n++], weights[group.begin + k]);
      EXPECT_EQ(packed.groups[g].x1[in_group], pixels.x1[k]);
      EXPECT_EQ(packed.groups[g].y2[in_group], pixels.y2[k]);
      for (size_t c = 0; c < kGeneralArrays; ++c) {
        EXPECT_EQ(packed.groups[g].general[c * packed.groups[g].stride + in_group],
                  pixels.general[c * pixels.stride + k]);
      }
      ++in_group;
    }
    EXPECT_EQ(packed.groups[g].size, in_group);
  }
}

TEST(SmallEngine, ReachesTheMinimumOfRefine) {
  for (const LossKind kind :
       {LossKind::kNone, LossKind::kHuber, LossKind::kCauchy, LossKind::kTukey}) {
    for (int index = 0; index < 20; ++index) {
      SCOPED_TRACE(std::string(LossName(kind)) + ", pair " + std::to_string(index));
      SceneOptions options;
      options.inter_share = 0.5;
      const FramePair pair = ScenePair(options, index);
      Random random = Random::Stream(3, index);
      const Pose start = StartNear(*pair.truth, 0.05, 0.02, &random);
      const GroupedMatches matches(pair.rig, pair.matches);

      RefineOptions refine;
      refine.threshold_px = 1e3;  // the mask is all matches
      refine.noise_px = 0.5;
      refine.loss = kind;
      refine.loss_scale_sigmas = 3.0;
      refine.max_num_iterations = 500;
      refine.epipole_weights = false;
      refine.typical_length = 0.5;
      Pose by_refine = start;
      const RefineSummary summary = Refine(refine, matches, MotionPrior(), &by_refine);
      ASSERT_TRUE(summary.IsSolutionUsable());
      ASSERT_EQ(summary.num_inliers, matches.size());

      // Refine() fits the motion of the rig's centre, with the weak prior of its length.
      const Eigen::Vector3d center = RigCentre(pair.rig);
      const GroupedMatches centered = matches.WithOrigin(center);
      PriorParts parts;
      parts.typical_length = refine.typical_length;
      const PriorResiduals prior(MotionPrior(), parts, Pose());
      const EpipolarResiduals residuals(centered, ResidualKind::kSampson);
      for (const bool limits_length : {false, true}) {
        SmallEngine engine(centered);
        LeastSquaresOptions small;
        small.loss = kind;
        small.loss_scale = 1.5;
        small.max_num_iterations = 100;
        small.tolerance = 1e-14;
        small.limits_length = limits_length;
        Pose of_center = MotionOfPoint(start, center);
        ASSERT_TRUE(engine.Minimize(small, AllOf(matches), prior, 0.5, &of_center));
        const Pose by_engine = MotionOfBody(of_center, center);
        // Tukey's cost is flat where its weights leave next to nothing of a match.
        const double flat = kind == LossKind::kTukey ? 10.0 : 1.0;
        EXPECT_LT(Difference(by_engine, by_refine).head<3>().norm(), flat * 2e-6);
        EXPECT_LT(Difference(by_engine, by_refine).tail<3>().norm(), flat * 2e-5);
        PriorResiduals::Residuals r;
        prior.Evaluate(of_center, &r, nullptr);
        EXPECT_NEAR(Cost(residuals, kind, 1.5, of_center) + 0.25 * r.squaredNorm(),
                    2.0 * summary.final_cost, 1e-6 * summary.final_cost);
      }
    }
  }
}

// The unit is the weight of the prior: a length that pixels do not know is the prior's.
TEST(SmallEngine, MinimizesWithThePrior) {
  SceneOptions options;  // intra-camera matches, which hardly determine |t|
  const FramePair pair = ScenePair(options, 4);
  const GroupedMatches matches(pair.rig, pair.matches);
  MotionPrior stated;
  stated.distance = 3.0 * pair.truth->t.norm();
  stated.distance_sigma = 1e-4;
  PriorParts parts;
  parts.distance = true;
  const PriorResiduals prior(stated, parts, *pair.truth);
  SmallEngine engine(matches);
  LeastSquaresOptions small;
  small.max_num_iterations = 100;
  small.tolerance = 1e-14;
  Pose strong = *pair.truth, weak = *pair.truth;
  ASSERT_TRUE(engine.Minimize(small, AllOf(matches), prior, 0.5, &strong));
  EXPECT_NEAR(strong.t.norm(), *stated.distance, 1e-3);
  ASSERT_TRUE(engine.Minimize(small, AllOf(matches), prior, 1e-9, &weak));
  EXPECT_LT(weak.t.norm(), 2.0 * pair.truth->t.norm());
}

// A length that nothing but a far prior knows ends at the limit.
TEST(SmallEngine, LimitsTheLength) {
  SceneOptions options;
  options.rotation_deg = 0.0;
  const FramePair pair = ScenePair(options, 5);
  const GroupedMatches matches(pair.rig, pair.matches);
  LeastSquaresOptions small;
  small.max_num_iterations = 100;
  const double length = pair.truth->t.norm();
  for (const double factor : {1e-6, 1e6}) {
    PriorParts parts;
    parts.typical_length = factor * length;
    const PriorResiduals prior(MotionPrior(), parts, *pair.truth);
    SmallEngine engine(matches);
    small.limits_length = true;
    Pose limited = *pair.truth;
    ASSERT_TRUE(engine.Minimize(small, AllOf(matches), prior, 0.5, &limited));
    EXPECT_GE(limited.t.norm(), 0.25 * length * (1.0 - 1e-9));
    EXPECT_LE(limited.t.norm(), 1000.0 * length * (1.0 + 1e-9));
    small.limits_length = false;
    Pose free = *pair.truth;
    ASSERT_TRUE(engine.Minimize(small, AllOf(matches), prior, 0.5, &free));
    EXPECT_NEAR(std::log(free.t.norm() / (factor * length)), 0.0, 1.0);
  }
}

// The default of local optimization: outliers weigh nothing, and four steps gain much.
TEST(SmallEngine, ATruncatedLossIgnoresOutliers) {
  double before = 0.0, after = 0.0;
  for (int index = 0; index < 20; ++index) {
    SceneOptions options;
    options.inter_share = 0.5;
    options.outlier_share = 0.3;
    const FramePair pair = ScenePair(options, index);
    Random random = Random::Stream(4, index);
    Pose pose = StartNear(*pair.truth, 0.2, 0.03, &random);
    before += RotationErrorDeg(*pair.truth, pose);
    const GroupedMatches matches(pair.rig, pair.matches);
    const EpipolarResiduals residuals(matches, ResidualKind::kSampson);
    SmallEngine engine(matches);
    const double cost = Cost(residuals, LossKind::kTruncated, 1.5, pose);
    ASSERT_TRUE(Minimize(&engine, LeastSquaresOptions(), AllOf(matches), &pose));
    EXPECT_LT(Cost(residuals, LossKind::kTruncated, 1.5, pose), cost);
    EXPECT_NEAR(pose.R.determinant(), 1.0, 1e-12);
    after += RotationErrorDeg(*pair.truth, pose);
  }
  EXPECT_LT(after, 0.6 * before);
}

// The minimum over a mask is that of its matches alone.
TEST(SmallEngine, LeavesOutWhatTheMaskLeavesOut) {
  SceneOptions options;
  options.inter_share = 0.5;
  const FramePair pair = ScenePair(options, 6);
  Random random(6);
  const Pose start = StartNear(*pair.truth, 0.05, 0.02, &random);
  const GroupedMatches all(pair.rig, pair.matches);
  std::vector<char> mask(all.size());
  std::vector<Match> kept;
  for (int k = 0; k < all.size(); ++k) {
    mask[k] = k % 3 == 0;
    if (mask[k]) kept.push_back(all.matches()[k]);
  }
  const GroupedMatches fewer(pair.rig, kept);
  SmallEngine masked(all), alone(fewer);
  LeastSquaresOptions small;
  small.loss = LossKind::kCauchy;
  small.max_num_iterations = 100;
  small.tolerance = 1e-14;
  Pose a = start, b = start, c = start;
  ASSERT_TRUE(Minimize(&masked, small, mask, &a));
  ASSERT_TRUE(Minimize(&alone, small, AllOf(fewer), &b));
  ASSERT_TRUE(Minimize(&masked, small, AllOf(all), &c));
  EXPECT_LT(Difference(a, b).norm(), 1e-8);
  EXPECT_GT(Difference(a, c).norm(), 1e-4);
  Pose none = start;
  EXPECT_FALSE(Minimize(&masked, small, std::vector<char>(all.size(), 0), &none));
  EXPECT_EQ(none.t, start.t);
}

TEST(SmallEngine, KeepsNothingFromCallToCall) {
  SceneOptions options;
  options.inter_share = 0.5;
  const FramePair pair = ScenePair(options, 1);
  Random random(5);
  const Pose start = StartNear(*pair.truth, 0.05, 0.02, &random);
  const GroupedMatches matches(pair.rig, pair.matches);
  const EpipolarResiduals residuals(matches, ResidualKind::kSampson);
  SmallEngine engine(matches);
  Pose first = start;
  ASSERT_TRUE(Minimize(&engine, LeastSquaresOptions(), AllOf(matches), &first));
  LeastSquaresOptions other;
  other.limits_length = true;
  other.loss = LossKind::kHuber;
  Pose elsewhere = StartNear(*pair.truth, 0.5, 0.2, &random);
  Minimize(&engine, other, AllOf(matches), &elsewhere);
  Pose again = start;
  ASSERT_TRUE(Minimize(&engine, LeastSquaresOptions(), AllOf(matches), &again));
  EXPECT_EQ(first.R, again.R);
  EXPECT_EQ(first.t, again.t);
}

TEST(SmallEngine, SaysSoAndLeavesThePoseIfNothingImproves) {
  SceneOptions options;
  options.inter_share = 0.5;
  const FramePair pair = ScenePair(options, 2);
  const GroupedMatches matches(pair.rig, pair.matches);
  const EpipolarResiduals residuals(matches, ResidualKind::kSampson);
  SmallEngine engine(matches);
  const auto expect_unchanged = [&](const LeastSquaresOptions& small, const Pose& start) {
    Pose pose = start;
    EXPECT_FALSE(Minimize(&engine, small, AllOf(matches), &pose));
    // By bytes, so that NaN equals NaN.
    EXPECT_EQ(std::memcmp(pose.R.data(), start.R.data(), sizeof(double) * 9), 0);
    EXPECT_EQ(std::memcmp(pose.t.data(), start.t.data(), sizeof(double) * 3), 0);
  };
  LeastSquaresOptions none;
  none.max_num_iterations = 0;
  expect_unchanged(none, *pair.truth);

  // No match is within the truncation: the cost is flat.
  Pose away = *pair.truth;
  away.R = ExpSO3(Eigen::Vector3d(1.5, 0, 0)) * away.R;
  LeastSquaresOptions narrow;
  narrow.loss_scale = 1e-9;
  expect_unchanged(narrow, away);

  LeastSquaresOptions limited;
  limited.limits_length = true;
  Pose still = *pair.truth;
  still.t.setZero();
  expect_unchanged(LeastSquaresOptions(), still);
  expect_unchanged(limited, still);

  Pose nan = *pair.truth;
  nan.t.x() = std::numeric_limits<double>::quiet_NaN();
  expect_unchanged(LeastSquaresOptions(), nan);
  expect_unchanged(limited, nan);

  const GroupedMatches empty(pair.rig, {});
  SmallEngine idle(empty);
  Pose pose = *pair.truth;
  EXPECT_FALSE(Minimize(&idle, LeastSquaresOptions(), {}, &pose));
  EXPECT_EQ(pose.t, pair.truth->t);
}

}  // namespace
}  // namespace rigel
