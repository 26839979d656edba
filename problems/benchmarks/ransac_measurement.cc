#include "rigel/problems/benchmarks/ransac_measurement.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "rigel/core/angles.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/metrics.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/core/statistics.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/benchmarks/opengv_peers.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/evaluation/cramer_rao.h"

namespace rigel {
namespace {

// Runs of a pair. The fastest counts, as disturbances only add time.
constexpr int kRepetitions = 3;
// Multiples of the Cramer-Rao bound (1 sigma) of the rotation. Noise alone seldom exceeds three.
constexpr double kSuccessBounds = 3.0;

// Outliers and matches of the car are found by a second scene without them: their pixels differ.
std::optional<RansacProblem> MakeProblem(const SceneOptions& scene, int index) {
  RansacProblem problem;
  std::string error;
  SceneOptions clean_scene = scene;
  clean_scene.outlier_share = 0.0;
  clean_scene.moving_share = 0.0;
  FramePair clean;
  if (!MakeScenePair(scene, index, &problem.pair, &error) ||
      !MakeScenePair(clean_scene, index, &clean, &error)) {
    return std::nullopt;
  }
  problem.clean = problem.pair;
  problem.clean->matches.clear();
  std::vector<size_t> rows;
  for (size_t k = 0; k < clean.matches.size(); ++k) {
    const Match& match = problem.pair.matches[k];
    if (match.pixel2 != clean.matches[k].pixel2) continue;
    problem.clean->matches.push_back(match);
    rows.push_back(k);
  }
  problem.clean->columns = problem.pair.columns.Subset(rows);
  return problem;
}

MotionEstimate EstimateOnce(const RansacTask& task, const FramePair& pair) {
  if (task.opengv.empty()) {
    return EstimateMotion(task.estimate, pair);
  }
  MotionEstimate estimate;
  OpenGvEstimate peer;
  if (!EstimateWithOpenGv(task.opengv, task.estimate.ransac, pair, &peer)) return estimate;
  estimate.status = EstimateStatus::kSuccess;
  estimate.pose = peer.pose;
  estimate.inlier_ratio = peer.num_inliers / static_cast<double>(pair.matches.size());
  estimate.iterations = peer.iterations;
  estimate.ransac_ms = peer.ransac_ms;
  estimate.refine_ms = peer.refine_ms;
  estimate.refine.translation_observable = true;
  return estimate;
}

double TotalMs(const MotionEstimate& estimate) { return estimate.ransac_ms + estimate.refine_ms; }

// The fastest of kRepetitions runs; of OpenGV one run.
MotionEstimate EstimateTimed(const RansacTask& task, const FramePair& pair) {
  MotionEstimate best = EstimateOnce(task, pair);
  for (int k = 1; k < kRepetitions && task.opengv.empty(); ++k) {
    MotionEstimate again = EstimateOnce(task, pair);
    if (TotalMs(again) < TotalMs(best)) best = std::move(again);
  }
  return best;
}

double RotationDeg(const Pose& truth, const Pose& pose) {
  return RadToDeg(RotationError(truth.R, pose.R));
}

std::optional<double> DirectionDeg(const Pose& truth, const MotionEstimate& estimate) {
  const double error = RadToDeg(TranslationDirectionError(truth.t, estimate.pose.t));
  if (!estimate.refine.translation_observable || !std::isfinite(error)) return std::nullopt;
  return error;
}

// True if the motion has at least kShare of the inliers of the true motion among the static
// matches.
bool HoldsStaticMatches(const FramePair& clean, const Pose& pose, double threshold_px) {
  // Of the inliers of the true motion: an estimate may lose those near the threshold.
  constexpr double kShare = 0.9;
  const GroupedMatches matches(clean.rig, clean.matches);
  const auto count = [&](const Pose& motion) {
    std::vector<double> errors;
    matches.SquaredErrors(motion, &errors);
    return std::count_if(errors.begin(), errors.end(),
                         [&](double e) { return e < threshold_px * threshold_px; });
  };
  return static_cast<double>(count(pose)) >= kShare * static_cast<double>(count(*clean.truth));
}

RefineOptions RefinementOf(const RansacTask& task) {
  RefineOptions refine(task.estimate.refine);
  refine.prior_kind = FindSolver(task.estimate.solver)->prior;
  refine.threshold_px = task.estimate.ransac.threshold_px;
  return refine;
}

std::optional<double> Median(const std::vector<double>& values) {
  return MedianOf(ComputeStatistics(values));
}

// Collects the pairs of a row.
class Collector {
 public:
  Collector(const RansacTask& task, RansacBenchmarkRow* row) : task_(task), row_(*row) {}

  void Add(const RansacProblem& problem) {
    const MotionEstimate estimate = EstimateTimed(task_, problem.pair);
    ++row_.pairs;
    matches_ += static_cast<double>(problem.pair.matches.size());
    const bool found = estimate.HasMotion();
    std::optional<double> rotation;
    if (found) {
      times_.push_back(TotalMs(estimate));
      ransac_.push_back(estimate.ransac_ms);
      refine_.push_back(estimate.refine_ms);
      iterations_.push_back(estimate.iterations);
      inliers_.push_back(estimate.inlier_ratio);
    } else {
      ++row_.failures;
    }
    if (found && problem.pair.truth.has_value()) {
      rotation = RotationDeg(*problem.pair.truth, estimate.pose);
      rotation_.push_back(*rotation);
      const auto direction = DirectionDeg(*problem.pair.truth, estimate);
      if (direction) direction_.push_back(*direction);
    }
    AddSuccess(problem, estimate, rotation);
    if (problem.clean) AddClean(*problem.clean, estimate);
  }

