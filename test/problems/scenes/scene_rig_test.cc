// The rig that sees a scene: errors of the calibration and times of cameras, in box and street.
#include "rigel/problems/scenes/scene_rig.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/random.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/scenes/street.h"

namespace rigel {
namespace {

using testing::HasSubstr;

FramePair Box(const SceneOptions& options, int index) {
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeScenePair(options, index, &pair, &error)) << error;
  EXPECT_TRUE(pair.IsValid(&error)) << error;
  return pair;
}

FramePair Street(const StreetOptions& options, int index) {
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeStreetPair(options, index, &pair, &error)) << error;
  EXPECT_TRUE(pair.IsValid(&error)) << error;
  return pair;
}

// The cameras of the box, on a street with its body's axes.
StreetOptions StereoStreet() {
  StreetOptions options;
  options.rig = Box(SceneOptions(), 0).rig;
  options.ground_m = 1.6;
  return options;
}

TEST(SceneRig, PartsOfAMotionAreOnAnArc) {
  Random random(1);
  Pose whole;
  whole.R = ExpSO3(0.3 * random.UnitVector3());
  whole.t = random.NormalVector3();
  const Pose half = PartOfMotion(whole, 0.5);
  const auto difference = [](const Pose& a, const Pose& b) {
    return (a.R - b.R).cwiseAbs().maxCoeff() + (a.t - b.t).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(difference(half * half, whole), 1e-14);
  EXPECT_LT(difference(PartOfMotion(whole, 1.0), whole), 1e-14);
  EXPECT_LT(difference(PartOfMotion(whole, -0.3) * PartOfMotion(whole, 1.3), whole), 1e-14);
  EXPECT_EQ(difference(PartOfMotion(whole, 0.0), Pose()), 0.0);
  EXPECT_LT(difference(PartOfMotion({Eigen::Matrix3d::Identity(), whole.t}, 0.25),
                       {Eigen::Matrix3d::Identity(), 0.25 * whole.t}),
            1e-15);
}

// The error leaves the stated rig, the truth and the random numbers of the pairs as they are.
TEST(SceneRig, WithoutAnErrorNothingChanges) {
  SceneOptions box;
  StreetOptions street = StereoStreet();
  const std::string box_text = FormatMatches(Box(box, 3));
  const std::string street_text = FormatMatches(Street(street, 3));
  EXPECT_EQ(box_text.find("camera_"), std::string::npos);
  box.camera_times = street.camera_times = {0.0, 0.0};
  box.interval_s = street.interval_s = 7.0;
  EXPECT_EQ(FormatMatches(Box(box, 3)), box_text);
  EXPECT_EQ(FormatMatches(Street(street, 3)), street_text);
  box.calibration_sigma_deg = 1.0;
  const FramePair wrong = Box(box, 3);
  const FramePair right = Box(SceneOptions(), 3);
  EXPECT_NE(FormatMatches(wrong), box_text);
  EXPECT_EQ(wrong.rig.cameras[1].Q, right.rig.cameras[1].Q);
  EXPECT_EQ(wrong.truth->R, right.truth->R);
}

// The derivatives of a match's residual by the errors of one camera: three turns, three shifts.
Vector6d DerivativesByCamera(const FramePair& pair, const Match& match, int camera) {
  constexpr double kStep = 1e-6;
  const auto residual = [&](int k, double step) {
    Rig rig = pair.rig;
    RigCamera& moved = rig.cameras[camera];
    const Eigen::Vector3d along = step * Eigen::Vector3d::Unit(k % 3);
    if (k < 3) {
      moved.Q = ExpSO3(along) * moved.Q;
    } else {
      moved.s += along;
    }
    return SampsonError(*pair.truth, rig, match);
  };
  Vector6d derivatives;
  for (int k = 0; k < 6; ++k) {
    derivatives[k] = (residual(k, kStep) - residual(k, -kStep)) / (2 * kStep);
  }
  return derivatives;
}

// Mean square of the residuals at the truth of the stated rig, over what the derivatives by the
// error of each camera predict; of the matches that `which` takes.
double SquareOverPrediction(const std::function<FramePair(uint64_t)>& make, double sigma_deg,
                            double sigma_m, const std::function<bool(const Match&)>& which) {
  double square = 0, predicted = 0;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const FramePair pair = make(seed);
    for (const Match& match : pair.matches) {
      if (!which(match)) continue;
      square += std::pow(SampsonError(*pair.truth, pair.rig, match), 2);
      for (int camera = 0; camera < pair.rig.size(); ++camera) {
        const Vector6d by = DerivativesByCamera(pair, match, camera);
        predicted += std::pow(DegToRad(sigma_deg), 2) * by.head<3>().squaredNorm() +
                     std::pow(sigma_m, 2) * by.tail<3>().squaredNorm();
      }
    }
  }
  EXPECT_GT(square, 0);
  return square / predicted;
}

