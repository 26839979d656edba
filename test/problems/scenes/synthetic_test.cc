// The scene of the benchmarks: exact geometry, exact shares, the stated distributions.
#include "rigel/problems/scenes/synthetic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using ::testing::HasSubstr;

TEST(Synthetic, NamesOfPatterns) {
  MotionPattern motion = MotionPattern::kForward;
  EXPECT_TRUE(ParseMotionPattern("random", &motion));
  EXPECT_EQ(motion, MotionPattern::kRandom);
  EXPECT_TRUE(ParseMotionPattern("sideways", &motion));
  EXPECT_EQ(motion, MotionPattern::kSideways);
  EXPECT_TRUE(ParseMotionPattern("planar", &motion));
  EXPECT_EQ(motion, MotionPattern::kPlanar);
  EXPECT_TRUE(ParseMotionPattern("forward", &motion));
  EXPECT_EQ(motion, MotionPattern::kForward);
  EXPECT_FALSE(ParseMotionPattern("Random", &motion));
  EXPECT_EQ(motion, MotionPattern::kForward);
  RotationAxisPattern axis = RotationAxisPattern::kY;
  EXPECT_TRUE(ParseRotationAxisPattern("random", &axis));
  EXPECT_EQ(axis, RotationAxisPattern::kRandom);
  EXPECT_TRUE(ParseRotationAxisPattern("y", &axis));
  EXPECT_EQ(axis, RotationAxisPattern::kY);
  EXPECT_FALSE(ParseRotationAxisPattern("z", &axis));
}

TEST(Synthetic, WithoutNoiseEveryMatchIsAPointInFrontAtTheStatedDepth) {
  for (int cameras = 1; cameras <= 4; ++cameras) {
    SceneOptions options;
    options.num_cameras = cameras;
    options.noise_px = 0.0;
    options.inter_share = cameras > 1 ? 0.5 : 0.0;
    options.motion = MotionPattern::kRandom;
    options.rotation_axis = RotationAxisPattern::kRandom;
    double nearest = 1e9, farthest = 0;
    std::set<int> pairs_seen;
    for (int index = 0; index < 10; ++index) {
      const FramePair pair = ScenePair(options, index);
      std::string error;
      ASSERT_TRUE(pair.IsValid(&error)) << error;
      ASSERT_EQ(pair.rig.size(), cameras);
      ASSERT_EQ(pair.matches.size(), 200u);
      EXPECT_FALSE(pair.noise_px.has_value());
      for (const Match& m : pair.matches) {
        const RayPair rays = MakeRayPair(pair.rig, m);
        EXPECT_NEAR(GecTripleProduct(*pair.truth, rays), 0.0, 1e-13);
        Depths depths;
        ASSERT_TRUE(TriangulateDepths(*pair.truth, rays, &depths));
        EXPECT_TRUE(depths.BothPositive());
        // Depth is along the optical axis, the distance along the ray.
        const Eigen::Vector3d u = AlongRay(pair.rig.cameras[m.camera1].intrinsics, m.pixel1);
        const double depth = depths.d1 / u.norm();
        // A match of small parallax tells its depth with few digits.
        EXPECT_GT(depth, 5.0 - 1e-4);
        EXPECT_LT(depth, 30.0 + 1e-4);
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
        EXPECT_TRUE(pair.rig.cameras[m.camera1].intrinsics.InImage(m.pixel1));
        EXPECT_TRUE(pair.rig.cameras[m.camera2].intrinsics.InImage(m.pixel2));
        pairs_seen.insert(10 * m.camera1 + m.camera2);
      }
    }
    EXPECT_LT(nearest, 5.2);
    EXPECT_GT(farthest, 29.5);
    EXPECT_EQ(pairs_seen.size(), static_cast<size_t>(cameras * cameras));
  }
}

