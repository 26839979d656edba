// Trajectories: motions of consecutive frame pairs, chained.
//
// A trajectory's poses are world_from_body, the world being the body frame of its first frame, as
// KITTI has it: the motion T_f2_f1 of a pair leads from pose k to pose k+1 = pose k * T_f2_f1^-1.
#ifndef RIGEL_PROBLEMS_TRAJECTORIES_TRAJECTORY_H_
#define RIGEL_PROBLEMS_TRAJECTORIES_TRAJECTORY_H_

#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/pose.h"
#include "rigel/refine/estimate_motion.h"

namespace rigel {

// Time stamps of one frame in two files differ by no more than one of these: seconds, or a share of
// the shorter of the two pairs. Cameras of one frame may have stamps of their own.
inline constexpr double kSameTimeSeconds = 1e-6;
inline constexpr double kSameTimeShare = 0.1;

// True if a refined motion has a length: its relative standard deviation is at most kMaxLengthSigma
// (between_factor.h), or |t| was held.
bool KnowsLength(const RefineSummary& refine);

// True if the matches say that the rig stands, or that |t| is consistent with zero, and the pair
// states no distance that contradicts this (MayStand(), standing.h).
bool StandsStill(const FramePair& pair, const RefineSummary& refine);

// The motion with the rotation of `pose` that leaves the rig's centre where it is. If the centre is
// the body's origin, t = 0.
Pose Standing(const Pose& pose, const RefineSummary& refine);

// Why pair k, k > 0, does not start where pair k - 1 ended; empty if it does. There are three
// reasons: a pair is missing between them (by `positions`, see ChainMotions()), they are of
// different sequences, or pair k starts at another time than pair k - 1 ends. If a time is not
// stated, the times are not compared.
std::string WhyNotNext(const std::vector<FramePair>& pairs, const std::vector<int>& positions,
                       size_t k);

// The poses of the pairs first_pair to first_pair + NumPairs() - 1. Element k of each list that is
// not empty belongs to the same frame.
struct Trajectory {
  std::string sequence;
  size_t first_pair = 0;
  std::vector<double> times;   // seconds, one a pose; empty if they are missing or not ascending
  std::vector<Pose> estimate;  // of MotionEstimate::pose: refined where that was asked for
  std::vector<Pose> raw;       // of MotionEstimate::raw
  std::vector<Pose> truth;     // empty unless all of its pairs have one
  int num_still = 0;           // pairs whose |t| is consistent with zero: taken as zero
  int num_stated_lengths = 0;  // pairs whose |t| is the distance that they state

  size_t NumPairs() const { return estimate.size() - 1; }
};

// Chains the motions. `pairs` and `estimates` go together; `positions` has the place of each pair
// in the drive, increasing, or is empty where they follow each other. A trajectory ends
//   - at a pair that does not follow the one before (WhyNotNext);
//   - at a pair that has no motion, or none with a length: not estimated or not refined, rotation
//     or direction of t not observable, |t| not determined (KnowsLength()) and
//     no distance stated. That pair is in none.
// Standing still is no gap: StandsStill() makes a Standing() step. Without a refinement |t| counts
// as determined where the hypothesis has a scale and matches between cameras, which `has_inter`
// tells of each pair. A raw motion without a length of its own has that of the estimate.
//
// Each gap is told in one line of printable text in *notes.
std::vector<Trajectory> ChainMotions(const std::vector<FramePair>& pairs,
                                     const std::vector<MotionEstimate>& estimates,
                                     const std::vector<char>& has_inter,
                                     const std::vector<int>& positions,
                                     std::vector<std::string>* notes);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_TRAJECTORIES_TRAJECTORY_H_
