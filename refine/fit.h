// A fit of a motion to the matches of a frame pair, and one step to a better one.
#ifndef RIGEL_REFINE_FIT_H_
#define RIGEL_REFINE_FIT_H_

#include <functional>
#include <string>
#include <vector>

#include "rigel/core/alignment.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/core/prior.h"
#include "rigel/core/stop.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/least_squares/prior_residuals.h"
#include "rigel/refine/least_squares/small_engine.h"
#include "rigel/refine/refine.h"
#include "rigel/refine/search/noise_model.h"
#include "rigel/refine/search/shared_pixels.h"

namespace rigel {

// A motion with everything that was chosen at it. Vectors are in grouped order.
struct Fit {
  Pose pose;  // of the fitted point, the origin of the matches' body frame
  MatchErrors errors;
  NoiseModel noise;
  Pose judged;  // where Select() took errors and noise
  std::vector<char> inliers;
  int num_inliers = 0;
  // Factors of the residuals besides 1 / sigma: EpipoleWeights(), and 0 for no inlier.
  std::vector<double> factors;
};

// Makes fits to the same matches. Everything that does not depend on the motion is prepared once.
class Fitter {
 public:
  // `matches` with the origin of the body frame at `point` of the body. options.threshold_px is
  // resolved; with `gate_follows_noise` it is only the first gate. All must outlive this object.
  Fitter(const RefineOptions& options, bool gate_follows_noise, const GroupedMatches& matches,
         const Eigen::Vector3d& point, const MotionPrior& prior);

  // False with a message if the prior that the form takes as exact is not there.
  bool Prepare(std::string* error);

  bool PriorIsExact() const;
  bool HasReference() const;  // the depth forms
  bool HoldsLength() const { return options_.hold_distance; }

  // Chooses errors, noise, inliers and factors at fit->pose. With `exclude_implausible` the motion
  // must be the minimum over the present inliers (inlier_selection.h). True if enough
  // changed for another fit.
  bool Select(bool exclude_implausible, Fit* fit);

  // Minimizes over the inliers of `fit` with its factors, from its motion. Sets the motion; adds
  // costs and iterations to `summary`, and sets its termination. False with a termination and a
  // message if there is no solution. `last`: to the last digit.
  bool FitOnce(bool last, Fit* fit, RefineSummary* summary);

  // True if another reference match of the depth forms would be chosen at `fit`. One that was
  // chosen at a poor start holds the motion there, as its rays are taken as exact.
  bool ReferenceIsStale(const Fit& fit) const;

  // The residuals of the prior about `start`, and their information at `pose`.
  PriorResiduals PriorAt(const Pose& start) const;
  Matrix6d PriorInformation(const Pose& pose) const;
  // Information of the matches at the fit, without robust factors.
  Matrix6d MatchInformation(const Fit& fit) const;
  // The directions in which the motion is free.
  MotionBasis FreeDirections(const Pose& pose) const;
  // Limit of |b|, metres.
  double max_length() const { return max_length_; }
  // The matches that share pixels, and the number of different pixels.
  const std::vector<SharedPixel>& shared() const { return shared_; }

  Stop* stop() { return &stop_; }

 private:
  TranslationForm Translation() const;
  int ChooseReference(const Fit& fit, RotationForm rotation) const;
  void SetFactors(const std::vector<double>& of_all, Fit* fit) const;
  std::vector<double> FactorsOfAll(const Fit& fit) const;
  std::vector<double> EngineWeights(const Fit& fit) const;

  const RefineOptions& options_;
  const GroupedMatches& matches_;
  const Eigen::Vector3d point_;
  const MotionPrior& prior_;
  const double pixel_unit_;
  NoiseOptions noise_options_;
  PriorParts parts_;
  double min_length_ = 0.0;
  double max_length_ = 0.0;
  Alignment alignment_;
  std::vector<SharedPixel> shared_;
  SmallEngine engine_;
  Stop stop_;
  int round_ = 0;
  const std::function<void(int, double)> progress_;  // options_.progress of the round
  int reference_match_ = -1;                         // of the depth forms, grouped order
};

// Median |Sampson error| of the inliers, pixels; -1 without inliers.
double MedianResidual(const Fit& fit);
// Of a sample of one camera pair, with the sign of x_j . (b x R x_i); 0 without inliers.
double SignedMedianResidual(const GroupedMatches& matches, const MatchGroup& group, const Fit& fit);

}  // namespace rigel

#endif  // RIGEL_REFINE_FIT_H_
