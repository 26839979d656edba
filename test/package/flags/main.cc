// What a program exchanges with the library: sizes, an estimate with its covariance, factors, cost
// functions. Prints the sizes, which are to be the same whatever the flags. Exit 0 if every check
// holds.
#include <cstdio>
#include <memory>
#include <string>

#include <ceres/cost_function.h>

#include <Eigen/Core>

#include "rigel/problems/scenes/synthetic.h"
#include "rigel/refine/between_factor.h"
#include "rigel/refine/epipolar_cost.h"
#include "rigel/refine/estimate_motion.h"

namespace {

int failures = 0;

void Check(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "failed: %s\n", what);
  ++failures;
}

template <class T>
void PrintSize(const char* name) {
  std::printf("%s %zu %zu\n", name, sizeof(T), alignof(T));
}

}  // namespace

int main() {
  PrintSize<rigel::Match>("Match");
  PrintSize<rigel::Pose>("Pose");
  PrintSize<rigel::FramePair>("FramePair");
  PrintSize<rigel::MotionPrior>("MotionPrior");
  PrintSize<rigel::RefineSummary>("RefineSummary");
  PrintSize<rigel::MotionEstimate>("MotionEstimate");
  PrintSize<rigel::BetweenFactor>("BetweenFactor");

  rigel::SceneOptions scene;
  scene.inter_share = 0.5;
  rigel::FramePair pair;
  std::string error;
  Check(rigel::MakeScenePair(scene, 0, &pair, &error), "a scene");

  const rigel::MotionEstimate estimate = rigel::EstimateMotion(rigel::EstimateOptions(), pair);
  Check(estimate.HasMotion(), ("a motion: " + estimate.message).c_str());
  Check(estimate.refine.covariance.has_value(), "a covariance");
  if (failures > 0) return 1;

  // Eigen's own types to the library and back.
  const Eigen::Quaterniond q = estimate.pose.Quaternion();
  const rigel::Pose again = rigel::Pose::FromQuaternion(q, estimate.pose.t);
  Check((again.R - estimate.pose.R).norm() < 1e-12, "a quaternion there and back");
  const Eigen::Vector2d pixel = pair.matches[0].pixel1;
  Check(AlongRay(pair.rig.cameras[0].intrinsics, pixel).allFinite(), "a pixel");
  const Eigen::Matrix<double, 6, 6> covariance = *estimate.refine.covariance;
  Check((covariance - covariance.transpose()).norm() <= 1e-9 * covariance.norm(),
        "it is symmetric");

  const rigel::Matrix6d information = rigel::InformationMatrix(estimate.refine, estimate.pose);
  const rigel::Matrix6d root = rigel::SqrtInformation(information);
  Check((root.transpose() * root - information).norm() <= 1e-6 * information.norm(), "a root");
  const rigel::BetweenFactor factor = rigel::G2oEdge(estimate.pose, estimate.refine);
  Check(factor.information.allFinite() && factor.covariance.allFinite(), "a factor");

  rigel::RefineOptions options;
  options.threshold_px = 3.0;
  rigel::Pose pose = estimate.pose;
  const rigel::RefineSummary refined =
      rigel::Refine(options, pair.rig, pair.matches, pair.prior, &pose);
  Check(refined.IsSolutionUsable(), "a refinement");

  const std::unique_ptr<ceres::CostFunction> cost(rigel::MakeRelativeEpipolarCost(
      pair.rig, pair.matches[0], 0.5, rigel::QuaternionOrder::kEigen));
  const double* const blocks[] = {q.coeffs().data(), estimate.pose.t.data()};
  double residual = 0.0, dq[4], dt[3];
  double* jacobians[] = {dq, dt};
  Check(cost != nullptr && cost->Evaluate(blocks, &residual, jacobians), "a cost function");
  return failures == 0 ? 0 : 1;
}
