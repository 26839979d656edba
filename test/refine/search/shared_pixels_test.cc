// Matches that share an image point: which of them count, and that an estimate is what the others
// say, with their uncertainty.
#include "rigel/refine/search/shared_pixels.h"

#include <cmath>
#include <cstdio>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "rigel/problems/scenes/scene_matches.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using testing::ElementsAre;

// Pixel (p, 0) of camera c and pixel (q, 0) of camera d.
Match Of(int c, double p, int d, double q) {
  Match m;
  m.camera1 = c;
  m.camera2 = d;
  m.pixel1 = {p, 0};
  m.pixel2 = {q, 0};
  return m;
}

std::vector<size_t> Distinct(const std::vector<Match>& matches, std::vector<int>* first_of) {
  return DistinctMatches(ImagePoints(matches, {}), first_of);
}

TEST(SharedPixels, AnExactRepeatCountsOnce) {
  const std::vector<Match> matches = {Of(0, 1, 0, 2), Of(0, 3, 0, 4), Of(0, 1, 0, 2),
                                      Of(1, 1, 0, 2), Of(0, 1, 1, 2), Of(0, 1, 0, 2)};
  std::vector<int> first_of;
  EXPECT_THAT(Distinct(matches, &first_of), ElementsAre(0, 1, 3, 4));
  EXPECT_THAT(first_of, ElementsAre(0, 1, 0, 3, 4, 0));
}

TEST(SharedPixels, APointWithManyPartnersInOneImageIsNoMatch) {
  for (const bool at_time2 : {false, true}) {
    const auto of = [&](int c, double p, int d, double q) {
      return at_time2 ? Of(d, q, c, p) : Of(c, p, d, q);
    };
    // Three partners in camera 0, and one in camera 1.
    std::vector<Match> matches = {of(0, 7, 0, 1), of(0, 7, 0, 2), of(0, 7, 0, 3), of(0, 7, 1, 4),
                                  of(0, 8, 0, 1)};
    std::vector<int> first_of;
    EXPECT_THAT(Distinct(matches, &first_of), ElementsAre(0, 1, 2, 3, 4));
    // A repeat is no further partner; a fourth one is.
    matches.push_back(of(0, 7, 0, 3));
    EXPECT_THAT(Distinct(matches, &first_of), ElementsAre(0, 1, 2, 3, 4));
    matches.push_back(of(0, 7, 0, 5));
    EXPECT_THAT(Distinct(matches, &first_of), ElementsAre(3, 4));
    EXPECT_THAT(first_of, ElementsAre(-1, -1, -1, 3, 4, -1, -1));
  }
}

TEST(SharedPixels, NothingIsSharedAmongNone) {
  std::vector<int> first_of;
  EXPECT_TRUE(Distinct({}, &first_of).empty());
  EXPECT_TRUE(first_of.empty());
  EXPECT_EQ(CountDistinctPixels(0, {}), 0);
}

GroupedMatches Grouped(const std::vector<Match>& matches) {
  Random random(1);
  return GroupedMatches(MixedRig(&random), matches);
}

TEST(SharedPixels, PartnersInOneImageCompete) {
  // One camera pair, so that the grouped order is that of the input; the last of another pair.
  const GroupedMatches matches =
      Grouped({Of(0, 1, 0, 2), Of(0, 1, 0, 3), Of(0, 4, 0, 3), Of(0, 5, 0, 6), Of(0, 1, 1, 2)});
  const std::vector<SharedPixel> shared = FindSharedPixels(matches);
  ASSERT_EQ(shared.size(), 4u);  // 0-1, 0-4 and 1-4 at time 1, 1-2 at time 2
  std::vector<char> inliers(5, 1);
  // Match 1 loses to match 0, and match 2 has then no rival. The partners of matches 0 and 4 are in
  // different images: they see one landmark.
  EXPECT_EQ(ResolveCompetition(matches, shared, {0.1, 0.2, 0.5, 9.0, 0.3}, &inliers), 1);
  EXPECT_THAT(inliers, ElementsAre(1, 0, 1, 1, 1));
  EXPECT_THAT(LinkedSets(shared, 5), ElementsAre(0, 0, 0, 3, 0));
  const std::vector<SharedPixel> within = SharedWithin(shared, inliers);
  EXPECT_THAT(LinkedSets(within, 5), ElementsAre(0, 1, 2, 3, 0));
  ASSERT_EQ(within.size(), 1u);
  EXPECT_EQ(within[0].first, 0);
  EXPECT_EQ(within[0].second, 4);
  EXPECT_FALSE(within[0].at_time2);
}

