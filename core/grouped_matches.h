// The matches of a frame pair sorted by camera pair, ready for scoring: one fundamental matrix
// serves a whole group.
#ifndef RIGEL_CORE_GROUPED_MATCHES_H_
#define RIGEL_CORE_GROUPED_MATCHES_H_

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/match.h"
#include "rigel/core/match_columns.h"
#include "rigel/core/pose.h"
#include "rigel/core/rays.h"
#include "rigel/core/rig.h"
#include "rigel/core/row_arrays.h"
#include "rigel/core/row_point.h"
#include "rigel/core/score_kernel.h"

namespace rigel {

// Matches [begin, begin + size) of camera1 at time 1 and camera2 at time 2.
struct MatchGroup {
  int camera1 = 0;
  int camera2 = 0;
  int begin = 0;
  int size = 0;
};

class GroupedMatches {
 public:
  GroupedMatches() = default;
  // `matches` must name cameras of `rig` only and have finite pixels. Copies what it needs. A match
  // is left out if one of its pixels has no ray (camera.h): it is no match under any motion.
  // Of `columns`, sigma1, sigma2 and landmark are used: with sigmas all errors are those that a
  // pixel of the median sigma would have.
  // `interval` is the time between the views, seconds; 0 if it is not known, and the time offsets
  // of the cameras are then left out.
  GroupedMatches(const Rig& rig, const std::vector<Match>& matches,
                 const MatchColumns& columns = {}, double interval = 0.0);

  // The same matches with the origin of the rig's body frame moved (rig_centre.h).
  GroupedMatches WithOrigin(const Eigen::Vector3d& origin) const;

  const Rig& rig() const { return rig_; }
  int size() const { return static_cast<int>(matches_.size()); }
  int num_given() const { return num_given_; }  // with those that were left out
  const std::vector<MatchGroup>& groups() const { return groups_; }

  // In grouped order; within a group in the order of the input.
  const std::vector<Match>& matches() const { return matches_; }
  // Empty if they are not known.
  const std::vector<int64_t>& landmarks() const { return landmarks_; }

  // At most `count` of the matches, evenly spaced in their order. original() is then the position
  // in the subset.
  GroupedMatches EvenSubset(size_t count) const;
  // The same number, but drawn at random: the order is cut into `count` parts of the same size, and
  // one match is drawn from each. For matches whose kinds alternate: EvenSubset() could take one
  // kind only. The draw is the same in each call.
  GroupedMatches DrawnSubset(size_t count) const;

  // Where the cameras of a group are if the rig moves by `pose`. A = Q U takes the points of rows
  // (row_point.h) to directions in the body frame; with `of_rays` it is Q alone. These are those of
  // the rig, except if a camera fires a share a of the interval later. The rig moves with
  // constant velocity, so both views are then those of a camera at PartOfMotion(pose, -a) (Q, s).
  struct Places {
    Eigen::Matrix3d A1, A2;
    Eigen::Vector3d s1, s2;
  };
  Places PlacesOf(const MatchGroup& group, const Pose& pose, bool of_rays) const;
  // True if a camera fires at another time. How its place changes with the motion: (d, e) of
  // Q <- Exp(d) Q, s <- s + e by those of the motion.
  bool HasTimes() const { return !later_.empty(); }
  Matrix6d PlaceByMotion(int camera, const Pose& pose) const;

  // Position in the input of the match at grouped position k.
  int original(int k) const { return original_[k]; }

  // Points and derivatives of a group.
  RowArrays Rows(const MatchGroup& group) const;

  // Those of the match at grouped position k.
  RowPoint Point1(int k) const { return PointAt(k, 0); }
  RowPoint Point2(int k) const { return PointAt(k, 1); }

  // Directions of a group's rays.
  RayArrays Directions(const MatchGroup& group) const;

  // What the depths of a group depend on under `pose`; they are undecided below DecidedParallax().
  GroupMotion MotionOf(const MatchGroup& group, const Pose& pose, double threshold_px) const;

  // F = U_j' E U_i of the group under `pose`; of pinholes the centred fundamental matrix.
  Eigen::Matrix3d Fundamental(const MatchGroup& group, const Pose& pose) const;

  // MSAC score: sum min(r^2, threshold^2) of the Sampson errors, pixels^2. Once it exceeds `bound`
  // the rest is not looked at: the value returned is then above `bound`, but not the score.
  // `num_inliers` may be null: counting takes time.
  double Score(const Pose& pose, double threshold_px, double bound, int* num_inliers) const;

  // The same, but a match whose point lies behind a camera counts as an outlier too. An outlier
  // with a large leverage can pull the motion until it fits. About half of these would then lie
  // behind a camera. Never below Score(), to the last bit.
  double ScoreInFront(const Pose& pose, double threshold_px, double bound, int* num_inliers) const;

  // 1 for matches of a Sampson error below the threshold that do not lie behind a camera, else 0,
  // in grouped order; returns their number. `errors` gets the squared Sampson errors. Both are
  // resized.
  int SelectInliers(const Pose& pose, double threshold_px, std::vector<double>* errors,
                    std::vector<char>* inliers) const;

  // The rays of the match at grouped position k in the body frames.
  RayPair rays(int k) const;

  // The angle of a pixel of the group's camera with the shorter focal length, radians.
  double RadiansPerPixel(const MatchGroup& group) const;

  // The sine of the parallax above which depths of the group are decided: noise of this threshold
  // cannot cause a larger one.
  double DecidedParallax(const MatchGroup& group, double threshold_px) const;

  // Squared Sampson errors in grouped order, pixels^2; `errors` is resized.
  void SquaredErrors(const Pose& pose, std::vector<double>* errors) const;

 private:
  // Where `count` stretches of the order begin, and the end.
  std::vector<size_t> StretchBegins(size_t count) const;
  GroupedMatches Subset(const std::vector<size_t>& taken) const;
  RowPoint PointAt(int k, int side) const;
  void SetTimes(double interval);
  // Of n matches; `factor` times its derivatives.
  void SetPoint(size_t k, int side, const RowPoint& point, double factor, size_t n);

  Rig rig_;
  std::vector<MatchGroup> groups_;
  std::vector<Match> matches_;
  std::vector<int64_t> landmarks_;
  std::vector<int> original_;
  int num_given_ = 0;
  std::vector<Eigen::Matrix3d> unproject_;  // Q U of each camera
  std::vector<double> later_;               // a of each camera; empty if all are zero
  // x1 of all, then y1, x2, y2, and what RowArrays::general says, if that is needed; the six
  // coordinates of the directions likewise.
  std::vector<double> rows_, directions_;
  bool general_ = false;
};

}  // namespace rigel

#endif  // RIGEL_CORE_GROUPED_MATCHES_H_
