// What the noise adds to the information: against numeric differentiation, and against noise that
// is drawn.
#include "rigel/refine/least_squares/noise_information.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "rigel/core/epipolar.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/test/refine/pixel_noise.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

// A unit ray, and how it moves with the pixels of a camera of 300 to 600 pixels a radian.
RowPoint RandomPoint(Random* random) {
  RowPoint point;
  point.p = RandomVector3(0.0, 1.0, random).normalized();
  for (int c = 0; c < 2; ++c) {
    const Eigen::Vector3d any = RandomVector3(0.0, 1.0, random);
    point.J.col(c) = point.p.cross(any).normalized() / random->Uniform(300.0, 600.0);
  }
  return point;
}

// Matches of a rig of different cameras at a motion that they do not fit.
struct Problem {
  explicit Problem(Random* random)
      : rig(MixedRig(random)), matches(rig, UnrelatedMatches(rig, 27, random)) {
    pose.R = ExpSO3(RandomVector3(0.0, 0.3, random));
    pose.t = RandomVector3(0.0, 1.0, random);
    const MotionBasis basis = FullBasis(pose, true);
    LinearizeGroups(matches, ResidualKind::kSampson, pose, &basis, &groups);
  }
  Rig rig;
  GroupedMatches matches;
  Pose pose;
  std::vector<GroupLinearization> groups;
};

TEST(NoiseInformation, MatchesNumericDifferentiation) {
  for (int index = 0; index < 20; ++index) {
    Random random = Random::Stream(3, index);
    const Problem problem(&random);
    const Rig& rig = problem.rig;
    const GroupedMatches& matches = problem.matches;
    const Pose& pose = problem.pose;
    const std::vector<GroupLinearization>& groups = problem.groups;
    std::vector<double> weights(matches.size());
    for (double& w : weights) w = random.Uniform() < 0.2 ? 0.0 : random.Uniform(0.1, 2.0);
    Matrix6d expected = Matrix6d::Zero();
    for (size_t g = 0; g < groups.size(); ++g) {
      const MatchGroup& group = matches.groups()[g];
      for (int k = group.begin; k < group.begin + group.size; ++k) {
        const Match& m = matches.matches()[k];
        SampsonRow row;
        ASSERT_TRUE(DifferentiateSampson(groups[g], RowPointOf(rig.cameras[m.camera1], m.pixel1),
                                         RowPointOf(rig.cameras[m.camera2], m.pixel2), &row));
        const Vector6 numeric = NumericRow(rig, m, pose);
        EXPECT_LT((row.by_motion - numeric).norm(), 1e-6 * numeric.norm());
        EXPECT_NEAR(row.gradient.norm(), 1.0, 1e-12);
        Eigen::Matrix<double, 6, 4> change;
        for (int c = 0; c < 4; ++c) {
          change.col(c) = CentralDifference(
              [&](double h) { return NumericRow(rig, Moved(m, c, h), pose); }, 1e-1);
        }
        EXPECT_LT((row.by_motion_and_pixels - change).norm(), 1e-4 * change.norm());
        expected += weights[k] * weights[k] * change * change.transpose();
      }
    }
    const Matrix6d D = NoiseInformation(matches, weights, pose);
    EXPECT_LT((D - expected).norm(), 1e-4 * expected.norm());
  }
}

// Any points and derivatives by the pixels, as other cameras have them.
TEST(NoiseInformation, MatchesNumericDifferentiationForAnyCamera) {
  for (int index = 0; index < 50; ++index) {
    Random random = Random::Stream(4, index);
    const Problem problem(&random);
    const GroupedMatches& matches = problem.matches;
    const Pose& pose = problem.pose;
    const std::vector<GroupLinearization>& groups = problem.groups;
    const size_t g = index % groups.size();
    const RowPoint points[2] = {RandomPoint(&random), RandomPoint(&random)};
    // The error at a motion near `pose`, with pixel coordinate c moved by h.
    const auto error = [&](const Vector6& change, int c, double h) {
      const Pose moved = {ExpSO3(change.head<3>()) * pose.R, pose.t + change.tail<3>()};
      std::vector<GroupLinearization> at;
      LinearizeGroups(matches, ResidualKind::kSampson, moved, nullptr, &at);
      RowPoint p[2] = {points[0], points[1]};
      p[c / 2].p += h * p[c / 2].J.col(c % 2);
      return SampsonError(at[g].F, p[0], p[1]);
    };
    const auto by_motion = [&](int c, double h) {
      Vector6 row;
      for (int m = 0; m < 6; ++m) {
        row(m) = CentralDifference(
            [&](double step) {
              return Eigen::Matrix<double, 1, 1>(error(step * Vector6::Unit(m), c, h));
            },
            1e-5)(0);
      }
      return row;
    };
    SampsonRow row;
    ASSERT_TRUE(DifferentiateSampson(groups[g], points[0], points[1], &row));
    EXPECT_NEAR(row.residual, error(Vector6::Zero(), 0, 0.0), 1e-9 * std::abs(row.residual));
    const Vector6 numeric = by_motion(0, 0.0);
    EXPECT_LT((row.by_motion - numeric).norm(), 1e-6 * numeric.norm());
    Eigen::Matrix<double, 6, 4> change;
    for (int c = 0; c < 4; ++c) {
      change.col(c) = CentralDifference([&](double h) { return by_motion(c, h); }, 1e-2);
    }
    EXPECT_LT((row.by_motion_and_pixels - change).norm(), 1e-3 * change.norm());
  }
}

