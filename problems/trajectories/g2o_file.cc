#include "rigel/problems/trajectories/g2o_file.h"

#include <cmath>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>

#include "rigel/core/rig_centre.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/printable.h"
#include "rigel/refine/between_factor.h"
#include "rigel/refine/standing.h"

namespace rigel {
namespace {

// Metres. With a larger standard deviation of |t| the covariance is not used for a rig at rest.
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

// Sets the rig's centre at rest, with the covariance of the estimate about it. If |t| is not
// determined, the covariance of the translation is kStillMetres squared.
void SetStanding(Pose* pose, RefineSummary* refine) {
  refine->rig_translation_observable = true;
  refine->length_sigma = 0.0;
  if (refine->stands) return;
  const Eigen::Vector3d& point = refine->rig_center;
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

// How many edges have a length that is not estimated.
struct LengthCounts {
  int stated = 0;   // the distance of their pair
  int unknown = 0;  // kLengthWithoutScale
  int standing = 0;
};

BetweenFactor EdgeOf(const FramePair& pair, const MotionEstimate& estimate, LengthCounts* counts) {
  Pose pose = estimate.pose;
  RefineSummary refine = estimate.refine;
  if (!refine.RigDirectionKnown()) {
    SetStanding(&pose, &refine);
    ++counts->standing;
  } else if (!KnowsLength(refine)) {
    const std::optional<double>& distance = pair.prior.distance;
    const bool stated = distance.has_value() && *distance > 0;
    SetUndeterminedLength(stated ? *distance : kLengthWithoutScale, &pose, &refine);
    ++(stated ? counts->stated : counts->unknown);
  }
  return G2oEdge(pose, refine);
}

// The lines of a graph. A trajectory is open while the next edge goes on from its last vertex.
class PoseGraph {
 public:
  explicit PoseGraph(std::vector<std::string>* notes) : notes_(*notes) {}

  bool open() const { return open_; }
  int num_edges() const { return num_edges_; }
  std::string LastVertex() const { return std::to_string(num_vertices_ - 1); }
  std::string Text() const { return vertices_.str() + edges_.str(); }

  void Close() { open_ = false; }

  void Note(const std::string& text) {
    notes_.push_back(Printable(text));
    edges_ << "# " << notes_.back() << "\n";
  }

  // Opens a trajectory at the identity if none is open.
  void AddEdge(const BetweenFactor& edge) {
    if (!open_) {
      world_from_body_ = Pose();
      AddVertex();
      open_ = true;
    }
    world_from_body_ = world_from_body_ * edge.measurement;
    AddVertex();
    ++num_edges_;
    edges_ << "EDGE_SE3:QUAT " << num_vertices_ - 2 << " " << num_vertices_ - 1;
    WritePose(edge.measurement, &edges_);
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) edges_ << " " << edge.information(i, j);
    }
    edges_ << "\n";
  }

 private:
  void AddVertex() {
    vertices_ << "VERTEX_SE3:QUAT " << num_vertices_++;
    WritePose(world_from_body_, &vertices_);
    vertices_ << "\n";
  }

  std::vector<std::string>& notes_;
  std::ostringstream vertices_ = Stream();
  std::ostringstream edges_ = Stream();
  int num_vertices_ = 0;
  int num_edges_ = 0;
  Pose world_from_body_;  // of the last vertex
  bool open_ = false;
};

}  // namespace

std::string FormatG2o(const std::vector<FramePair>& pairs,
                      const std::vector<MotionEstimate>& estimates,
                      const std::vector<int>& positions, std::vector<std::string>* notes) {
  PoseGraph graph(notes);
  LengthCounts counts;
  for (size_t k = 0; k < pairs.size(); ++k) {
    if (graph.open()) {
      const std::string why = WhyNotNext(pairs, positions, k);
      if (!why.empty()) {
        graph.Note(pairs[k].name + ": " + why + ": the trajectory ended before it, at vertex " +
                   graph.LastVertex());
        graph.Close();
      }
    }
    const std::string why = WhyNoEdge(pairs[k], estimates[k]);
    if (why.empty()) {
      graph.AddEdge(EdgeOf(pairs[k], estimates[k], &counts));
      continue;
    }
    graph.Note(pairs[k].name + ": " + why + ": no edge" +
               (graph.open() ? ", the trajectory ends at vertex " + graph.LastVertex() : ""));
    graph.Close();
  }
  const std::string of_edges = " of " + std::to_string(graph.num_edges()) + " edges";
  if (counts.stated + counts.unknown > 0) {
    graph.Note("|t| is not determined in " + std::to_string(counts.stated + counts.unknown) +
               of_edges + " and has no information: " + std::to_string(counts.stated) +
               " have the distance of their file, " + std::to_string(counts.unknown) + " are of " +
               CsvNumber(kLengthWithoutScale) + " m");
  }
  if (counts.standing > 0) {
    graph.Note("the rig stands still in " + std::to_string(counts.standing) + of_edges +
               ", which have no translation");
  }
  return graph.Text();
}

}  // namespace rigel
