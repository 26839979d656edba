#include "rigel/core/grouped_matches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/test/core/lens_rig.h"

namespace rigel {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kThreshold = 1.5;

// Numbers of matches that fill the kernel's blocks of 32 and that do not; all camera pairs; mixed
// focal lengths, fx != fy.
FramePair MakePair(int num_matches, int seed) {
  SceneOptions options;
  options.num_cameras = 3;
  options.num_matches = num_matches;
  options.inter_share = 0.5;
  options.outlier_share = 0.3;
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeScenePair(options, seed, &pair, &error)) << error;
  for (int k = 0; k < 3; ++k) {
    Camera& camera = pair.rig.cameras[k].intrinsics;
    const Camera old = camera;
    camera = Camera::Pinhole(300.0 + 100 * k, 350.0 + 80 * k, 300.0 + 10 * k, 250.0, 800, 600);
    // The same rays through the new camera.
    for (Match& match : pair.matches) {
      if (match.camera1 == k) Project(camera, AlongRay(old, match.pixel1), &match.pixel1);
      if (match.camera2 == k) Project(camera, AlongRay(old, match.pixel2), &match.pixel2);
    }
  }
  return pair;
}

Pose PoseNear(const Pose& truth, uint64_t seed) {
  Random random = Random::Stream(3, seed);
  Pose pose = truth;
  pose.R = ExpSO3(0.003 * random.NormalVector3()) * pose.R;
  pose.t += 0.05 * random.NormalVector3();
  return pose;
}

// The score's definition, by core's Sampson error, one match at a time.
double DirectScore(const FramePair& pair, const Pose& pose, int* num_inliers) {
  double sum = 0.0;
  *num_inliers = 0;
  for (const Match& match : pair.matches) {
    const double r = SampsonError(pose, pair.rig, match);
    const double r2 = r * r;
    sum += std::min(r2, kThreshold * kThreshold);
    *num_inliers += r2 < kThreshold * kThreshold;
  }
  return sum;
}

TEST(GroupedMatches, GroupsByCameraPairAndKeepsTheOrderWithin) {
  const FramePair pair = MakePair(200, 1);
  const GroupedMatches grouped(pair.rig, pair.matches);
  ASSERT_EQ(grouped.size(), 200);
  std::vector<bool> seen(200, false);
  for (int k = 0; k < grouped.size(); ++k) {
    const int original = grouped.original(k);
    ASSERT_FALSE(seen[original]) << "twice";
    seen[original] = true;
    EXPECT_EQ(grouped.matches()[k].pixel1, pair.matches[original].pixel1);
    EXPECT_EQ(grouped.matches()[k].pixel2, pair.matches[original].pixel2);
  }
  EXPECT_GT(grouped.groups().size(), 5u);
  int next = 0;
  for (size_t g = 0; g < grouped.groups().size(); ++g) {
    const MatchGroup& group = grouped.groups()[g];
    EXPECT_EQ(group.begin, next);
    next += group.size;
    for (int k = group.begin; k < next; ++k) {
      EXPECT_EQ(grouped.matches()[k].camera1, group.camera1);
      EXPECT_EQ(grouped.matches()[k].camera2, group.camera2);
      if (k > group.begin) {
        EXPECT_LT(grouped.original(k - 1), grouped.original(k));
      }
    }
    for (size_t h = 0; h < g; ++h) {
      EXPECT_FALSE(grouped.groups()[h].camera1 == group.camera1 &&
                   grouped.groups()[h].camera2 == group.camera2)
          << "one pair of cameras in two groups";
    }
  }
  EXPECT_EQ(next, grouped.size());
}

TEST(GroupedMatches, ScoreIsTheSumOfTruncatedSampsonErrors) {
  for (const int num_matches : {1, 3, 31, 32, 33, 100, 400}) {
    for (int seed = 0; seed < 20; ++seed) {
      const FramePair pair = MakePair(num_matches, seed);
      const GroupedMatches grouped(pair.rig, pair.matches);
      const Pose pose = PoseNear(*pair.truth, seed);
      int expected_inliers = 0;
      const double expected = DirectScore(pair, pose, &expected_inliers);
      int inliers = -1;
      EXPECT_NEAR(grouped.Score(pose, kThreshold, kInf, &inliers), expected, 1e-9 * expected);
      EXPECT_EQ(inliers, expected_inliers);
      if (num_matches >= 100) {
        EXPECT_GT(inliers, 0);
        EXPECT_LT(inliers, num_matches);
      }
    }
  }
}