TEST(SceneRig, ResidualsAtTheTruthAreAsLargeAsTheErrorSays) {
  const auto make_box = [](double sigma_deg, double sigma_m) {
    return [=](uint64_t seed) {
      SceneOptions options;
      options.num_matches = 20;
      options.noise_px = 0;
      options.inter_share = 0.5;
      options.calibration_sigma_deg = sigma_deg;
      options.calibration_sigma_m = sigma_m;
      options.seed = seed;
      return Box(options, 0);
    };
  };
  const auto all = [](const Match&) { return true; };
  const auto first = [](const Match& m) { return m.camera1 == 0 && m.camera2 == 0; };
  // Bounds: four times the spread of 300 draws of the error, which has a few that matter.
  EXPECT_NEAR(SquareOverPrediction(make_box(0.05, 0.0), 0.05, 0.0, all), 1.0, 0.25);
  EXPECT_NEAR(SquareOverPrediction(make_box(0.0, 0.01), 0.0, 0.01, all), 1.0, 0.25);
  EXPECT_NEAR(SquareOverPrediction(make_box(0.05, 0.01), 0.05, 0.01, first), 1.0, 0.3);

  StreetOptions street = StereoStreet();
  street.num_matches = 20;
  street.noise_px = 0;
  street.inter_share = 0.5;
  street.calibration_sigma_deg = 0.05;
  street.calibration_sigma_m = 0.01;
  const auto make_street = [&](uint64_t seed) {
    street.seed = seed;
    return Street(street, 0);
  };
  EXPECT_NEAR(SquareOverPrediction(make_street, 0.05, 0.01, all), 1.0, 0.25);
}

// The rig that fits the matches of one pair fits those of the others, too.
TEST(SceneRig, TheErrorIsTheSameInAllPairs) {
  StreetOptions options = StereoStreet();
  options.num_matches = 50;
  options.noise_px = 0;
  options.inter_share = 0.5;
  options.calibration_sigma_deg = 0.5;
  options.calibration_sigma_m = 0.05;
  FramePair stated;
  stated.rig = options.rig;
  stated.truth = Pose();
  const Rig seen = RigOfScene(options, 0, &stated);
  EXPECT_GT((seen.cameras[0].s - options.rig.cameras[0].s).norm(), 1e-3);
  EXPECT_GT((seen.cameras[1].s - options.rig.cameras[1].s).norm(), 1e-3);
  for (int index = 0; index < 3; ++index) {
    const FramePair pair = Street(options, index);
    double largest = 0;
    for (const Match& match : pair.matches) {
      EXPECT_NEAR(SampsonError(*pair.truth, seen, match), 0.0, 1e-8);
      largest = std::max(largest, std::abs(SampsonError(*pair.truth, pair.rig, match)));
    }
    EXPECT_GT(largest, 0.5);
  }
}

TEST(SceneRig, StatesTheErrorIfAsked) {
  SceneOptions options;
  options.calibration_sigma_deg = 0.2;
  options.calibration_sigma_m = 0.02;
  EXPECT_EQ(FormatMatches(Box(options, 0)).find("camera_sigma"), std::string::npos);
  options.state_calibration_sigma = true;
  EXPECT_THAT(FormatMatches(Box(options, 0)),
              HasSubstr("\ncamera_sigma 0 0.2 0.02\ncamera_sigma 1 0.2 0.02\n"));
}

// A share of a motion of constant velocity by many small steps, without the library's way to it.
Pose BodyAfter(const Pose& f2_from_f1, double share) {
  constexpr int kSteps = 4096;  // a power of two: the step is that many halvings of the motion
  Pose step = f2_from_f1;
  for (int n = kSteps; n > 1; n /= 2) {
    Pose half;  // half * half = step
    half.R = ExpSO3(0.5 * LogSO3(step.R));
    half.t = (half.R + Eigen::Matrix3d::Identity()).inverse() * step.t;
    step = half;
  }
  const int count = static_cast<int>(std::lround(share * kSteps));
  Pose moved;
  for (int n = 0; n < count; ++n) moved = step * moved;
  return moved;
}

