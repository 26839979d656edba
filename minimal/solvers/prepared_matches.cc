#include "rigel/minimal/solvers/prepared_matches.h"

#include <numeric>

#include "rigel/core/grouped_matches.h"

namespace rigel {
namespace {

constexpr int kNotPrepared = -1;

PreparedMatch PrepareOne(const RayPair& rays, const Alignment& alignment, const Match& match) {
  const Eigen::Vector3d p = alignment.A1 * rays.ray1.x;
  const Eigen::Vector3d r = alignment.A2 * rays.ray2.x;
  const Eigen::Vector3d s1 = alignment.A1 * rays.ray1.s;
  const Eigen::Vector3d s2 = alignment.A2 * rays.ray2.s;
  const Eigen::Vector3d q1 = s1.cross(p);
  const Eigen::Vector3d q2 = s2.cross(r);
  PreparedMatch m;
  m.X0 = p.y() * r.z();
  m.Xc = -p.z() * r.y();
  m.Xs = p.x() * r.y();
  m.Yc = p.z() * r.x() - p.x() * r.z();
  m.Ys = -(p.x() * r.x() + p.z() * r.z());
  m.Z0 = -p.y() * r.x();
  m.K0 = r.y() * q1.y() + q2.y() * p.y();
  m.Kc = r.x() * q1.x() + r.z() * q1.z() + q2.x() * p.x() + q2.z() * p.z();
  m.Ks = r.x() * q1.z() - r.z() * q1.x() + q2.x() * p.z() - q2.z() * p.x();
  for (int k = 0; k < 3; ++k) {
    m.x1[k] = p[k];
    m.x2[k] = r[k];
    m.s1[k] = s1[k];
    m.s2[k] = s2[k];
  }
  m.parallax2 = p.cross(r).squaredNorm();
  m.camera1 = match.camera1;
  m.camera2 = match.camera2;
  return m;
}

}  // namespace

PreparedMatches::PreparedMatches(const Rig& rig, const std::vector<Match>& matches,
                                 const Alignment& alignment) {
  Set(rig, matches, alignment);
}

PreparedMatches PreparedMatches::OnDemand(const GroupedMatches& matches,
                                          const Alignment& alignment) {
  PreparedMatches result;
  result.alignment_ = alignment;
  result.grouped_ = &matches;
  result.place_.assign(matches.size(), kNotPrepared);
  result.matches_.reserve(matches.size());
  result.rays_.reserve(matches.size());
  return result;
}

void PreparedMatches::Prepare(const int* sample, int size) {
  if (grouped_ == nullptr) return;
  for (int i = 0; i < size; ++i) {
    const int k = sample[i];
    if (place_[k] != kNotPrepared) continue;
    place_[k] = static_cast<int>(matches_.size());
    rays_.push_back(grouped_->rays(k));
    matches_.push_back(PrepareOne(rays_.back(), alignment_, grouped_->matches()[k]));
  }
}

void PreparedMatches::Set(const Rig& rig, const std::vector<Match>& matches,
                          const Alignment& alignment) {
  alignment_ = alignment;
  grouped_ = nullptr;
  matches_.clear();
  rays_.clear();
  matches_.reserve(matches.size());
  rays_.reserve(matches.size());
  place_.resize(matches.size());
  std::iota(place_.begin(), place_.end(), 0);
  for (const Match& match : matches) {
    rays_.push_back(MakeRayPair(rig, match));
    matches_.push_back(PrepareOne(rays_.back(), alignment, match));
  }
}

}  // namespace rigel