TEST(GroupedMatches, ScoreDoesNotDependOnTheOrderOfTheMatches) {
  FramePair pair = MakePair(300, 2);
  const Pose pose = PoseNear(*pair.truth, 2);
  int expected_inliers = 0;
  const double expected =
      GroupedMatches(pair.rig, pair.matches).Score(pose, kThreshold, kInf, &expected_inliers);
  Random random(1);
  for (int k = 0; k < 10; ++k) {
    for (int i = 299; i > 0; --i) {
      std::swap(pair.matches[i], pair.matches[random.Index(i + 1)]);
    }
    int inliers = 0;
    EXPECT_NEAR(GroupedMatches(pair.rig, pair.matches).Score(pose, kThreshold, kInf, &inliers),
                expected, 1e-10 * expected);
    EXPECT_EQ(inliers, expected_inliers);
  }
}

// RANSAC compares score < bound, so: a score below the bound comes back complete and unchanged, any
// other stops at or above it.
TEST(GroupedMatches, ABoundNeverRejectsAWinner) {
  for (int seed = 0; seed < 50; ++seed) {
    const FramePair pair = MakePair(300, seed);
    const GroupedMatches grouped(pair.rig, pair.matches);
    const Pose pose = PoseNear(*pair.truth, seed);
    int expected_inliers = 0;
    const double score = grouped.Score(pose, kThreshold, kInf, &expected_inliers);
    for (const double above : {std::nextafter(score, kInf), score * 1.001, score + 100.0}) {
      int inliers = 0;
      EXPECT_EQ(grouped.Score(pose, kThreshold, above, &inliers), score);
      EXPECT_EQ(inliers, expected_inliers);
    }
    for (const double share : {0.0, 0.1, 0.5, 0.9, 0.999999}) {
      int inliers = 0;
      const double stopped = grouped.Score(pose, kThreshold, share * score, &inliers);
      EXPECT_GT(stopped, share * score);
      EXPECT_LE(stopped, score * (1 + 1e-12));
      EXPECT_LE(inliers, expected_inliers);
    }
    int inliers = 0;
    EXPECT_GE(grouped.Score(pose, kThreshold, score, &inliers), score);
  }
}

TEST(GroupedMatches, ALowBoundStopsEarly) {
  // Else the bound would be of no use: of a wrong motion hardly any match is looked at.
  const FramePair pair = MakePair(400, 3);
  const GroupedMatches grouped(pair.rig, pair.matches);
  Pose wrong = *pair.truth;
  wrong.R = ExpSO3(Eigen::Vector3d(0.5, 0.5, 0.5)) * wrong.R;
  int inliers = 0;
  const double full = grouped.Score(wrong, kThreshold, kInf, &inliers);
  EXPECT_LT(grouped.Score(wrong, kThreshold, 0.1 * full, &inliers), 0.4 * full);
}

TEST(GroupedMatches, SquaredErrorsAreThoseOfCoreInGroupedOrder) {
  for (int seed = 0; seed < 20; ++seed) {
    const FramePair pair = MakePair(150, seed);
    const GroupedMatches grouped(pair.rig, pair.matches);
    const Pose pose = PoseNear(*pair.truth, seed);
    std::vector<double> errors(3, -1.0);
    grouped.SquaredErrors(pose, &errors);
    ASSERT_EQ(errors.size(), 150u);
    for (int k = 0; k < 150; ++k) {
      const double r = SampsonError(pose, pair.rig, pair.matches[grouped.original(k)]);
      EXPECT_NEAR(errors[k], r * r, 1e-9 * r * r + 1e-18);
    }
  }
}

// By the definition in the header: the Sampson error is below the threshold and the match does not
// lie behind a camera with a parallax that noise cannot make.
bool IsInlierInFront(const FramePair& pair, const Pose& pose, const Match& match) {
  const double r = SampsonError(pose, pair.rig, match);
  if (!(r * r < kThreshold * kThreshold)) return false;
  const Camera& c1 = pair.rig.cameras[match.camera1].intrinsics;
  const Camera& c2 = pair.rig.cameras[match.camera2].intrinsics;
  const double min_sin_parallax =
      2.0 * kThreshold / std::min(std::min(c1.fx(), c1.fy()), std::min(c2.fx(), c2.fy()));
  const Cheirality cheirality =
      TestCheirality(pose, MakeRayPair(pair.rig, match), min_sin_parallax);
  return cheirality == Cheirality::kInFront || cheirality == Cheirality::kUndecided;
}