TEST(Synthetic, SharesAreExact) {
  for (const double inter : {0.0, 0.25, 0.5, 1.0}) {
    for (const double outliers : {0.0, 0.1, 0.33, 1.0}) {
      SceneOptions options;
      options.noise_px = 0.0;
      options.inter_share = inter;
      options.outlier_share = outliers;
      SceneOptions clean = options;
      clean.outlier_share = 0.0;
      const FramePair pair = ScenePair(options, 2);
      const FramePair reference = ScenePair(clean, 2);
      int num_inter = 0, moved = 0, moved_inter = 0;
      for (size_t k = 0; k < pair.matches.size(); ++k) {
        const Match& m = pair.matches[k];
        num_inter += !m.IsIntra();
        EXPECT_EQ(m.pixel1, reference.matches[k].pixel1);
        const bool outlier = m.pixel2 != reference.matches[k].pixel2;
        moved += outlier;
        moved_inter += outlier && !m.IsIntra();
        EXPECT_TRUE(pair.rig.cameras[m.camera2].intrinsics.InImage(m.pixel2));
      }
      EXPECT_EQ(num_inter, static_cast<int>(std::lround(200 * inter)));
      EXPECT_EQ(moved, static_cast<int>(std::lround(200 * outliers)));
      // Among both kinds alike.
      if (inter == 0.5 && outliers == 0.33) {
        EXPECT_GT(moved_inter, 20);
        EXPECT_LT(moved_inter, 46);
      }
    }
  }
}

TEST(Synthetic, ColumnsSayWhatIsAnInlierAndWhereItsPointsAre) {
  SceneOptions options;
  options.inter_share = 0.3;
  options.outlier_share = 0.2;
  options.moving_share = 0.1;
  const FramePair pair = ScenePair(options, 4);
  SceneOptions exact = options;
  exact.noise_px = 0.0;
  const FramePair reference = ScenePair(exact, 4);
  ASSERT_EQ(pair.columns.inlier.size(), 200u);
  EXPECT_TRUE(pair.columns.sigma1.empty());
  int inliers = 0, outliers = 0;
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    const Match& m = pair.matches[k];
    const std::array<double, 4>& e = pair.columns.exact[k];
    const bool own = Pixel(e[0], e[1]) == m.pixel1 && Pixel(e[2], e[3]) == m.pixel2;
    outliers += own;
    inliers += pair.columns.inlier[k];
    EXPECT_FALSE(own && pair.columns.inlier[k] == 1);
    if (own) continue;
    EXPECT_EQ(Pixel(e[0], e[1]), reference.matches[k].pixel1);
    EXPECT_EQ(Pixel(e[2], e[3]), reference.matches[k].pixel2);
  }
  EXPECT_EQ(inliers, 140);
  EXPECT_EQ(outliers, 40);
}

TEST(Synthetic, NoiseHasTheStatedSigmaInAllFourCoordinates) {
  SceneOptions noisy, clean;
  noisy.noise_px = 0.7;
  noisy.num_matches = 5000;
  clean = noisy;
  clean.noise_px = 0.0;
  // The same draws would shift with the noise's own, so the Sampson error has to tell: it sees the
  // noise of both points along the gradient, with the stated sigma.
  for (const bool inter : {false, true}) {
    noisy.inter_share = inter;
    const FramePair pair = ScenePair(noisy, 1);
    double sum = 0.0;
    for (const Match& m : pair.matches) {
      sum += std::pow(SampsonError(*pair.truth, pair.rig, m), 2);
    }
    EXPECT_NEAR(std::sqrt(sum / 5000), 0.7, 0.03);
    EXPECT_EQ(pair.noise_px, 0.7);
  }
}

bool SamePair(const FramePair& a, const FramePair& b) {
  return FormatMatches(a) == FormatMatches(b);
}

TEST(Synthetic, APairDependsOnSeedAndIndexAlone) {
  SceneOptions options;
  options.inter_share = 0.3;
  options.outlier_share = 0.2;
  options.motion = MotionPattern::kRandom;
  const FramePair seventh = ScenePair(options, 7);
  for (const int other : {0, 3, 8}) EXPECT_FALSE(SamePair(seventh, ScenePair(options, other)));
  EXPECT_TRUE(SamePair(seventh, ScenePair(options, 7)));
  SceneOptions reseeded = options;
  reseeded.seed = 2;
  EXPECT_FALSE(SamePair(seventh, ScenePair(reseeded, 7)));
  // The motion and the rig do not change with the number of matches.
  SceneOptions fewer = options;
  fewer.num_matches = 20;
  const FramePair small = ScenePair(fewer, 7);
  EXPECT_EQ(small.truth->t, seventh.truth->t);
  EXPECT_EQ(small.truth->R, seventh.truth->R);
  EXPECT_EQ(small.rig.cameras[1].s, seventh.rig.cameras[1].s);
}