TEST(SharedPixels, DifferentPointsAreCountedAtEitherTime) {
  // Points at time 1: 1 (three times), 4, 5. Points at time 2: 2, 3 (twice), 6 and 2 of camera 1.
  const GroupedMatches matches =
      Grouped({Of(0, 1, 0, 2), Of(0, 1, 0, 3), Of(0, 4, 0, 3), Of(0, 5, 0, 6), Of(0, 1, 1, 2)});
  const std::vector<SharedPixel> shared = FindSharedPixels(matches);
  EXPECT_EQ(CountDistinctPixels(matches.size(), shared), 3);
  EXPECT_EQ(CountDistinctPixels(2, SharedWithin(shared, {0, 1, 1, 0, 0})), 1);
  EXPECT_EQ(CountDistinctPixels(2, SharedWithin(shared, {1, 0, 0, 1, 0})), 2);
}

FramePair StereoPair(int num_matches, double outlier_share, int index) {
  SceneOptions scene;
  scene.num_matches = num_matches;
  scene.inter_share = 0.5;
  scene.outlier_share = outlier_share;
  FramePair pair = ScenePair(scene, index);
  pair.columns = MatchColumns();
  pair.noise_px.reset();
  return pair;
}

void ExpectSameMotion(const MotionEstimate& a, const MotionEstimate& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.pose.R, b.pose.R);
  EXPECT_EQ(a.pose.t, b.pose.t);
  EXPECT_EQ(a.num_inliers, b.num_inliers);
  ASSERT_EQ(a.refine.covariance.has_value(), b.refine.covariance.has_value());
  if (!a.refine.covariance) return;
  EXPECT_EQ(*a.refine.covariance, *b.refine.covariance);
}

TEST(SharedPixels, RepeatedRowsChangeNothing) {
  for (int index = 0; index < 5; ++index) {
    const FramePair pair = StereoPair(200, 0.2, index);
    const MotionEstimate reference = EstimateMotion(EstimateOptions(), pair);
    FramePair repeated = pair;
    for (int k = 1; k < 10; ++k) {
      repeated.matches.insert(repeated.matches.end(), pair.matches.begin(), pair.matches.end());
    }
    const MotionEstimate e = EstimateMotion(EstimateOptions(), repeated);
    ExpectSameMotion(e, reference);
    // The repeats are inliers as their first is.
    ASSERT_EQ(e.refine.inliers.size(), repeated.matches.size());
    for (size_t k = 0; k < repeated.matches.size(); ++k) {
      EXPECT_EQ(e.refine.inliers[k], reference.refine.inliers[k % pair.matches.size()]);
    }
  }
}

// As some trackers and matchers store what was lost: rows of zeros, or zeros at time 2. More rows
// than true ones, and the motion of those for which an epipole is at (0, 0) fits them all.
TEST(SharedPixels, LostTracksAtZeroAreNoMatches) {
  for (int index = 0; index < 5; ++index) {
    const FramePair pair = StereoPair(200, 0.2, index);
    const MotionEstimate reference = EstimateMotion(EstimateOptions(), pair);
    ASSERT_EQ(reference.status, EstimateStatus::kSuccess);
    FramePair zeros = pair;
    Match zero;
    zero.pixel1.setZero();
    zero.pixel2.setZero();
    zeros.matches.insert(zeros.matches.end(), 400, zero);
    const MotionEstimate with_rows = EstimateMotion(EstimateOptions(), zeros);
    EXPECT_EQ(with_rows.status, EstimateStatus::kSuccess);
    EXPECT_LT(RotationError(with_rows.pose.R, reference.pose.R), reference.refine.rotation_sigma);
    EXPECT_GT(with_rows.refine.rotation_sigma, 0.9 * reference.refine.rotation_sigma);
    EXPECT_LE(std::abs(with_rows.num_inliers - reference.num_inliers), 3);

    FramePair lost = pair;
    Random random = Random::Stream(3, index);
    for (int k = 0; k < 400; ++k) {
      Match m = pair.matches[k % pair.matches.size()];
      m.pixel1 = {random.Uniform(0, 640), random.Uniform(0, 480)};
      m.pixel2.setZero();
      lost.matches.push_back(m);
    }
    ExpectSameMotion(EstimateMotion(EstimateOptions(), lost), reference);
  }
}

