// What contradicts the rig's calibration: matches that do not fit at all, described in messages for
// the user, and a test whether the cameras are turned against each other as the rig says. They do
// not change an estimate.
//
// A turn of a camera that the rig does not know leaves residuals that no motion explains. The score
// of a turn is the derivative of the cost by it at the fitted motion. It is zero in the mean if the
// rig is right. Scores of frame pairs add up, so that a run shows errors that are far below the
// noise of one pair.
//
// A turn d is that of a camera in its own frame, Q <- Q Exp(d): pitch about x, yaw about y, roll
// about z. It is that by which the camera is turned against what the rig says. Turns are relative
// to camera 0: turning all cameras together is a motion.
#ifndef RIGEL_REFINE_RIG_DOUBTS_H_
#define RIGEL_REFINE_RIG_DOUBTS_H_

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace rigel {

struct FramePair;
struct RefineSummary;

enum class RigDoubtKind {
  kFrozen,   // camera1 shows the same image twice
  kFewFit,   // few of the matches between camera1 and camera2 fit
  kSwapped,  // more would fit if the two were swapped
  kNoRays,   // many pixels have no ray through their lens; the cameras are not said
};

// One contradiction between the matches of a frame pair and its rig.
struct RigDoubt {
  RigDoubtKind kind = RigDoubtKind::kFewFit;
  int camera1 = 0;  // at most camera2
  int camera2 = 0;
  std::string message;  // "cameras 0-1: 12 of 760 fit; are they swapped, ..."
};

// Camera pairs with fewer matches are not judged.
inline constexpr int kMinDoubtRows = 20;
// Few matches of a camera pair fit if their share is below this part of the largest share, ...
inline constexpr double kFewFit = 0.25;
// ... and the largest share is at least this.
inline constexpr double kMostFit = 0.4;

// Finds the contradictions after a refinement (`refine`), in this order:
//   - A frozen camera: nearly all of its intra-camera matches move by less than kMinMatchNoisePx
//     (times PixelUnit()), and half of those of another camera move by more than ten times that.
//   - Matches between two cameras, or of one camera, of which far fewer fit than of others.
//   - Two cameras with which more matches fit if they are swapped: their poses, or their poses and
//     intrinsics. This is tried if the matches between them do not fit. It is also tried if they
//     fit and |t| is still not determined although the rig moves. A motion so long that no baseline
//     matters then hides a baseline of the wrong sign.
// `length_is_open`: nothing but the matches could say |t|.
// If `prior_is_doubted`, the prior may be the reason that few matches fit. That is then not
// reported.
// `inliers_with` estimates the motion of a pair again and returns the number of inliers, 0 if there
// is no motion. kMaxSwapIterations of RANSAC are enough for it.
inline constexpr int kMaxSwapIterations = 500;
std::vector<RigDoubt> FindRigDoubts(const FramePair& pair, bool length_is_open,
                                    bool prior_is_doubted, const RefineSummary& refine,
                                    const std::function<int(const FramePair&)>& inliers_with);

// Of the turns (radians) of cameras 1, 2, ..., three each. The motion is eliminated: to first order
// an error of it changes nothing. Empty if there is nothing to test: one camera, or no minimum.
struct RigScore {
  int num_pairs = 0;
  Eigen::VectorXd gradient;     // of the cost
  Eigen::MatrixXd information;  // the curvature of the cost
  Eigen::MatrixXd variance;     // of the gradient, by the noise of the matches
  // The derivatives of the gradient by the stated errors of the calibration (RigCamera), each times
  // its sigma. Without columns if none is stated.
  Eigen::MatrixXd by_calibration;

  bool empty() const { return num_pairs == 0; }
};

// Radians. A turn that the matches do not determine to kMaxTurnSigmaDeg is not looked at.
struct CameraTurn {
  int camera = 1;
  std::array<std::optional<double>, 3> turn, sigma;  // pitch, yaw, roll; sigma of the noise
  // How likely chance makes a turn as large, as in RigTest.
  double p = 1.0;
  double p_with_calibration = 1.0;
};
inline constexpr double kMaxTurnSigmaDeg = 1.0;

struct RigTest {
  int num_pairs = 0;
  int degrees_of_freedom = 0;  // turns that are determined; 0: nothing is tested
  double chi2 = 0.0;
  // How likely the noise of the matches makes a score as large if the rig is right, ...
  double p = 1.0;
  // ... and how likely the noise does so together with the stated errors of the calibration, and
  // turns of kUsualTurnDeg for each axis, of which no calibration is free.
  double p_with_calibration = 1.0;
  std::vector<CameraTurn> cameras;  // with a turn that is determined
};
inline constexpr double kUsualTurnDeg = 0.002;

RigTest TestRig(const RigScore& score);

// The sum over the frame pairs of a run in their order, all of one rig. Errors that the matches of
// a pair have in common are not in its variance. So the variance of the sum is measured, too: by
// how the scores of the pairs scatter about the turns of the run. Pairs that follow each other may
// scatter alike. Pairs that are far off count less. A score of another shape is left out.
RigScore ScoreOfRun(const std::vector<RigScore>& scores);

}  // namespace rigel

#endif  // RIGEL_REFINE_RIG_DOUBTS_H_