TEST(Synthetic, MotionPatterns) {
  Eigen::Vector3d mean_random = Eigen::Vector3d::Zero(), mean_planar = mean_random;
  Eigen::Vector3d mean_axis = mean_random;
  constexpr int kPairs = 400;
  for (int index = 0; index < kPairs; ++index) {
    SceneOptions options;
    options.num_matches = 0;
    options.rotation_deg = 2.5;
    const FramePair forward = ScenePair(options, index);
    EXPECT_EQ(forward.truth->t, Eigen::Vector3d(0, 0, 1));
    EXPECT_LT((LogSO3(forward.truth->R) - Eigen::Vector3d(0, DegToRad(2.5), 0)).norm(), 1e-12);
    options.motion = MotionPattern::kSideways;
    EXPECT_EQ(ScenePair(options, index).truth->t, Eigen::Vector3d(1, 0, 0));
    options.motion = MotionPattern::kPlanar;
    const FramePair planar = ScenePair(options, index);
    EXPECT_EQ(planar.truth->t.y(), 0.0);
    EXPECT_NEAR(planar.truth->t.norm(), 1.0, 1e-12);
    EXPECT_EQ(*planar.prior.normal, Eigen::Vector3d(0, 1, 0));
    mean_planar += planar.truth->t / kPairs;
    options.motion = MotionPattern::kRandom;
    options.rotation_axis = RotationAxisPattern::kRandom;
    const FramePair random = ScenePair(options, index);
    EXPECT_NEAR(random.truth->t.norm(), 1.0, 1e-12);
    EXPECT_NEAR(RadToDeg(LogSO3(random.truth->R).norm()), 2.5, 1e-9);
    EXPECT_FALSE(random.prior.normal.has_value());
    mean_random += random.truth->t / kPairs;
    mean_axis += *random.prior.axis / kPairs;
    for (const FramePair* pair : {&forward, &planar, &random}) {
      const MotionPrior& prior = pair->prior;
      EXPECT_LT((pair->truth->R * *prior.gravity1 - *prior.gravity2).norm(), 1e-12);
      EXPECT_LT((pair->truth->R * *prior.axis - *prior.axis).norm(), 1e-12);
      EXPECT_FALSE(prior.gravity_sigma || prior.axis_sigma || prior.normal_sigma);
    }
  }
  // Uniform over the sphere and the circle: means of 400 unit vectors.
  EXPECT_LT(mean_random.norm(), 0.15);
  EXPECT_LT(mean_planar.norm(), 0.15);
  EXPECT_LT(mean_axis.norm(), 0.15);
}

TEST(Synthetic, TheGivenMotionIsTheTruth) {
  Pose truth;
  truth.R = ExpSO3(Eigen::Vector3d(0.02, -0.05, 0.03));
  truth.t = {0.1, -0.05, 0.8};
  const FramePair pair = ScenePair(SceneOptions(), 4, truth);
  EXPECT_EQ(pair.truth->R, truth.R);
  EXPECT_EQ(pair.truth->t, truth.t);
  EXPECT_LT((truth.R * *pair.prior.gravity1 - *pair.prior.gravity2).norm(), 1e-12);
  EXPECT_LT((truth.R * *pair.prior.axis - *pair.prior.axis).norm(), 1e-12);
  // No rotation, no axis: body Y.
  EXPECT_EQ(*ScenePair(SceneOptions(), 4, Pose()).prior.axis, Eigen::Vector3d(0, 1, 0));
}

TEST(Synthetic, TheRigIsSpreadAsStated) {
  const Eigen::Vector3d positions[4] = {{-0.5, 0, 0}, {0.5, 0, 0}, {0, 0.4, 0.3}, {0, -0.4, 0.3}};
  double moved = 0, turned = 0;
  Eigen::Vector3d mean_moved = Eigen::Vector3d::Zero();
  constexpr int kPairs = 500;
  for (int index = 0; index < kPairs; ++index) {
    SceneOptions options;
    options.num_cameras = 4;
    options.num_matches = 0;
    const FramePair pair = ScenePair(options, index);
    for (int k = 0; k < 4; ++k) {
      const RigCamera& camera = pair.rig.cameras[k];
      const Camera& c = camera.intrinsics;
      EXPECT_TRUE(c.fx() == 400 && c.fy() == 400 && c.cx() == 320 && c.cy() == 240 &&
                  c.width == 640 && c.height == 480);
      moved += (camera.s - positions[k]).squaredNorm();
      mean_moved += camera.s - positions[k];
      turned += LogSO3(camera.Q).squaredNorm();
    }
  }
  // 6000 numbers each: a sigma is known to 1 percent.
  EXPECT_NEAR(std::sqrt(moved / (12.0 * kPairs)), 0.05, 0.002);
  EXPECT_NEAR(std::sqrt(turned / (12.0 * kPairs)), 0.1, 0.004);
  EXPECT_LT((mean_moved / (4.0 * kPairs)).norm(), 0.006);
}

