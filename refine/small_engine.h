// Least squares on few parameters without building a ceres::Problem: local optimization inside
// RANSAC, where that would dominate.
#ifndef RIGEL_REFINE_SMALL_ENGINE_H_
#define RIGEL_REFINE_SMALL_ENGINE_H_

#include <memory>
#include <vector>

#include "rigel/core/pose.h"
#include "rigel/refine/epipolar_residuals.h"
#include "rigel/refine/loss.h"

namespace rigel {

struct SmallEngineOptions {
  LossKind loss = LossKind::kTruncated;
  double loss_scale = 1.5;  // in the residual's unit
  int max_num_iterations = 4;
  // TranslationForm::kInverseScale instead of a free t: for matches that hardly determine |t|.
  bool inverse_scale = false;
};

// Levenberg-Marquardt (ceres::TinySolver) over rotation and translation. TinySolver knows no loss
// and no manifold: the loss is folded into the residuals (r sqrt(rho(r^2)) / |r|) and the update is
// local to the start. Keeps its memory from call to call: no heap after the first.
class SmallEngine {
 public:
  explicit SmallEngine(const EpipolarResiduals& residuals);
  ~SmallEngine();
  SmallEngine(const SmallEngine&) = delete;
  SmallEngine& operator=(const SmallEngine&) = delete;

  // Over the matches with mask[k] != 0 (grouped order; as many as the residuals). False, and `pose`
  // unchanged, if no step lowers the cost or the result is not finite.
  bool Minimize(const SmallEngineOptions& options, const std::vector<char>& mask, Pose* pose);

  int num_iterations() const;  // of the last call

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_SMALL_ENGINE_H_
