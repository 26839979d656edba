#include "rigel/core/body_axes.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <system_error>

#include <Eigen/Geometry>

#include "rigel/core/angles.h"

namespace rigel {
namespace {

// Of the cameras' directions Q e_column; zero without cameras.
Eigen::Vector3d MeanOfCameras(const Rig& rig, int column) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const RigCamera& camera : rig.cameras) sum += camera.Q.col(column);
  return rig.cameras.empty() ? sum : Eigen::Vector3d(sum / rig.size());
}

// Without the negative zeros of a product.
Eigen::Vector3d Axis(int index, bool negative) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  axis(index) = negative ? -1.0 : 1.0;
  return axis;
}

// The index of the largest component, of several as large the first.
int LargestOf(const Eigen::Vector3d& v) {
  int largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  return largest;
}

// The body axis nearest to v.
Eigen::Vector3d NearestAxis(const Eigen::Vector3d& v) {
  const int k = LargestOf(v);
  return Axis(k, v(k) < 0);
}

Eigen::Vector3d Across(const Eigen::Vector3d& v, const Eigen::Vector3d& direction) {
  return v - direction * direction.dot(v);
}

// The body axis nearest to v of those that are across `direction`: where that is oblique, of all
// but the nearest to it.
Eigen::Vector3d NearestAxisAcross(const Eigen::Vector3d& v, const Eigen::Vector3d& direction) {
  const int along = LargestOf(direction);
  Eigen::Vector3d across = Across(v, direction);
  across(along) = 0.0;
  // v is along `direction`, but for rounding, and any of them as near.
  constexpr double kAlong = 1e-9;
  if (!(across.norm() > kAlong)) across = Eigen::Vector3d::Unit((along + 1) % 3);
  return NearestAxis(across);
}

Eigen::Vector3d DefaultDown(const Rig& rig, const std::optional<Eigen::Vector3d>& forward) {
  if (rig.cameras.empty() && !forward) return BodyAxes().down;
  // Cameras of which half stand on their heads have no mean; the first has a direction.
  constexpr double kNoMean = 0.1;
  Eigen::Vector3d mean = MeanOfCameras(rig, 1);
  if (!(mean.norm() > kNoMean) && !rig.cameras.empty()) mean = rig.cameras[0].Q.col(1);
  return forward ? NearestAxisAcross(mean, *forward) : NearestAxis(mean);
}

Eigen::Vector3d DefaultForward(const Rig& rig, const Eigen::Vector3d& down) {
  // Length of the mean of the optical axes, across down: 1 if all cameras look the same way. Those
  // of a ring look all around, and their mean is too short to say what is ahead.
  constexpr double kSameWay = 0.5;
  Eigen::Vector3d ahead = Across(MeanOfCameras(rig, 2), down);
  if (!(ahead.norm() > kSameWay)) {
    const Eigen::Vector3d axis = NearestAxis(down);
    if (axis == -Eigen::Vector3d::UnitZ()) {
      ahead = Eigen::Vector3d::UnitX();
    } else if (axis == Eigen::Vector3d::UnitY() || rig.cameras.empty()) {
      ahead = Eigen::Vector3d::UnitZ();
    } else {
      ahead = rig.cameras[0].Q.col(2);
    }
  }
  return Across(NearestAxisAcross(ahead, down), down).normalized();
}

bool ParseComponent(std::string_view text, double* value) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  // from_chars takes no plus sign.
  if (text.substr(0, 1) == "+" && text.substr(1, 1) != "-") text.remove_prefix(1);
  const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return status == std::errc() && stop == text.data() + text.size() && std::isfinite(*value);
}

}  // namespace

// Degrees, of a stated forward direction and the line of down. Nearer ones are a mistake: a vehicle
// climbs less than that. A default of down is at 45 degrees or more.
constexpr int kLeastAngleDeg = 30;

bool ResolveBodyAxes(const Rig& rig, const std::optional<Eigen::Vector3d>& down,
                     const std::optional<Eigen::Vector3d>& forward, BodyAxes* axes,
                     std::string* error) {
  BodyAxes result;
  result.down = down ? down->normalized() : DefaultDown(rig, forward);
  if (!forward) {
    result.forward = DefaultForward(rig, result.down);
  } else {
    const Eigen::Vector3d across = Across(forward->normalized(), result.down);
    if (!(across.norm() > std::sin(DegToRad(kLeastAngleDeg)))) {
      *error = "forward " + DirectionText(*forward) + " is within " +
               std::to_string(kLeastAngleDeg) + " degrees of the line of down " +
               DirectionText(result.down);
      return false;
    }
    result.forward = across.normalized();
  }
  *axes = result;
  return true;
}

double CamerasOffDown(const Rig& rig, const Eigen::Vector3d& down) {
  const Eigen::Vector3d mean = MeanOfCameras(rig, 1);
  return mean.norm() > 0 ? std::atan2(mean.cross(down).norm(), mean.dot(down)) : 0.0;
}

bool ParseDirection(std::string_view text, Eigen::Vector3d* direction) {
  std::string_view axis = text;
  const bool negative = !axis.empty() && axis.front() == '-';
  if (!axis.empty() && (axis.front() == '+' || negative)) axis.remove_prefix(1);
  if (axis.size() == 1) {
    const int index = std::tolower(static_cast<unsigned char>(axis[0])) - 'x';
    if (index < 0 || index > 2) return false;
    *direction = Axis(index, negative);
    return true;
  }
  Eigen::Vector3d v;
  for (int k = 0; k < 3; ++k) {
    const size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (k == 2)) return false;
    if (!ParseComponent(text.substr(0, comma), &v(k))) return false;
    text.remove_prefix(k < 2 ? comma + 1 : text.size());
  }
  // Scaled before its norm, which could overflow.
  const double size = v.cwiseAbs().maxCoeff();
  if (!(size > 0)) return false;
  *direction = (v / size).normalized();
  return direction->allFinite();
}

std::string DirectionText(const Eigen::Vector3d& direction) {
  for (int k = 0; k < 3; ++k) {
    if (direction == Eigen::Vector3d::Unit(k)) return std::string("+") + "xyz"[k];
    if (direction == -Eigen::Vector3d::Unit(k)) return std::string("-") + "xyz"[k];
  }
  char text[96];
  std::snprintf(text, sizeof(text), "%.4g,%.4g,%.4g", direction.x(), direction.y(), direction.z());
  return text;
}

}  // namespace rigel