// On an exact match the gradient is the derivative of the error.
TEST(NoiseInformation, TheGradientIsThatOfAnExactMatch) {
  SceneOptions scene;
  scene.noise_px = 1e-9;
  scene.inter_share = 0.5;
  const FramePair pair = ScenePair(scene, 1);
  const GroupedMatches matches(pair.rig, pair.matches);
  const MotionBasis basis = FullBasis(*pair.truth, true);
  std::vector<GroupLinearization> groups;
  LinearizeGroups(matches, ResidualKind::kSampson, *pair.truth, &basis, &groups);
  for (size_t g = 0; g < groups.size(); ++g) {
    const Match& m = matches.matches()[matches.groups()[g].begin];
    SampsonRow row;
    ASSERT_TRUE(DifferentiateSampson(groups[g], RowPointOf(pair.rig.cameras[m.camera1], m.pixel1),
                                     RowPointOf(pair.rig.cameras[m.camera2], m.pixel2), &row));
    for (int c = 0; c < 4; ++c) {
      const double numeric = CentralDifference(
          [&](double h) {
            return Eigen::Matrix<double, 1, 1>(SampsonError(*pair.truth, pair.rig, Moved(m, c, h)));
          },
          1e-2)(0);
      EXPECT_NEAR(row.gradient(c), numeric, 1e-6);
    }
  }
}

// Zero at an epipole: no baseline, so that F = 0.
TEST(NoiseInformation, NothingAtAnEpipole) {
  Random random(1);
  Rig rig = MixedRig(&random);
  rig.cameras.resize(1);
  rig.cameras[0].s.setZero();
  const GroupedMatches matches(rig, UnrelatedMatches(rig, 5, &random));
  const Matrix6d D = NoiseInformation(matches, std::vector<double>(5, 1.0), Pose());
  EXPECT_EQ(D, Matrix6d(Matrix6d::Zero()));
}

// The mean over 200 draws of J'J / sigma^2 - D is J'J / sigma^2 of the exact pixels, in every
// direction to 5 percent of it. Without D it is twice as large in the worst.
TEST(NoiseInformation, IsWhatNoiseAdds) {
  Random random(1);
  const FramePair wall = WallPair(&random);
  const Rig& rig = wall.rig;
  const Pose& truth = *wall.truth;
  const std::vector<Match>& exact = wall.matches;
  const std::vector<double> ones(exact.size(), 1.0);
  constexpr double kNoise = 0.5;
  constexpr int kDraws = 200;
  Eigen::Matrix<double, 6, 6> noisy = Eigen::Matrix<double, 6, 6>::Zero(), D = noisy;
  for (int draw = 0; draw < kDraws; ++draw) {
    const GroupedMatches grouped(rig, WithNoise(exact, kNoise, &random));
    noisy += SampsonInformation(grouped, ones, truth) / (kNoise * kNoise * kDraws);
    D += NoiseInformation(grouped, ones, truth) / kDraws;
  }
  const Eigen::Matrix<double, 6, 6> information =
      SampsonInformation(GroupedMatches(rig, exact), ones, truth) / (kNoise * kNoise);
  const auto ratios = [&](const Eigen::Matrix<double, 6, 6>& of) {
    return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(of, information)
        .eigenvalues()
        .eval();
  };
  const Vector6 corrected = ratios(noisy - D);
  std::printf("[ measured ] over the exact information: %.3f to %.3f, without D to %.3f\n",
              corrected(0), corrected(5), ratios(noisy)(5));
  EXPECT_GT(corrected(0), 0.95);
  EXPECT_LT(corrected(5), 1.05);
  EXPECT_GT(ratios(noisy)(5), 2.0);
}

}  // namespace
}  // namespace rigel
