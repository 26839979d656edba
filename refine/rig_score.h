// Tests the calibration of a rig by the matches: are the cameras turned against each other as the
// rig says?
//
// A turn of a camera that the rig does not know leaves residuals that no motion explains. The score
// of a turn is the derivative of the cost by it at the fitted motion. It is zero in the mean if the
// rig is right (a score test, without another fit). Scores of pairs of frames add up, so that a run
// shows errors that are far below the noise of one pair.
//
// A turn d is that of a camera in its own frame, Q <- Q Exp(d): pitch about x, yaw about y, roll
// about z. With z forward and y down the camera looks up, to the right, and tilts to the right if
// they are positive. Turns are relative to camera 0: turning all cameras together is a motion.
#ifndef RIGEL_REFINE_RIG_SCORE_H_
#define RIGEL_REFINE_RIG_SCORE_H_

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace rigel {

// Of the turns (radians) of cameras 1, 2, ..., three each. The motion is eliminated: to first order
// a wrong motion changes none of it. Empty if there is nothing to test: one camera, no minimum.
struct RigScore {
  Eigen::VectorXd gradient;     // of the cost; its negative leads to the turns
  Eigen::MatrixXd information;  // the curvature of the cost
  Eigen::MatrixXd variance;     // of the gradient, if the rig is right
  // The derivatives of the gradient by the stated errors of the calibration, each times its sigma.
  // Without columns if no error is stated.
  Eigen::MatrixXd by_calibration;
  int num_pairs = 0;

  bool empty() const { return num_pairs == 0; }
};

// The turn of a camera, against camera 0, that the matches ask for; radians.
struct CameraTurn {
  int camera = 1;
  // Pitch, yaw, roll; nothing where the matches do not determine it to kMaxTurnSigmaDeg.
  std::array<std::optional<double>, 3> turn, sigma;
  double p = 1.0;  // that noise makes a turn of this size
};
inline constexpr double kMaxTurnSigmaDeg = 1.0;

// Of a score: how likely noise makes one as large if the rig is right.
struct RigTest {
  int num_pairs = 0;
  int degrees_of_freedom = 0;  // turns that are determined; 0: nothing is tested
  double chi2 = 0.0;
  double p = 1.0;
  // The same if the stated errors of the calibration count as noise; nothing if none are stated.
  std::optional<double> p_with_calibration;
  std::vector<CameraTurn> cameras;  // that have a turn that is determined
};
RigTest TestRig(const RigScore& score);

// The sum over the pairs of a run, all of one rig. Matches of a pair may have errors in common that
// its variance does not know: the variance of the sum is that by which the scores of the pairs
// scatter about the turns of the run, if that is more. Pairs that are far off count less.
RigScore ScoreOfRun(const std::vector<RigScore>& pairs);

// Internal: score.variance, which is that of a model, mixed with one that was measured. The model has
// the right shape, and the measured one the right size, for noise that is of another kind. With
// `share` 1, half is q times the model, where q is the mean ratio of the two, and half is what was
// measured; with 0 it is the model.
Eigen::MatrixXd BlendedVariance(const RigScore& score, const Eigen::MatrixXd& measured,
                                double share);

}  // namespace rigel

#endif  // RIGEL_REFINE_RIG_SCORE_H_