TEST(Synthetic, InvalidOptionsAreRefusedWithTheirName) {
  const auto expect_invalid = [](void (*change)(SceneOptions*), const char* part) {
    SceneOptions options;
    change(&options);
    FramePair pair;
    pair.name = "untouched";
    std::string error;
    EXPECT_FALSE(MakeScenePair(options, 0, &pair, &error)) << part;
    EXPECT_THAT(error, HasSubstr(part));
    EXPECT_EQ(pair.name, "untouched");
    EXPECT_TRUE(pair.matches.empty());
  };
  expect_invalid([](SceneOptions* o) { o->num_cameras = 0; }, "num_cameras");
  expect_invalid([](SceneOptions* o) { o->num_cameras = 5; }, "num_cameras");
  expect_invalid([](SceneOptions* o) { o->num_matches = -1; }, "num_matches");
  expect_invalid([](SceneOptions* o) { o->noise_px = -0.1; }, "noise_px");
  expect_invalid([](SceneOptions* o) { o->noise_px = std::nan(""); }, "noise_px");
  expect_invalid([](SceneOptions* o) { o->noise_px = HUGE_VAL; }, "noise_px");
  expect_invalid([](SceneOptions* o) { o->rotation_deg = std::nan(""); }, "rotation_deg");
  expect_invalid([](SceneOptions* o) { o->inter_share = 1.01; }, "inter_share");
  expect_invalid([](SceneOptions* o) { o->inter_share = std::nan(""); }, "inter_share");
  expect_invalid([](SceneOptions* o) { o->outlier_share = -0.01; }, "outlier_share");
  expect_invalid(
      [](SceneOptions* o) {
        o->num_cameras = 1;
        o->inter_share = 0.5;
      },
      "two cameras");
  expect_invalid(
      [](SceneOptions* o) {
        o->motion = MotionPattern::kPlanar;
        o->rotation_axis = RotationAxisPattern::kRandom;
      },
      "planar");
  // Half a turn: what was ahead is behind.
  expect_invalid([](SceneOptions* o) { o->rotation_deg = 180.0; }, "view of camera");
}

TEST(Synthetic, TheCarsMatchesAgreeOnAMotionOfTheirOwn) {
  SceneOptions options;
  options.noise_px = 0.0;
  options.motion = MotionPattern::kRandom;
  for (int index = 0; index < 20; ++index) {
    options.moving_share = 0.0;
    const FramePair still = ScenePair(options, index);
    options.moving_share = 0.3;
    const FramePair pair = ScenePair(options, index);
    EXPECT_EQ(pair.truth->R, still.truth->R);
    EXPECT_EQ(pair.truth->t, still.truth->t);
    std::vector<Match> moving;
    for (size_t k = 0; k < pair.matches.size(); ++k) {
      const Match& m = pair.matches[k];
      EXPECT_EQ(m.camera1, still.matches[k].camera1);
      EXPECT_TRUE(pair.rig.cameras[m.camera1].intrinsics.InImage(m.pixel1));
      EXPECT_TRUE(pair.rig.cameras[m.camera2].intrinsics.InImage(m.pixel2));
      if (m.pixel1 != still.matches[k].pixel1) moving.push_back(m);
      // The others are untouched.
      else
        EXPECT_EQ(m.pixel2, still.matches[k].pixel2);
    }
    ASSERT_EQ(moving.size(), 60u);
    // Compact: within a window, not all over the image.
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    int first_camera = 0;
    for (const Match& m : moving) {
      if (m.camera1 != 0) continue;
      mean += m.pixel1;
      ++first_camera;
    }
    mean /= first_camera;
    double spread = 0.0;
    for (const Match& m : moving) {
      if (m.camera1 == 0) spread += (m.pixel1 - mean).squaredNorm() / first_camera;
    }
    EXPECT_LT(std::sqrt(spread), 160.0);
    // Alone they give a motion that holds them all, turns about the vertical and is not the rig's.
    FramePair car = pair;
    car.matches = moving;
    car.columns = MatchColumns();
    EstimateOptions estimate;
    estimate.solver = "4pt";
    estimate.ransac.threshold_px = 0.1;
    const MotionEstimate own = EstimateMotion(estimate, car);
    ASSERT_TRUE(own.HasMotion()) << own.message;
    EXPECT_EQ(own.num_inliers, 60);
    EXPECT_LT(own.refine.median_residual_px, 1e-4);
    double off = 0.0;
    for (const Match& m : moving) {
      off = std::max(off, std::abs(GecTripleProduct(*pair.truth, MakeRayPair(pair.rig, m))));
    }
    EXPECT_GT(off, 1e-3);
  }
}