TEST(GroupedMatches, ScoreInFrontCountsMatchesBehindAsOutliers) {
  for (const int num_matches : {5, 64, 65, 300}) {
    int behind = 0;
    for (int seed = 0; seed < 20; ++seed) {
      const FramePair pair = MakePair(num_matches, seed);
      const GroupedMatches grouped(pair.rig, pair.matches);
      // The truth, a neighbour, and the neighbour with the sign of t turned.
      Pose turned = PoseNear(*pair.truth, seed);
      turned.t = -turned.t;
      for (const Pose& pose : {*pair.truth, PoseNear(*pair.truth, seed), turned}) {
        double expected = 0.0;
        int expected_inliers = 0;
        for (const Match& match : pair.matches) {
          const double r = SampsonError(pose, pair.rig, match);
          const bool inlier = IsInlierInFront(pair, pose, match);
          expected += inlier ? r * r : kThreshold * kThreshold;
          expected_inliers += inlier;
        }
        int inliers = -1;
        const double score = grouped.ScoreInFront(pose, kThreshold, kInf, &inliers);
        EXPECT_NEAR(score, expected, 1e-9 * expected);
        EXPECT_EQ(inliers, expected_inliers);
        int all_inliers = 0;
        EXPECT_GE(score, grouped.Score(pose, kThreshold, kInf, &all_inliers));
        EXPECT_LE(inliers, all_inliers);
        behind += all_inliers - inliers;
        // The bound, as of Score().
        EXPECT_EQ(grouped.ScoreInFront(pose, kThreshold, std::nextafter(score, kInf), &inliers),
                  score);
        EXPECT_EQ(inliers, expected_inliers);
        EXPECT_GT(grouped.ScoreInFront(pose, kThreshold, 0.5 * score, &inliers), 0.5 * score);
      }
    }
    EXPECT_GT(behind, 0) << "the two scores were to differ";
  }
}

TEST(GroupedMatches, SelectInliersAgreesWithTheScore) {
  for (int seed = 0; seed < 20; ++seed) {
    const FramePair pair = MakePair(150, seed);
    const GroupedMatches grouped(pair.rig, pair.matches);
    const Pose pose = PoseNear(*pair.truth, seed);
    std::vector<double> errors, squared;
    std::vector<char> selected(7, 2);
    const int count = grouped.SelectInliers(pose, kThreshold, &errors, &selected);
    int inliers = 0;
    grouped.ScoreInFront(pose, kThreshold, kInf, &inliers);
    EXPECT_EQ(count, inliers);
    grouped.SquaredErrors(pose, &squared);
    EXPECT_EQ(errors, squared);
    ASSERT_EQ(selected.size(), 150u);
    for (int k = 0; k < 150; ++k) {
      EXPECT_EQ(selected[k] == 1, IsInlierInFront(pair, pose, grouped.matches()[k])) << k;
    }
  }
}

TEST(GroupedMatches, RaysAreInGroupedOrder) {
  const FramePair pair = MakePair(50, 9);
  const GroupedMatches grouped(pair.rig, pair.matches);
  for (int k = 0; k < grouped.size(); ++k) {
    const RayPair rays = MakeRayPair(pair.rig, pair.matches[grouped.original(k)]);
    EXPECT_EQ(grouped.rays(k).ray1.x, rays.ray1.x);
    EXPECT_EQ(grouped.rays(k).ray2.x, rays.ray2.x);
    EXPECT_EQ(grouped.rays(k).ray2.s, rays.ray2.s);
  }
}

TEST(GroupedMatches, FundamentalMatrixOfAGroup) {
  const FramePair pair = MakePair(60, 4);
  const GroupedMatches grouped(pair.rig, pair.matches);
  for (const MatchGroup& group : grouped.groups()) {
    const Eigen::Matrix3d F = grouped.Fundamental(group, *pair.truth);
    const RowArrays pixels = grouped.Rows(group);
    ASSERT_EQ(pixels.size, group.size);
    for (int k = 0; k < group.size; ++k) {
      const Eigen::Vector3d p1(pixels.x1[k], pixels.y1[k], 1.0);
      const Eigen::Vector3d p2(pixels.x2[k], pixels.y2[k], 1.0);
      const double r = SampsonError(*pair.truth, pair.rig, grouped.matches()[group.begin + k]);
      EXPECT_NEAR(SampsonError(F, p1, p2), r, 1e-9 * (1 + std::abs(r)));
    }
  }
}

