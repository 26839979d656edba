#include "rigel/problems/trajectories/g2o_file.h"

#include <cmath>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>

#include "rigel/core/rig_centre.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/refine/between_factor.h"

namespace rigel {
namespace {

// A standard deviation of |t| above this, metres, is none of a rig at rest.
constexpr double kRoughStillMetres = 1.0;

// Why the motion makes no edge; empty if it does.
std::string WhyNoEdge(const FramePair& pair, const MotionEstimate& e) {
  if (e.status != EstimateStatus::kSuccess) return EstimateStatusName(e.status);
  if (!e.refine.IsSolutionUsable() || !e.refine.covariance) return "no refined motion";
  if (!e.refine.rotation_observable) return "rotation not observable";
  if (!e.refine.RigDirectionKnown() && !StandsStill(pair, e.refine)) {
    return "direction of translation not observable";
  }
  return "";
}

// Takes the rig's centre as at rest, with the covariance that the estimate has about it. Where |t|
// was not determined at all that says nothing in metres, and its part is kStillMetres.
void SetStanding(Pose* pose, RefineSummary* refine) {
  const Eigen::Vector3d& point = refine->fitted_point;
  const Matrix6d from_body = BodyFromPointJacobian(pose->R, -point);
  Matrix6d covariance = from_body * *refine->covariance * from_body.transpose();
  const double length = MotionOfPoint(*pose, point).t.norm();
  const double sigma = refine->relative_scale_sigma * length;
  const Eigen::Matrix3d of_b = covariance.bottomRightCorner<3, 3>();
  const bool known = sigma >= 0 && sigma <= kRoughStillMetres &&
                     of_b.trace() <= 3 * kRoughStillMetres * kRoughStillMetres &&
                     of_b.determinant() > 0;
  if (!known) {
    covariance.bottomRows<3>().setZero();
    covariance.rightCols<3>().setZero();
    covariance.diagonal().tail<3>().setConstant(kStillMetres * kStillMetres);
  }
  const Matrix6d to_body = BodyFromPointJacobian(pose->R, point);
  refine->covariance = Matrix6d(to_body * covariance * to_body.transpose());
  refine->rig_translation_observable = true;
  refine->scale_free = true;
  *pose = Standing(*pose, *refine);
}

std::ostringstream Stream() {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(std::numeric_limits<double>::max_digits10);
  return stream;
}

void WritePose(const Pose& pose, std::ostream* stream) {
  const Eigen::Quaterniond q = pose.Quaternion();
  for (const double v : {pose.t.x(), pose.t.y(), pose.t.z(), q.x(), q.y(), q.z(), q.w()}) {
    *stream << " " << v;
  }
}

}  // namespace

std::string FormatG2o(const std::vector<FramePair>& pairs,
                      const std::vector<MotionEstimate>& estimates,
                      const std::vector<int>& positions, std::vector<std::string>* notes) {
  std::ostringstream vertices = Stream();
  std::ostringstream edges = Stream();
  int num_vertices = 0;
  Pose world_from_body;  // of the last vertex
  bool open = false;     // a trajectory goes on from there
  int num_edges = 0;
  int num_stated = 0;   // edges without scale, of the length that their pair states
  int num_unknown = 0;  // ... of kLengthWithoutScale
  int num_standing = 0;
  const auto add_vertex = [&] {
    vertices << "VERTEX_SE3:QUAT " << num_vertices++;
    WritePose(world_from_body, &vertices);
    vertices << "\n";
  };
  const auto note = [&](const std::string& text) {
    notes->push_back(PrintablePath(text));
    edges << "# " << notes->back() << "\n";
  };
  for (size_t k = 0; k < pairs.size(); ++k) {
    if (open) {
      const std::string why = WhyNotNext(pairs, positions, k);
      if (!why.empty()) {
        note(pairs[k].name + ": " + why + ": the trajectory ended before it, at vertex " +
             std::to_string(num_vertices - 1));
        open = false;
      }
    }
    const std::string why = WhyNoEdge(pairs[k], estimates[k]);
    if (!why.empty()) {
      note(pairs[k].name + ": " + why + ": no edge" +
           (open ? ", the trajectory ends at vertex " + std::to_string(num_vertices - 1)
                 : std::string()));
      open = false;
      continue;
    }
    Pose pose = estimates[k].pose;
    RefineSummary refine = estimates[k].refine;
    // -1 and NaN are not known, either.
    if (!refine.RigDirectionKnown()) {
      SetStanding(&pose, &refine);
      ++num_standing;
    } else if (!refine.scale_observable && !(refine.relative_scale_sigma >= 0 &&
                                             refine.relative_scale_sigma <= kRoughScaleRatio)) {
      const std::optional<double>& distance = pairs[k].prior.distance;
      const bool stated = distance.has_value() && *distance > 0;
      SetUndeterminedLength(stated ? *distance : kLengthWithoutScale, &pose, &refine);
      ++(stated ? num_stated : num_unknown);
    }
    const BetweenFactor edge = G2oEdge(pose, refine);
    if (!open) {
      world_from_body = Pose();
      add_vertex();
      open = true;
    }
    world_from_body = world_from_body * edge.measurement;
    add_vertex();
    ++num_edges;
    edges << "EDGE_SE3:QUAT " << num_vertices - 2 << " " << num_vertices - 1;
    WritePose(edge.measurement, &edges);
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) edges << " " << edge.information(i, j);
    }
    edges << "\n";
  }
  if (num_stated + num_unknown > 0) {
    note("|t| is not determined in " + std::to_string(num_stated + num_unknown) + " of " +
         std::to_string(num_edges) + " edges and has no information: " +
         std::to_string(num_stated) + " have the distance of their file, " +
         std::to_string(num_unknown) + " are of " + CsvNumber(kLengthWithoutScale) + " m");
  }
  if (num_standing > 0) {
    note("the rig stands still in " + std::to_string(num_standing) + " of " +
         std::to_string(num_edges) + " edges, which have no translation");
  }
  return vertices.str() + edges.str();
}

}  // namespace rigel