TEST(Synthetic, SharesOfOutliersAndCarAddUp) {
  SceneOptions options;
  std::string error;
  options.outlier_share = 0.6;
  options.moving_share = 0.5;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("moving_share"));
  options.moving_share = -0.1;
  EXPECT_FALSE(options.IsValid(&error));
  options.moving_share = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(options.IsValid(&error));
  options.moving_share = 0.4;
  EXPECT_TRUE(options.IsValid(&error));
  options.num_matches = 5;  // both shares are rounded up
  options.outlier_share = options.moving_share = 0.5;
  EXPECT_EQ(ScenePair(options, 0).matches.size(), 5u);
}

TEST(Synthetic, ScoresOfTrueMatchesAreLowerAndChangeNothingElse) {
  SceneOptions options;
  options.num_matches = 1000;
  options.outlier_share = 0.5;
  const FramePair plain = ScenePair(options, 0);
  options.match_scores = true;
  const FramePair scored = ScenePair(options, 0);
  options.outlier_share = 0.0;
  const FramePair clean = ScenePair(options, 0);
  double good = 0.0, bad = 0.0;
  for (size_t k = 0; k < scored.matches.size(); ++k) {
    const Match& m = scored.matches[k];
    EXPECT_EQ(plain.matches[k].score, 0.0);
    EXPECT_EQ(plain.matches[k].pixel2, m.pixel2);
    EXPECT_GT(m.score, 0.0);
    EXPECT_LE(m.score, 0.8);
    (m.pixel2 == clean.matches[k].pixel2 ? good : bad) += m.score / 500.0;
  }
  EXPECT_NEAR(good, 0.4, 0.03);
  EXPECT_NEAR(bad, 0.8 * 11.0 / 12.0, 0.03);
}

TEST(Synthetic, ARingLooksOutwardsAllRound) {
  for (const int cameras : {1, 4, 8, 16}) {
    SceneOptions options;
    options.ring = true;
    options.num_cameras = cameras;
    options.noise_px = 0.0;
    options.rotation_deg = 30.0;
    options.inter_share = cameras >= 4 ? 0.5 : 0.0;
    const FramePair pair = ScenePair(options, cameras);
    ASSERT_EQ(pair.rig.size(), cameras);
    for (int k = 0; k < cameras; ++k) {
      const RigCamera& camera = pair.rig.cameras[k];
      EXPECT_NEAR(camera.s.norm(), 1.0, 1e-12);
      EXPECT_NEAR(camera.s.dot(camera.Q.col(2)), 1.0, 1e-12);  // ahead is outwards
      EXPECT_NEAR(camera.Q(1, 1), 1.0, 1e-12);                 // the image's y is down
      const RigCamera& next = pair.rig.cameras[(k + 1) % cameras];
      EXPECT_NEAR(camera.s.dot(next.s), std::cos(2.0 * std::acos(-1.0) / cameras), 1e-12);
    }
    std::set<int> seen;
    for (const Match& m : pair.matches) {
      seen.insert(m.camera1);
      const int apart = (m.camera2 - m.camera1 + cameras) % cameras;
      EXPECT_TRUE(apart == 0 || apart == 1 || apart == cameras - 1);
    }
    EXPECT_EQ(seen.size(), static_cast<size_t>(cameras));
    std::vector<double> errors;
    GroupedMatches(pair.rig, pair.matches).SquaredErrors(*pair.truth, &errors);
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 1e-16);
  }
  SceneOptions options;
  options.ring = true;
  options.num_cameras = kMaxRing + 1;
  std::string error;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("1 to 16"));
  // Four cameras of 77 degrees see nothing in common while the body does not turn.
  options.num_cameras = 4;
  options.inter_share = 0.5;
  options.rotation_deg = 1.0;
  FramePair pair;
  EXPECT_FALSE(MakeScenePair(options, 0, &pair, &error));
  EXPECT_THAT(error, HasSubstr("hardly any point"));
}

}  // namespace
}  // namespace rigel
