#include "rigel/problems/trajectories/trajectory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rigel/core/rig_centre.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/printable.h"
#include "rigel/refine/between_factor.h"
#include "rigel/refine/standing.h"

namespace rigel {
namespace {

struct Step {
  std::string why_not;  // not empty: there is no step
  Pose estimate, raw;   // f2_from_f1
  bool still = false;
  bool stated_length = false;
};

}  // namespace

bool StandsStill(const FramePair& pair, const RefineSummary& refine) {
  if (refine.RigDirectionKnown() || !refine.rotation_observable) return false;
  const bool no_parallax =
      refine.parallax_px >= 0 && refine.parallax_px <= refine.parallax_limit_px;
  return (refine.stands || no_parallax) && MayStand(pair.prior);
}

bool KnowsLength(const RefineSummary& refine) {
  // A sigma of -1 or NaN is unknown.
  return refine.length_held || (refine.length_sigma >= 0 && refine.length_sigma <= kMaxLengthSigma);
}

Pose Standing(const Pose& pose, const RefineSummary& refine) {
  if (refine.stands) return pose;
  return MotionOfBody({pose.R, Eigen::Vector3d::Zero()}, refine.rig_center);
}

namespace {

Step StepOf(const FramePair& pair, const MotionEstimate& e, bool has_inter) {
  Step step;
  const auto none = [&](const std::string& why) {
    step.why_not = why;
    return step;
  };
  if (e.status != EstimateStatus::kSuccess) return none(EstimateStatusName(e.status));
  step.estimate = e.pose;
  step.raw = {e.raw.R, e.raw.t};
  const RefineSummary& refine = e.refine;
  const bool refined = refine.IsSolutionUsable();
  bool has_length = e.raw.has_scale && has_inter;
  if (refined) {
    if (!refine.rotation_observable) return none("rotation not observable");
    if (!refine.RigDirectionKnown()) {
      if (!StandsStill(pair, refine)) return none("direction of translation not observable");
      step.still = true;
      step.estimate = Standing(step.estimate, refine);
      step.raw = Standing(step.raw, refine);
      return step;
    }
    has_length = KnowsLength(refine);
  }
  if (!has_length) {
    if (!pair.prior.distance || !(*pair.prior.distance > 0)) {
      return none("length of translation not determined, no distance stated");
    }
    step.stated_length = true;
    step.estimate = WithBodyLength(step.estimate, refine.rig_center, *pair.prior.distance);
  }
  if (!e.raw.has_scale || step.stated_length) {
    const double length = step.estimate.t.norm();
    if (length > 0) step.raw = WithBodyLength(step.raw, refine.rig_center, length);
  }
  return step;
}

void Append(const Pose& f2_from_f1, std::vector<Pose>* world_from_body) {
  const Pose next = world_from_body->back() * f2_from_f1.Inverse();
  // Through a quaternion, so that rounding errors do not accumulate in R.
  world_from_body->push_back(Pose::FromQuaternion(next.Quaternion(), next.t));
}

// Of all poses, if they ascend.
std::vector<double> TimesOf(const std::vector<FramePair>& pairs, size_t first, size_t count) {
  std::vector<double> times;
  for (size_t k = first; k < first + count; ++k) {
    if (!pairs[k].time1 || !pairs[k].time2) return {};
    if (times.empty()) times.push_back(*pairs[k].time1);
    if (!(*pairs[k].time2 > times.back())) return {};
    times.push_back(*pairs[k].time2);
  }
  return times;
}

// Whether the pair starts when the one before ends.
bool StartsAtEnd(const FramePair& before, const FramePair& pair) {
  double shorter = std::numeric_limits<double>::infinity();
  for (const FramePair* p : {&before, &pair}) {
    if (p->time1 && p->time2) shorter = std::min(shorter, std::abs(*p->time2 - *p->time1));
  }
  const double tolerance = std::isfinite(shorter) ? kSameTimeShare * shorter : 0.0;
  return std::abs(*pair.time1 - *before.time2) <= std::max(tolerance, kSameTimeSeconds);
}

}  // namespace

std::string WhyNotNext(const std::vector<FramePair>& pairs, const std::vector<int>& positions,
                       size_t k) {
  const FramePair& before = pairs[k - 1];
  const FramePair& pair = pairs[k];
  if (!positions.empty() && positions[k] != positions[k - 1] + 1) {
    return "a pair is missing before it";
  }
  if (pair.sequence != before.sequence) return "another sequence";
  if (before.time2 && pair.time1 && !StartsAtEnd(before, pair)) {
    return "starts at " + CsvNumber(*pair.time1) + " s, the pair before ends at " +
           CsvNumber(*before.time2) + " s";
  }
  return "";
}

std::vector<Trajectory> ChainMotions(const std::vector<FramePair>& pairs,
                                     const std::vector<MotionEstimate>& estimates,
                                     const std::vector<char>& has_inter,
                                     const std::vector<int>& positions,
                                     std::vector<std::string>* notes) {
  std::vector<Trajectory> trajectories;
  bool open = false;
  bool all_true = false;  // all pairs of the open trajectory have a truth
  const auto close = [&] {
    if (!open) return;
    Trajectory& last = trajectories.back();
    last.times = TimesOf(pairs, last.first_pair, last.NumPairs());
    if (!all_true) last.truth.clear();
    open = false;
  };
  for (size_t k = 0; k < pairs.size(); ++k) {
    const std::string gap = open ? WhyNotNext(pairs, positions, k) : "";
    if (!gap.empty()) {
      notes->push_back(Printable(pairs[k].name + ": " + gap + ": the trajectory ended before it"));
      close();
    }
    const Step step = StepOf(pairs[k], estimates[k], has_inter[k] != 0);
    if (!step.why_not.empty()) {
      notes->push_back(Printable(pairs[k].name + ": " + step.why_not + ": a gap" +
                                 (open ? ", the trajectory ends before it" : "")));
      close();
      continue;
    }
    if (!open) {
      Trajectory next;
      next.sequence = pairs[k].sequence;
      next.first_pair = k;
      next.estimate = next.raw = next.truth = {Pose()};
      trajectories.push_back(next);
      open = all_true = true;
    }
    Trajectory& trajectory = trajectories.back();
    Append(step.estimate, &trajectory.estimate);
    Append(step.raw, &trajectory.raw);
    if (pairs[k].truth) {
      Append(*pairs[k].truth, &trajectory.truth);
    } else {
      all_true = false;
    }
    trajectory.num_still += step.still ? 1 : 0;
    trajectory.num_stated_lengths += step.stated_length ? 1 : 0;
  }
  close();
  return trajectories;
}

}  // namespace rigel