// 150 rows, of which 15 are different: as much is known as from these, and no more.
TEST(SharedPixels, CopiesOfAFewRowsAreNoEvidence) {
  int stated = 0, far_off = 0;
  for (int index = 0; index < 20; ++index) {
    const FramePair few = StereoPair(15, 0.0, index);
    FramePair copies = few;
    Random random = Random::Stream(4, index);
    while (copies.matches.size() < 150) copies.matches.push_back(few.matches[random.Index(3)]);
    const MotionEstimate e = EstimateMotion(EstimateOptions(), copies);
    ExpectSameMotion(e, EstimateMotion(EstimateOptions(), few));
    EXPECT_LE(e.num_inliers, 15);
    if (!e.refine.rotation_observable) continue;
    ++stated;
    far_off += RotationError(few.truth->R, e.pose.R) > 4.0 * e.refine.rotation_sigma;
  }
  std::printf("[ measured ] rotation stated in %d of 20, off by four times as much in %d\n", stated,
              far_off);
  EXPECT_LE(far_off, 2);
}

// The scene's rig, truth and points that both cameras see at both times: a point in four rows, in
// the same image and in that of the other camera. `landmark` gets the number of the point of each.
FramePair FourRowsAPoint(int index, std::vector<int64_t>* landmark) {
  SceneOptions scene;
  scene.inter_share = 0.5;
  FramePair pair = ScenePair(scene, index);
  pair.matches.clear();
  pair.columns = {};
  Random random = Random::Stream(5, index);
  const auto noisy = [&](const Pixel& p) {
    const double v = p.y() + 0.5 * random.Normal();
    const double u = p.x() + 0.5 * random.Normal();
    return Pixel(u, v);
  };
  for (int k = 0; k < 300; ++k) {
    const double z = random.Uniform(5, 30);
    const double y = random.Uniform(-4, 4);
    const double x = random.Uniform(-8, 8);
    const Eigen::Vector3d X(x, y, z);
    Pixel first[2], second[2];
    bool seen = true;
    for (int c = 0; c < 2; ++c) {
      const RigCamera& camera = pair.rig.cameras[c];
      seen = seen && Sees(camera, X, &first[c]) && Sees(camera, *pair.truth * X, &second[c]);
    }
    if (!seen) continue;
    const Pixel p0 = noisy(first[0]), p1 = noisy(first[1]);
    const Pixel q0 = noisy(second[0]), q1 = noisy(second[1]);
    for (const auto& [c, p, d, q] : {std::tuple(0, p0, 0, q0), std::tuple(1, p1, 1, q1),
                                     std::tuple(0, p0, 1, q1), std::tuple(1, p1, 0, q0)}) {
      Match m;
      m.camera1 = c;
      m.camera2 = d;
      m.pixel1 = p;
      m.pixel2 = q;
      pair.matches.push_back(m);
      landmark->push_back(k);
    }
  }
  return pair;
}