// The largest residual at the motion between the moments at which the cameras of each match fire.
double LargestResidual(const FramePair& pair, double interval_s) {
  double largest = 0;
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    if (pair.columns.inlier[k] == 0) continue;
    const Match& match = pair.matches[k];
    const double share1 = pair.rig.cameras[match.camera1].time_offset / interval_s;
    const double share2 = pair.rig.cameras[match.camera2].time_offset / interval_s;
    const Pose motion =
        BodyAfter(*pair.truth, 1 + share2) * BodyAfter(*pair.truth, share1).Inverse();
    largest = std::max(largest, std::abs(SampsonError(motion, pair.rig, match)));
  }
  return largest;
}

TEST(SceneRig, CamerasSeeFromWhereTheRigIsAtTheirTime) {
  SceneOptions box;
  box.noise_px = 0;
  box.inter_share = 0.5;
  box.rotation_deg = 5;
  box.camera_times = {0.0, 0.0625};
  box.interval_s = 0.125;
  box.moving_share = 0.2;
  const FramePair in_box = Box(box, 2);
  EXPECT_EQ(in_box.rig.cameras[1].time_offset, 0.0625);
  EXPECT_EQ(in_box.time1, 0.25);
  EXPECT_EQ(in_box.time2, 0.375);
  EXPECT_THAT(FormatMatches(in_box), HasSubstr("\ncamera_time 1 0.0625\ntime 0.25 0.375\n"));
  EXPECT_LT(LargestResidual(in_box, box.interval_s), 1e-8);

  StreetOptions street = StereoStreet();
  street.rig.cameras[1].time_offset = 0.0625;  // as a rig file says
  street.noise_px = 0;
  street.inter_share = 0.5;
  street.interval_s = 0.125;
  street.moving_share = 0.2;
  FramePair on_street = Street(street, 0);
  EXPECT_LT(LargestResidual(on_street, street.interval_s), 1e-8);
  on_street.rig.cameras[1].time_offset = 0;
  EXPECT_GT(LargestResidual(on_street, street.interval_s), 1.0);
}

TEST(SceneRig, WhatIsNoErrorAndNoTimeIsRefused) {
  const auto refusal = [](const std::function<void(SceneOptions*)>& spoil) {
    SceneOptions options;
    spoil(&options);
    std::string error;
    EXPECT_FALSE(options.IsValid(&error));
    return error;
  };
  EXPECT_THAT(refusal([](SceneOptions* o) { o->calibration_sigma_deg = -1; }),
              HasSubstr("calibration_sigma_deg must be finite and not negative"));
  EXPECT_THAT(refusal([](SceneOptions* o) { o->calibration_sigma_m = NAN; }),
              HasSubstr("calibration_sigma_m must be finite and not negative"));
  EXPECT_THAT(refusal([](SceneOptions* o) {
                o->state_calibration_sigma = true;
                o->calibration_sigma_deg = 1;
              }),
              HasSubstr("state_calibration_sigma needs"));
  EXPECT_THAT(refusal([](SceneOptions* o) { o->camera_times = {0.1}; }),
              HasSubstr("camera_times must have a number for each of the 2 cameras"));
  EXPECT_THAT(refusal([](SceneOptions* o) {
                o->camera_times = {0.1, INFINITY};
              }),
              HasSubstr("camera_times must be finite"));
  EXPECT_THAT(refusal([](SceneOptions* o) { o->interval_s = 0; }),
              HasSubstr("interval_s must be positive"));

  StreetOptions street = StereoStreet();
  street.calibration_sigma_m = 100;
  FramePair pair;
  std::string error;
  EXPECT_FALSE(MakeStreetPair(street, 0, &pair, &error));
  EXPECT_THAT(error, HasSubstr("with the errors of the calibration"));
}

TEST(SceneRig, TurnsAndStandsStillExactly) {
  SceneOptions box;
  StreetOptions street = StereoStreet();
  box.motion = MotionPattern::kTurn;
  street.motion = StreetMotion::kTurn;
  box.rotation_deg = street.rotation_deg = 3;
  for (const FramePair& pair : {Box(box, 0), Street(street, 0)}) {
    EXPECT_EQ(pair.truth->t, Eigen::Vector3d::Zero());
    EXPECT_NEAR(LogSO3(pair.truth->R).norm(), DegToRad(3), 1e-12);
    EXPECT_NEAR(std::abs(LogSO3(pair.truth->R).y()), DegToRad(3), 1e-12);
  }
  box.motion = MotionPattern::kStill;
  street.motion = StreetMotion::kStill;
  box.noise_px = street.noise_px = 0;
  for (const FramePair& pair : {Box(box, 0), Street(street, 0)}) {
    EXPECT_EQ(pair.truth->R, Eigen::Matrix3d::Identity());
    EXPECT_EQ(pair.truth->t, Eigen::Vector3d::Zero());
    for (const Match& match : pair.matches) {
      EXPECT_LT((match.pixel1 - match.pixel2).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace rigel
