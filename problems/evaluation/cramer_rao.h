// The Cramer-Rao bound of a frame pair: a lower bound on the errors of any unbiased estimate.
#ifndef RIGEL_PROBLEMS_EVALUATION_CRAMER_RAO_H_
#define RIGEL_PROBLEMS_EVALUATION_CRAMER_RAO_H_

#include <optional>

#include "rigel/core/eigen_types.h"
#include "rigel/core/frame_pair.h"
#include "rigel/refine/refine.h"

namespace rigel {

struct CramerRaoBound {
  double rotation = 0.0;       // sqrt(trace) of the rotation's 3x3 block, radians
  double direction = 0.0;      // of the translation's block projected off t, over |t|, radians
  double rig_direction = 0.0;  // the same of b, the motion of the rig's centre (rig_centre.h)
  // Of |b|, all else free, without the weak length; infinite if not determined.
  double relative_scale = 0.0;
  Matrix6d covariance;
};
static_assert(kSameLayoutEverywhere<CramerRaoBound>, "no member of CramerRaoBound may be aligned");

// The inverse of the information of the true inliers at the true motion, over all six parameters
// (what is known exactly left out: the prior with kPrior and kPriorDepths, |t| with
// hold_distance).
//
// Information: J'J / sigma^2, J of the Sampson errors, sigma the pair's noise_px. Matches that
// share a pixel are weighted by the inverse of the covariance of their errors, so a match that is
// repeated counts once. To it come the weak length, the distance of the pair's prior if it has a
// sigma, and, with options.use_prior, the rest of the prior.
//
// The inliers are those of columns.inlier; else the matches with an error below kBoundSigmas sigma
// that are in front of their cameras. J is that of columns.exact; else what the noise of the
// measured pixels adds is subtracted (noise_information.h).
//
// Nothing if the pair lacks truth or noise_px, or the information is singular. Nor if more than a
// quarter of it in any direction is subtracted, which holds to second order only, or if more than
// kMaxLinkedMatches are linked by the pixels they share.
std::optional<CramerRaoBound> ComputeCramerRaoBound(const RefineOptions& options,
                                                    const FramePair& pair);

// Of Gaussian errors one in 6000 is larger.
inline constexpr double kBoundSigmas = 3.75;
// The time grows with the third power.
inline constexpr int kMaxLinkedMatches = 300;

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_CRAMER_RAO_H_
