// Which motions are chained, where a trajectory ends, and what standing still is.
#include "rigel/problems/trajectories/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/random.h"
#include "rigel/problems/io/trajectory_file.h"
#include "rigel/test/core/random_vector.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

struct Drive {
  std::vector<FramePair> pairs;
  std::vector<MotionEstimate> estimates;
  std::vector<char> has_inter;
  std::vector<int> positions;
  std::vector<std::string> notes;

  std::vector<Trajectory> Chain() {
    notes.clear();
    return ChainMotions(pairs, estimates, has_inter, positions, &notes);
  }
};

Drive RandomDrive(int size) {
  Drive drive;
  Random random(3);
  for (int k = 0; k < size; ++k) {
    FramePair pair;
    pair.name = std::to_string(k);
    pair.time1 = 0.1 * k;
    pair.time2 = 0.1 * (k + 1);
    MotionEstimate e;
    e.status = EstimateStatus::kSuccess;
    e.pose.R = ExpSO3(RandomVector3(0.0, 1.0, &random));
    e.pose.t = random.NormalVector3();
    e.raw.R = e.pose.R;
    e.raw.t = 1.1 * e.pose.t;
    e.refine.termination = Termination::kConverged;
    e.refine.rotation_observable = e.refine.translation_observable = true;
    e.refine.scale_observable = true;
    e.refine.length_sigma = 0.01;
    e.refine.parallax_px = 10.0;
    e.refine.parallax_limit_px = 1.0;
    pair.truth = e.pose;
    drive.pairs.push_back(pair);
    drive.estimates.push_back(e);
    drive.has_inter.push_back(1);
  }
  return drive;
}

TEST(Trajectory, PosesAreThoseOfTheChainedMotions) {
  Drive drive = RandomDrive(6);
  const std::vector<Trajectory> chained = drive.Chain();
  EXPECT_THAT(drive.notes, IsEmpty());
  ASSERT_THAT(chained, SizeIs(1));
  ASSERT_THAT(chained[0].estimate, SizeIs(7));
  EXPECT_THAT(chained[0].times, SizeIs(7));
  // A point of the world goes into each frame by the motions, one after the other.
  const Eigen::Vector3d world(1, 2, 3);
  Eigen::Vector3d point = world, raw_point = world;
  for (int k = 0; k <= 6; ++k) {
    if (k > 0) point = drive.estimates[k - 1].pose * point;
    if (k > 0) raw_point = drive.estimates[k - 1].raw * raw_point;
    EXPECT_LT((chained[0].estimate[k] * point - world).norm(), 1e-13);
    EXPECT_LT((chained[0].raw[k] * raw_point - world).norm(), 1e-13);
    EXPECT_LT((chained[0].truth[k] * point - world).norm(), 1e-13);
  }
}

TEST(Trajectory, GapsEndItAndAreTold) {
  Drive drive = RandomDrive(9);
  drive.pairs[1].sequence = drive.pairs[2].sequence = "b";
  for (int k = 3; k < 9; ++k) drive.pairs[k].sequence = "c";
  drive.estimates[4].status = EstimateStatus::kNoSolution;
  drive.pairs[6].time1 = 9.0;
  for (int k = 0; k < 9; ++k) drive.positions.push_back(k < 8 ? k : k + 1);
  const std::vector<Trajectory> chained = drive.Chain();
  std::vector<size_t> first, count;
  for (const Trajectory& t : chained) {
    first.push_back(t.first_pair);
    count.push_back(t.NumPairs());
  }
  EXPECT_THAT(first, ElementsAre(0, 1, 3, 5, 6, 8));
  EXPECT_THAT(count, ElementsAre(1, 2, 1, 1, 2, 1));
  EXPECT_THAT(drive.notes,
              ElementsAre("1: another sequence: the trajectory ended before it",
                          "3: another sequence: the trajectory ended before it",
                          "4: no solution: a gap, the trajectory ends before it",
                          HasSubstr("6: starts at 9 s, the pair before ends at"),
                          "8: a pair is missing before it: the trajectory ended before it"));
}

// Each file may have the stamp of another of the cameras that saw the frame.
TEST(Trajectory, StampsOfOneFrameMayDifferByATenthOfAnInterval) {
  Drive drive = RandomDrive(2);
  drive.pairs[0].time1 = 100.0;
  drive.pairs[0].time2 = 100.05;
  drive.pairs[1].time2 = 100.1;
  for (const double shift : {-0.0045, 1.2e-5, 0.004}) {
    drive.pairs[1].time1 = 100.05 + shift;
    EXPECT_THAT(drive.Chain(), SizeIs(1)) << shift;
    EXPECT_THAT(drive.notes, IsEmpty());
  }
  for (const double shift : {-0.006, 0.006}) {
    drive.pairs[1].time1 = 100.05 + shift;
    EXPECT_THAT(drive.Chain(), SizeIs(2)) << shift;
  }
}