TEST(GroupedMatches, ZeroMotionOfOneCameraWinsNoMatch) {
  // E = 0 fits every intra-camera match.
  FramePair pair = MakePair(100, 5);
  for (Match& match : pair.matches) match.camera2 = match.camera1;
  const GroupedMatches grouped(pair.rig, pair.matches);
  int inliers = -1;
  EXPECT_DOUBLE_EQ(grouped.Score(Pose(), kThreshold, kInf, &inliers),
                   100 * kThreshold * kThreshold);
  EXPECT_EQ(inliers, 0);
  std::vector<double> errors;
  grouped.SquaredErrors(Pose(), &errors);
  for (const double error : errors) EXPECT_EQ(error, kInf);
}

TEST(GroupedMatches, AMotionThatIsNotFiniteWinsNoMatch) {
  const FramePair pair = MakePair(100, 6);
  const GroupedMatches grouped(pair.rig, pair.matches);
  for (const double bad : {kNan, kInf}) {
    Pose pose = *pair.truth;
    pose.t.x() = bad;
    int inliers = -1;
    EXPECT_DOUBLE_EQ(grouped.Score(pose, kThreshold, kInf, &inliers),
                     100 * kThreshold * kThreshold);
    EXPECT_EQ(inliers, 0);
    std::vector<double> errors;
    grouped.SquaredErrors(pose, &errors);
    for (const double error : errors) EXPECT_FALSE(error < 1e300);
  }
}

TEST(GroupedMatches, SubsetsAreTheSameAsOfTheMatchesTheyHold) {
  const FramePair pair = MakePair(101, 3);
  const GroupedMatches all(pair.rig, pair.matches);
  for (const int count : {0, 1, 3, 40, 101, 500}) {
    int num_first = 0;
    for (const bool drawn : {false, true}) {
      const GroupedMatches subset = drawn ? all.DrawnSubset(count) : all.EvenSubset(count);
      ASSERT_EQ(subset.size(), std::min(count, 101));
      const GroupedMatches expected(pair.rig, subset.matches());
      ASSERT_EQ(subset.groups().size(), expected.groups().size());
      std::vector<double> errors, expected_errors;
      subset.SquaredErrors(*pair.truth, &errors);
      expected.SquaredErrors(*pair.truth, &expected_errors);
      EXPECT_EQ(errors, expected_errors);
      for (int k = 0; k < subset.size(); ++k) {
        EXPECT_EQ(subset.original(k), k);
        EXPECT_EQ(subset.rays(k).ray1.x, expected.rays(k).ray1.x);
        EXPECT_EQ(subset.rays(k).ray2.s, expected.rays(k).ray2.s);
        // One of each stretch: the first one, or any.
        const auto begin = all.matches().begin() + k * 101 / subset.size();
        const auto end = all.matches().begin() + (k + 1) * 101 / subset.size();
        const auto taken = std::find_if(
            begin, end, [&](const Match& m) { return m.pixel1 == subset.matches()[k].pixel1; });
        EXPECT_TRUE(drawn ? taken != end : taken == begin);
        if (drawn) num_first += taken == begin;
      }
    }
    if (count == 40) {
      EXPECT_LT(num_first, 30);
      EXPECT_GT(num_first, 5);
    }
  }
}