  void Finish() {
    if (row_.pairs == 0) return;
    row_.num_matches = static_cast<int>(std::lround(matches_ / row_.pairs));
    row_.time_ms = ComputeStatistics(times_);
    row_.time_spread_ms = QuartileDistance(times_);
    row_.ransac_ms = Median(ransac_).value_or(0.0);
    row_.refine_ms = Median(refine_).value_or(0.0);
    row_.iterations = Median(iterations_).value_or(0.0);
    row_.inlier_ratio = Median(inliers_).value_or(0.0);
    row_.rotation_deg = Median(rotation_);
    row_.direction_deg = Median(direction_);
    row_.clean_rotation_deg = Median(clean_rotation_);
    row_.clean_direction_deg = Median(clean_direction_);
    row_.efficiency_rotation =
        Efficiency(ComputeStatistics(good_rotation_), ComputeStatistics(bound_rotation_));
    row_.efficiency_direction =
        Efficiency(ComputeStatistics(good_direction_), ComputeStatistics(bound_direction_));
    if (with_bound_ == row_.pairs) {
      row_.success = successes_ / static_cast<double>(row_.pairs);
      row_.missed = missed_;
    }
    if (with_clean_ == row_.pairs) {
      row_.static_wins = static_wins_ / static_cast<double>(row_.pairs);
    }
  }

 private:
  void AddSuccess(const RansacProblem& problem, const MotionEstimate& estimate,
                  std::optional<double> rotation) {
    const FramePair& pair = problem.clean ? *problem.clean : problem.pair;
    const RefineOptions refine = RefinementOf(task_);
    const auto bound = ComputeCramerRaoBound(refine, pair);
    if (!bound) return;
    ++with_bound_;
    const double limit = kSuccessBounds * RadToDeg(bound->rotation);
    if (rotation && *rotation <= limit) {
      ++successes_;
      good_rotation_.push_back(*rotation);
      bound_rotation_.push_back(RadToDeg(bound->rotation));
      const auto direction = DirectionDeg(*pair.truth, estimate);
      if (direction && std::isfinite(bound->direction)) {
        good_direction_.push_back(*direction);
        bound_direction_.push_back(RadToDeg(bound->direction));
      }
      return;
    }
    // Missed by RANSAC, if the same refinement finds the motion from the truth.
    Pose pose = *pair.truth;
    const RefineSummary summary =
        Refine(refine, problem.pair.rig, problem.pair.matches, problem.pair.prior, &pose);
    if (summary.IsSolutionUsable() && RotationDeg(*pair.truth, pose) <= limit) ++missed_;
  }

  void AddClean(const FramePair& clean, const MotionEstimate& estimate) {
    ++with_clean_;
    if (estimate.HasMotion() &&
        HoldsStaticMatches(clean, estimate.pose,
                           ThresholdPx(task_.estimate.ransac.threshold_px, clean.rig))) {
      ++static_wins_;
    }
    const MotionEstimate undisturbed = EstimateOnce(task_, clean);
    if (!undisturbed.HasMotion()) return;
    clean_rotation_.push_back(RotationDeg(*clean.truth, undisturbed.pose));
    const auto direction = DirectionDeg(*clean.truth, undisturbed);
    if (direction) clean_direction_.push_back(*direction);
  }

  const RansacTask& task_;
  RansacBenchmarkRow& row_;
  double matches_ = 0.0;
  int with_bound_ = 0, with_clean_ = 0, successes_ = 0, missed_ = 0, static_wins_ = 0;
  std::vector<double> times_, ransac_, refine_, iterations_, inliers_;
  std::vector<double> rotation_, direction_, clean_rotation_, clean_direction_;
  std::vector<double> good_rotation_, bound_rotation_, good_direction_, bound_direction_;
};

}  // namespace

std::vector<RansacProblem> MakeRansacProblems(const SceneOptions& scene, int pairs) {
  std::vector<RansacProblem> problems;
  for (int k = 0; k < pairs; ++k) {
    if (auto problem = MakeProblem(scene, k)) problems.push_back(std::move(*problem));
  }
  return problems;
}

RansacBenchmarkRow MeasureRansac(const RansacTask& task,
                                 const std::vector<RansacProblem>& problems) {
  RansacBenchmarkRow row;
  row.solver = task.opengv.empty() ? task.estimate.solver : task.opengv;
  row.form = task.opengv.empty() ? RefineFormName(task.estimate.refine.form) : "own";
  row.variant = task.variant;
  row.outlier_share = task.scene.outlier_share;
  row.moving_share = task.scene.moving_share;
  Collector collector(task, &row);
  for (const RansacProblem& problem : problems) collector.Add(problem);
  collector.Finish();
  return row;
}

}  // namespace rigel
