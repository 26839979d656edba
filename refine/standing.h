// The model of a rig that stands: a rotation alone.
//
// Where the points move by no more than their noise, epipolar errors fit any direction of t, and
// what they leave free costs accuracy of the rotation. Of a rig that stands the rotation alone
// moves the points of each camera, whatever their depth: both components of a pixel say what it is.
#ifndef RIGEL_REFINE_STANDING_H_
#define RIGEL_REFINE_STANDING_H_

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/core/prior.h"
#include "rigel/refine/fit.h"
#include "rigel/refine/least_squares/least_squares.h"

namespace rigel {

struct StandingMotion {
  Pose pose;
  // Of (d, e) of R <- Exp(d) R, t <- t + e. Matches of one camera limit t by their pixels, at
  // kStandingDepth.
  Matrix6d covariance = Matrix6d::Zero();
  std::vector<char> inliers;  // grouped order
  int num_inliers = 0;
};

// How far the points of a rig that stands are, typical lengths (RefineSettings): far ones for what
// they say of t, near ones for cameras off the body's origin, which move where the body turns. What
// is stated is then rather too large.
inline constexpr double kStandingDepth = 50.0;
inline constexpr double kNearDepth = 7.0;

// A body whose origin is so near its cameras turns about it on the spot; others about the centre of
// the rig. Typical lengths.
inline constexpr double kMaxPivot = 10.0;

// True if no distance is stated that contradicts it: one of more than kStillMetres and three sigma.
bool MayStand(const MotionPrior& prior);
inline constexpr double kStillMetres = 1e-2;  // odometry of a car that stands is within

// From the fit of the full model: its rotation, noise, gates and inliers. `point` of the body is
// the origin of the matches' frame, whose motion it is. Nothing if the points of some camera move
// by more than the rotation. What they move by less, in all or because the body turns on the spot,
// is in the covariance.
std::optional<StandingMotion> FitStanding(const GroupedMatches& matches,
                                          const std::vector<SharedPixel>& shared,
                                          const Eigen::Vector3d& point, const Fit& fit,
                                          LossKind loss, double loss_scale_sigmas,
                                          double typical_length);

}  // namespace rigel

#endif  // RIGEL_REFINE_STANDING_H_
