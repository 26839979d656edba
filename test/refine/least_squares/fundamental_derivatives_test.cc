// The derivatives of F against numeric differentiation, also where cameras fire at other times.
#include "rigel/refine/least_squares/fundamental_derivatives.h"

#include <gtest/gtest.h>

#include "rigel/core/epipolar.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using Entries = Eigen::Matrix<double, 9, 1>;

struct Problem {
  Rig rig;
  std::vector<Match> matches;
  Pose pose;
};

Problem MakeProblem(int index, bool times) {
  Random random = Random::Stream(21, index);
  Problem problem;
  problem.rig = MixedRig(&random);
  if (times) {
    for (RigCamera& camera : problem.rig.cameras) camera.time_offset = random.Uniform(-0.3, 0.3);
  }
  problem.matches = UnrelatedMatches(problem.rig, 20, &random);
  problem.pose.R = ExpSO3(RandomVector3(0.0, 0.4, &random));
  problem.pose.t = RandomVector3(0.0, 1.0, &random);
  return problem;
}

Entries EntriesOf(const GroupedMatches& matches, int group, const Pose& pose, bool of_rays) {
  const RowMajor3d F = FundamentalOf(matches, matches.groups()[group], pose, of_rays);
  return Eigen::Map<const Entries>(F.data());
}

TEST(FundamentalDerivatives, ByTheMotionAreNumericOnes) {
  for (int index = 0; index < 20; ++index) {
    const Problem problem = MakeProblem(index, index % 2 == 0);
    const GroupedMatches matches(problem.rig, problem.matches, {}, 1.0);
    EXPECT_EQ(matches.HasTimes(), index % 2 == 0);
    for (size_t g = 0; g < matches.groups().size(); ++g) {
      for (const bool of_rays : {false, true}) {
        const ByMotionMatrix D =
            FundamentalByMotion(matches, matches.groups()[g], problem.pose, of_rays);
        ByMotionMatrix numeric;
        for (int m = 0; m < 6; ++m) {
          numeric.col(m) = CentralDifference(
              [&](double h) {
                return EntriesOf(matches, g, Perturbed(problem.pose, h * Vector6d::Unit(m)),
                                 of_rays);
              },
              1e-5);
        }
        EXPECT_LT((D - numeric).norm(), 1e-8 * numeric.norm());
      }
    }
  }
}

TEST(FundamentalDerivatives, ByTheCalibrationAreNumericOnes) {
  for (int index = 0; index < 20; ++index) {
    const Problem problem = MakeProblem(index, false);
    const GroupedMatches matches(problem.rig, problem.matches);
    for (size_t g = 0; g < matches.groups().size(); ++g) {
      const MatchGroup& group = matches.groups()[g];
      const ByCalibrationMatrix D = FundamentalByCalibration(matches, group, problem.pose);
      for (int k = 0; k < 2 * kCameraErrors; ++k) {
        const int camera = k < kCameraErrors ? group.camera1 : group.camera2;
        const int error = k % kCameraErrors;
        const Entries numeric = CentralDifference(
            [&](double h) {
              Rig rig = problem.rig;
              RigCamera& c = rig.cameras[camera];
              const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(error % 3);
              if (error < 3) {
                c.Q = ExpSO3(step) * c.Q;
              } else if (error < 6) {
                c.s += step;
              } else {
                c.intrinsics.parameters[0] *= 1.0 + h;
                c.intrinsics.parameters[1] *= 1.0 + h;
              }
              return EntriesOf(GroupedMatches(rig, problem.matches), g, problem.pose, false);
            },
            1e-5);
        // One camera has both sides.
        Entries stated = D.col(k);
        if (group.camera1 == group.camera2) stated += D.col((k + kCameraErrors) % (14));
        EXPECT_LT((stated - numeric).norm(), 1e-7 * (numeric.norm() + D.norm()))
            << "group " << g << ", error " << k;
      }
    }
  }
}

// F of a camera that fires later is that of a camera that is mounted elsewhere.
TEST(FundamentalDerivatives, ACameraThatFiresLaterIsOneAtAnotherPlace) {
  const Problem problem = MakeProblem(1, false);
  Rig timed = problem.rig, placed = problem.rig;
  timed.cameras[1].time_offset = 0.1;
  const Pose part = PartOfMotion(problem.pose, -0.1 / 0.5);
  placed.cameras[1].Q = part.R * placed.cameras[1].Q;
  placed.cameras[1].s = part * placed.cameras[1].s;
  const GroupedMatches a(timed, problem.matches, {}, 0.5), b(placed, problem.matches);
  for (const MatchGroup& group : a.groups()) {
    EXPECT_LT((a.Fundamental(group, problem.pose) - b.Fundamental(group, problem.pose)).norm(),
              1e-15);
    EXPECT_LT(
        (a.Fundamental(group, problem.pose) - FundamentalOf(a, group, problem.pose, false)).norm(),
        1e-15);
  }
  // Without the time between the views it is not known where.
  EXPECT_FALSE(GroupedMatches(timed, problem.matches).HasTimes());
}

}  // namespace
}  // namespace rigel