TEST(Trajectory, StandingStillIsNoGapButAnUnknownMotionIs) {
  Drive drive = RandomDrive(4);
  drive.estimates[1].refine.translation_observable = false;
  drive.estimates[1].refine.parallax_px = 0.5;
  std::vector<Trajectory> chained = drive.Chain();
  ASSERT_THAT(chained, SizeIs(1));
  EXPECT_EQ(chained[0].num_still, 1);
  EXPECT_EQ(chained[0].estimate[2].t, chained[0].estimate[1].t);
  EXPECT_GT((chained[0].estimate[2].R - chained[0].estimate[1].R).norm(), 0.01);
  // The wheels say that it moved, the matches not whereto.
  drive.pairs[1].prior.distance = 0.7;
  drive.pairs[1].prior.distance_sigma = 0.01;
  EXPECT_THAT(drive.Chain(), SizeIs(2));
  EXPECT_THAT(drive.notes, ElementsAre(HasSubstr("direction of translation not observable")));
  drive.pairs[1].prior.distance = 0.02;
  EXPECT_THAT(drive.Chain(), SizeIs(1));
  // The matches move, but nothing can be said of t.
  drive.estimates[1].refine.parallax_px = 2.0;
  EXPECT_THAT(drive.Chain(), SizeIs(2));
}

TEST(Trajectory, LengthIsTheEstimatesTheStatedOneOrAGap) {
  Drive drive = RandomDrive(3);
  drive.estimates[1].refine.scale_observable = false;
  drive.estimates[1].refine.length_sigma = 0.4;
  const std::vector<Trajectory> rough = drive.Chain();
  ASSERT_THAT(rough, SizeIs(1));
  EXPECT_EQ(rough[0].num_stated_lengths, 0);
  drive.estimates[1].refine.length_sigma = 0.6;
  EXPECT_THAT(drive.Chain(), SizeIs(2));
  EXPECT_THAT(drive.notes, ElementsAre(HasSubstr("length of translation not determined")));
  // A |t| that was held counts, whatever is known of it.
  drive.estimates[1].refine.length_held = true;
  EXPECT_THAT(drive.Chain(), SizeIs(1));
  drive.estimates[1].refine.length_held = false;
  drive.pairs[1].prior.distance = 2.5;
  for (const bool refined : {true, false}) {
    if (!refined) drive.has_inter[1] = 0;
    if (!refined) drive.estimates[1].refine.termination = Termination::kNotRun;
    const std::vector<Trajectory> stated = drive.Chain();
    ASSERT_THAT(stated, SizeIs(1));
    EXPECT_EQ(stated[0].num_stated_lengths, 1);
    EXPECT_NEAR((stated[0].estimate[2].t - stated[0].estimate[1].t).norm(), 2.5, 1e-12);
    EXPECT_NEAR((stated[0].raw[2].t - stated[0].raw[1].t).norm(), 2.5, 1e-12);
  }
}

TEST(Trajectory, TruthAndTimesAreOfAllPairsOrNone) {
  Drive drive = RandomDrive(3);
  drive.pairs[2].truth.reset();
  EXPECT_THAT(drive.Chain()[0].truth, IsEmpty());
  drive.pairs[2].time1.reset();
  drive.pairs[2].time2.reset();
  EXPECT_THAT(drive.Chain()[0].times, IsEmpty());
  // Backwards in time: a trajectory, but no time stamps that TUM's tools take.
  Drive back = RandomDrive(2);
  std::swap(back.pairs[1].time1, back.pairs[1].time2);
  back.pairs[1].time1 = back.pairs[0].time2;
  back.pairs[1].time2 = 0.05;
  ASSERT_THAT(back.Chain(), SizeIs(1));
  EXPECT_THAT(back.Chain()[0].times, IsEmpty());
}

TEST(TrajectoryFile, NamesAreNumberedBeforeTheExtension) {
  EXPECT_EQ(TrajectoryPath("a/b.txt", 0, 1, false), "a/b.txt");
  EXPECT_EQ(TrajectoryPath("a/b.txt", 2, 3, false), "a/b_2.txt");
  EXPECT_EQ(TrajectoryPath("a.d/b", 2, 3, true), "a.d/b_truth_2");
  EXPECT_EQ(TrajectoryPath("b.txt", 0, 1, true), "b_truth.txt");
}

TEST(TrajectoryFile, LinesAreAsTheToolsReadThem) {
  Pose pose;
  pose.R = RotationY(0.5);
  pose.t = {1, -2, 0.1};
  EXPECT_EQ(FormatKittiTrajectory({Pose()}), "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(FormatTumTrajectory({Pose()}, {12.5}, BodyAxes()),
            "# body: down +y, forward +z\n12.5 0 0 0 0 0 0 1\n");
  const BodyAxes z_up = {{0, 0, -1}, {1, 0, 0}};
  EXPECT_THAT(FormatTumTrajectory({Pose()}, {}, z_up),
              testing::StartsWith("# body: down -z, forward +x\n# no times"));
  EXPECT_THAT(FormatTumTrajectory({Pose(), pose}, {}, BodyAxes()),
              HasSubstr("\n1 1 -2 0.1 0 0.247"));
}

}  // namespace
}  // namespace rigel