// The covariance counts the noise of a pixel once.
TEST(SharedPixels, RowsOfOnePointAreCorrelated) {
  double nees = 0.0;
  constexpr int kPairs = 200;
  for (int index = 0; index < kPairs; ++index) {
    std::vector<int64_t> landmark;
    const FramePair pair = FourRowsAPoint(index, &landmark);
    ASSERT_GT(pair.matches.size(), 100u);
    Random start = Random::Stream(6, index);
    Pose pose = StartNear(*pair.truth, 0.05, 0.02, &start);
    const RefineSummary summary =
        Refine(RefineOptions(), pair.rig, pair.matches, MotionPrior(), &pose);
    ASSERT_TRUE(summary.covariance.has_value());
    const Vector6d d = Difference(*pair.truth, pose);
    nees += d.dot(summary.covariance->ldlt().solve(d)) / 6.0 / kPairs;
  }
  std::printf("[ measured ] NEES %.3f\n", nees);
  EXPECT_GT(nees, 0.85);
  EXPECT_LT(nees, 1.2);
}

// Pixels of one point that differ from row to row, as some trackers write them: the column
// `landmark` says what equal pixels would.
TEST(SharedPixels, LandmarksSayWhatPixelsCannot) {
  for (int index = 0; index < 5; ++index) {
    std::vector<int64_t> landmark;
    const FramePair equal = FourRowsAPoint(index, &landmark);
    FramePair moved = equal;
    Random random = Random::Stream(7, index);
    for (Match& m : moved.matches) {
      m.pixel1.x() += 1e-9 * random.Normal();
      m.pixel2.x() += 1e-9 * random.Normal();
    }
    const MotionEstimate reference = EstimateMotion(EstimateOptions(), equal);
    const MotionEstimate unlinked = EstimateMotion(EstimateOptions(), moved);
    moved.columns.landmark = landmark;
    const MotionEstimate linked = EstimateMotion(EstimateOptions(), moved);
    for (const MotionEstimate* e : {&reference, &unlinked, &linked}) {
      ASSERT_EQ(e->status, EstimateStatus::kSuccess);
      ASSERT_TRUE(e->refine.covariance.has_value());
    }
    EXPECT_NEAR(linked.refine.rotation_sigma / reference.refine.rotation_sigma, 1.0, 1e-5);
    EXPECT_GT(std::abs(unlinked.refine.rotation_sigma / reference.refine.rotation_sigma - 1.0),
              0.01);
    // A repeat counts once.
    FramePair repeated = moved;
    repeated.matches.insert(repeated.matches.end(), moved.matches.begin(), moved.matches.end());
    for (size_t k = moved.matches.size(); k < repeated.matches.size(); ++k) {
      repeated.matches[k].pixel1.y() += 1e-9;
    }
    repeated.columns.landmark.insert(repeated.columns.landmark.end(), landmark.begin(),
                                     landmark.end());
    ExpectSameMotion(EstimateMotion(EstimateOptions(), repeated), linked);
  }
}

TEST(SharedPixels, ARefinementOfRepeatedAndLostRowsIsThatOfTheOthers) {
  const FramePair pair = StereoPair(150, 0.0, 3);
  Pose expected = *pair.truth, pose = *pair.truth;
  const RefineSummary alone =
      Refine(RefineOptions(), pair.rig, pair.matches, pair.prior, &expected);
  std::vector<Match> matches = pair.matches;
  matches.insert(matches.end(), pair.matches.begin(), pair.matches.end());
  Match lost;
  for (int k = 0; k < 20000; ++k) {
    lost.pixel2 = {static_cast<double>(k), 0.0};
    matches.push_back(lost);
  }
  const RefineSummary summary = Refine(RefineOptions(), pair.rig, matches, pair.prior, &pose);
  EXPECT_EQ(pose.R, expected.R);
  EXPECT_EQ(pose.t, expected.t);
  EXPECT_EQ(summary.num_inliers, alone.num_inliers);
  ASSERT_EQ(summary.inliers.size(), matches.size());
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    EXPECT_EQ(summary.inliers[k], alone.inliers[k]);
    EXPECT_EQ(summary.inliers[pair.matches.size() + k], alone.inliers[k]);
  }
  EXPECT_EQ(summary.inliers.back(), 0);
}

}  // namespace
}  // namespace rigel
