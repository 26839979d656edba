// The Cramer-Rao bound of a frame pair: a lower bound on the errors of any unbiased estimate.
#ifndef RIGEL_PROBLEMS_EVALUATION_CRAMER_RAO_H_
#define RIGEL_PROBLEMS_EVALUATION_CRAMER_RAO_H_

#include <optional>

#include "rigel/core/eigen_types.h"
#include "rigel/core/frame_pair.h"
#include "rigel/refine/refine.h"

namespace rigel {

struct CramerRaoBound {
  double rotation = 0.0;        // sqrt(trace) of the rotation's 3x3 block, radians
  double direction = 0.0;       // of the translation's block projected off t, over |t|, radians
  double relative_scale = 0.0;  // of |b| (rig_centre.h), all else free; infinite if not determined
  Matrix6d covariance;
};
static_assert(kSameLayoutEverywhere<CramerRaoBound>, "no member of CramerRaoBound may be aligned");

// sigma^2 (J'J)^-1 at the true motion over the parameters that `options.form` frees (for kFull, b
// of FittedPoint() on the sphere where scale is not observable), J of the Sampson residuals of the
// inliers there (SelectPlausibleInliers with the gate of the refinement), sigma the pair's
// noise_px. options.use_prior adds the prior's information. Nothing if the pair lacks truth or
// noise_px, or the information is singular.
std::optional<CramerRaoBound> ComputeCramerRaoBound(const RefineOptions& options,
                                                    const FramePair& pair);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_CRAMER_RAO_H_