// Also pinholes, in a rig with other lenses.
TEST(GroupedMatches, RowsOfAnyLensHaveTheSampsonErrorOfTheirRays) {
  Random random(12);
  for (int number = 0; number < 9; ++number) {
    const LensRig lenses = MakeLensRig(number, &random);
    const GroupedMatches grouped(lenses.rig, UnrelatedLensMatches(lenses, 45, &random));
    ASSERT_EQ(grouped.size(), 45);
    Pose pose;
    pose.R = ExpSO3(random.NormalVector3());
    pose.t = random.NormalVector3();
    std::vector<double> errors;
    grouped.SquaredErrors(pose, &errors);
    for (int k = 0; k < grouped.size(); ++k) {
      const Match& m = grouped.matches()[k];
      const RigCamera& i = lenses.rig.cameras[m.camera1];
      const RigCamera& j = lenses.rig.cameras[m.camera2];
      const double r = SampsonError(pose, lenses.rig, m);
      EXPECT_NEAR(errors[k], r * r, 1e-9 * r * r);
      // C over its gradient by the four pixels, by differences of the rays.
      const auto C = [&](const Eigen::Vector4d& p) {
        const Ray ray1 = MakeRay(i, {p(0), p(1)}), ray2 = MakeRay(j, {p(2), p(3)});
        return GecTripleProduct(pose, {ray1, ray2});
      };
      const Eigen::Vector4d p(m.pixel1.x(), m.pixel1.y(), m.pixel2.x(), m.pixel2.y());
      Eigen::Vector4d gradient;
      for (int c = 0; c < 4; ++c) {
        const Eigen::Vector4d step = 1e-3 * Eigen::Vector4d::Unit(c);
        gradient(c) = (C(p + step) - C(p - step)) / 2e-3;
      }
      // The length of a pinhole's (x, y, 1) depends on the pixel: a term of C, which counts where C
      // is not small.
      if (i.intrinsics.IsPinhole() || j.intrinsics.IsPinhole()) continue;
      EXPECT_NEAR(std::abs(r), std::abs(C(p)) / gradient.norm(), 1e-5 * std::abs(r)) << number;
    }
  }
}

TEST(GroupedMatches, MatchesWithoutARayAreLeftOut) {
  Random random(13);
  LensRig lenses = MakeLensRig(0, &random);
  lenses.cases[1].camera = {CameraModel::kOpencvFisheye, {300, 300, 320, 240}, 640, 480};
  lenses.rig.cameras[1].intrinsics = lenses.cases[1].camera;
  std::vector<Match> matches = UnrelatedLensMatches(lenses, 36, &random);
  const GroupedMatches all(lenses.rig, matches);
  EXPECT_EQ(all.size(), 36);
  const Pixel nowhere(320 + 300 * 3.2, 240);  // beyond 180 degrees
  int num_lost = 0;
  for (int k = 0; k < 36; k += 2) {
    if (matches[k].camera2 == 1) matches[k].pixel2 = nowhere;
    if (matches[k].camera1 == 1) matches[k].pixel1 = nowhere;
    num_lost += matches[k].camera1 == 1 || matches[k].camera2 == 1;
  }
  ASSERT_GT(num_lost, 0);
  const GroupedMatches grouped(lenses.rig, matches);
  EXPECT_EQ(grouped.size(), 36 - num_lost);
  EXPECT_EQ(grouped.num_given(), 36);
  int in_groups = 0;
  for (const MatchGroup& group : grouped.groups()) in_groups += group.size;
  EXPECT_EQ(in_groups, grouped.size());
  for (int k = 0; k < grouped.size(); ++k) {
    const Match& m = matches[grouped.original(k)];
    EXPECT_EQ(m.pixel1, grouped.matches()[k].pixel1);
    EXPECT_TRUE(grouped.Point1(k).p.allFinite() && grouped.Point2(k).p.allFinite());
    EXPECT_TRUE(std::isfinite(SampsonError(Pose(), lenses.rig, m)) || m.IsIntra());
  }
  Match lost;
  lost.camera1 = lost.camera2 = 1;
  lost.pixel1 = nowhere;
  lost.pixel2 = {320, 240};
  EXPECT_EQ(SampsonError(PoseNear(Pose(), 1), lenses.rig, lost), kInf);
  EXPECT_TRUE(MakeRayPair(lenses.rig, lost).ray1.x.array().isNaN().all());
  EXPECT_EQ(GroupedMatches(lenses.rig, {lost}).size(), 0);
}

TEST(GroupedMatches, NoMatches) {
  const FramePair pair = MakePair(0, 7);
  const GroupedMatches grouped(pair.rig, pair.matches);
  int inliers = -1;
  EXPECT_EQ(grouped.Score(*pair.truth, kThreshold, kInf, &inliers), 0.0);
  EXPECT_EQ(inliers, 0);
  EXPECT_EQ(grouped.size(), 0);
  EXPECT_TRUE(grouped.groups().empty());
}

}  // namespace
}  // namespace rigel
