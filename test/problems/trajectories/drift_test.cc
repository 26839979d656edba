// KITTI's metric against figures worked out by hand and against a plain second implementation.
#include "rigel/problems/trajectories/drift.h"

#include <cmath>

#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

// Straight ahead, a metre a frame.
std::vector<Pose> Straight(int metres, double scale, double yaw_per_m) {
  std::vector<Pose> poses;
  for (int k = 0; k <= metres; ++k) {
    Pose pose;
    pose.R = RotationY(k * yaw_per_m);
    pose.t = {0, 0, k * scale};
    poses.push_back(pose);
  }
  return poses;
}

TEST(Drift, ScaleErrorOfAStraightDriveByHand) {
  const Drift drift = ComputeDrift(Straight(1000, 1.0, 0.0), Straight(1000, 1.01, 0.0));
  EXPECT_EQ(drift.start_step, 10);
  EXPECT_DOUBLE_EQ(drift.path_length, 1000.0);
  ASSERT_EQ(drift.by_length.size(), 8u);
  double sum = 0.0;
  int count = 0;
  for (int n = 1; n <= 8; ++n) {
    const int length = 100 * n;
    // Ends at the first frame more than `length` farther, so a metre beyond.
    const double expected = 0.01 * (length + 1) / length;
    const int segments = (999 - length) / 10 + 1;
    EXPECT_EQ(drift.by_length[n - 1].length, length);
    EXPECT_EQ(drift.by_length[n - 1].segments, segments) << length;
    EXPECT_NEAR(drift.by_length[n - 1].translation, expected, 1e-12) << length;
    EXPECT_EQ(drift.by_length[n - 1].rotation, 0.0);
    sum += segments * expected;
    count += segments;
  }
  EXPECT_EQ(drift.all.segments, count);
  EXPECT_NEAR(drift.all.translation, sum / count, 1e-12);
  EXPECT_NEAR(drift.end_translation, 10.0, 1e-9);
  EXPECT_EQ(drift.end_rotation, 0.0);
  EXPECT_NEAR(drift.step_translation->rms, 0.01, 1e-12);
}

TEST(Drift, RotationIsPerMetre) {
  const double yaw = DegToRad(0.002);
  const Drift drift = ComputeDrift(Straight(150, 1.0, 0.0), Straight(150, 1.0, yaw));
  ASSERT_EQ(drift.by_length.size(), 1u);  // 100 m
  EXPECT_EQ(drift.all.segments, 5);       // from 0, 10, ..., 40
  EXPECT_NEAR(drift.all.rotation, 101 * yaw / 100, 1e-15);
  EXPECT_NEAR(drift.end_rotation, 150 * yaw, 1e-12);
  EXPECT_NEAR(drift.step_rotation->median, yaw, 1e-15);
}

TEST(Drift, ShortClipsHaveShorterLengthsFromEveryFrame) {
  const Drift sixty = ComputeDrift(Straight(60, 1.0, 0.0), Straight(60, 1.02, 0.0));
  EXPECT_EQ(sixty.start_step, 1);
  ASSERT_EQ(sixty.by_length.size(), 5u);
  EXPECT_EQ(sixty.by_length[4].length, 50.0);
  EXPECT_EQ(sixty.by_length[4].segments, 10);
  EXPECT_NEAR(sixty.by_length[4].translation, 0.02 * 51 / 50, 1e-12);
  // The whole path is no longer than 100 m: not one segment of 100 m.
  EXPECT_EQ(ComputeDrift(Straight(100, 1, 0), Straight(100, 1, 0)).by_length.back().length, 80.0);
  EXPECT_EQ(ComputeDrift(Straight(5, 1, 0), Straight(5, 1, 0)).by_length.size(), 4u);
  EXPECT_TRUE(ComputeDrift(Straight(1, 1, 0), Straight(1, 1, 0)).by_length.empty());
}

// The devkit's loops, with angles by the trace and matrices of 4 x 4.
TEST(Drift, AgreesWithAPlainSecondImplementation) {
  Random random(7);
  std::vector<Pose> truth = {Pose()}, estimate = {Pose()};
  for (int k = 0; k < 900; ++k) {
    Pose step;
    step.R = ExpSO3(0.02 * random.NormalVector3());
    step.t = 0.05 * random.NormalVector3();
    step.t.z() += random.Uniform(0.0, 2.0);
    Pose noisy = step;
    noisy.R = ExpSO3(0.002 * random.NormalVector3()) * step.R;
    noisy.t += 0.02 * random.NormalVector3();
    truth.push_back(truth.back() * step);
    estimate.push_back(estimate.back() * noisy);
  }
  const auto matrix = [](const Pose& pose) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = pose.R;
    m.topRightCorner<3, 1>() = pose.t;
    return m;
  };
  std::vector<double> distance = {0.0};
  for (size_t k = 1; k < truth.size(); ++k) {
    distance.push_back(distance[k - 1] + (truth[k].t - truth[k - 1].t).norm());
  }
  double translation = 0.0, rotation = 0.0;
  int count = 0;
  for (size_t first = 0; first < truth.size(); first += 10) {
    for (double length = 100; length <= 800; length += 100) {
      for (size_t last = first; last < truth.size(); ++last) {
        if (distance[last] <= distance[first] + length) continue;
        const Eigen::Matrix4d gt = matrix(truth[first]).inverse() * matrix(truth[last]);
        const Eigen::Matrix4d result = matrix(estimate[first]).inverse() * matrix(estimate[last]);
        const Eigen::Matrix4d error = result.inverse() * gt;
        translation += error.topRightCorner<3, 1>().norm() / length;
        rotation += std::acos(0.5 * (error.topLeftCorner<3, 3>().trace() - 1)) / length;
        ++count;
        break;
      }
    }
  }
  const Drift drift = ComputeDrift(truth, estimate);
  ASSERT_GT(count, 100);
  EXPECT_EQ(drift.all.segments, count);
  EXPECT_NEAR(drift.all.translation, translation / count, 1e-12);
  EXPECT_NEAR(drift.all.rotation, rotation / count, 1e-10);
}

}  // namespace
}  // namespace rigel
