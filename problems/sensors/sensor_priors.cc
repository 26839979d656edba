#include "rigel/problems/sensors/sensor_priors.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rigel/core/median.h"
#include "rigel/core/pose.h"
#include "rigel/problems/io/match_text.h"

namespace rigel {
namespace {

// Radians: a turn with a more uncertain axis has none. Beyond it the error is not linear.
constexpr double kMaxAxisSigma = DegToRad(5.0);

// Seconds: in a longer time a car may turn one way and back, and a loop is closed.
constexpr double kMaxPathSeconds = 5.0;

// A parabola that is off the line of a reading's neighbours by c has an integral that is off that
// of the line by this share of c times the time.
constexpr double kMeanOffLine = 1.0 / 6;

double SquareSum(const std::vector<double>& numbers) {
  double sum = 0;
  for (const double x : numbers) sum += x * x;
  return sum;
}

double MedianStep(const std::vector<double>& times) {
  std::vector<double> steps;
  for (size_t k = 1; k < times.size(); ++k) steps.push_back(times[k] - times[k - 1]);
  return MedianInPlace(&steps);
}

double Excess(const SeriesNoise& noise, double sigma) {
  return std::max(1.0, std::sqrt(noise.independent) / sigma);
}

template <class Keep>
void AddLine(std::map<std::string, std::string>* lines, const char* keyword, bool given,
             const Keep& values) {
  MatchText text(0);
  if (given) values(text.Word(keyword));
  (*lines)[keyword] = text.Take();
}

}  // namespace

bool SensorOptions::IsValid(std::string* error) const {
  const struct {
    const char* name;
    double value;
    bool may_be_zero;
  } numbers[] = {{"attitude_sigma", attitude_sigma, false},
                 {"odometry_sigma_fraction", odometry_sigma_fraction, true},
                 {"odometry_sigma", odometry_sigma, false},
                 {"gyro_noise", gyro_noise, false},
                 {"gyro_bias", gyro_bias, true},
                 {"max_gap_s", max_gap_s, false}};
  for (const auto& [name, value, may_be_zero] : numbers) {
    if (std::isfinite(value) && (value > 0 || (may_be_zero && value == 0))) continue;
    *error = std::string(name) + ": expected a number " + (may_be_zero ? ">= 0" : "> 0");
    return false;
  }
  if (IsRotation(imu_from_body) && std::abs(world_down.norm() - 1) <= kMaxUnitError) return true;
  *error = "imu_from_body: expected a rotation; world_down: expected a unit vector";
  return false;
}

void Sensors::SetAttitude(AttitudeSeries series) {
  attitude_noise_ = MeasureNoise(series, options_.max_gap_s);
  attitude_ = std::move(series);
}

void Sensors::SetOdometry(OdometrySeries series) {
  odometry_noise_ = MeasureNoise(series.readings, options_.max_gap_s);
  odometry_ = std::move(series);
}

void Sensors::SetGyro(RateSeries series) {
  gyro_noise_ = MeasureNoise(series, options_.max_gap_s);
  gyro_step_ = MedianStep(series.times);
  gyro_ = std::move(series);
}

double Sensors::GyroReadingSigma() const { return options_.gyro_noise / std::sqrt(gyro_step_); }

double Sensors::AttitudeExcess() const {
  return attitude_ ? Excess(attitude_noise_, options_.attitude_sigma) : 1.0;
}

double Sensors::OdometryExcess() const {
  return odometry_ ? Excess(odometry_noise_, options_.odometry_sigma) : 1.0;
}

double Sensors::GyroExcess() const { return gyro_ ? Excess(gyro_noise_, GyroReadingSigma()) : 1.0; }

// The sensors between two times.
class PairSensors {
 public:
  PairSensors(const Sensors& sensors, double time1, double time2)
      : sensors_(sensors), options_(sensors.options_), time1_(time1), time2_(time2) {}

  SensorPriors Priors() {
    if (sensors_.attitude_) AddAttitude();
    if (sensors_.gyro_) AddGyro();
    if (priors_.rotation) AddAxis();
    if (sensors_.odometry_) AddOdometry();
    return std::move(priors_);
  }

 private:
  double Begin() const { return std::min(time1_, time2_); }
  double End() const { return std::max(time1_, time2_); }

  void AddAttitude() {
    const AttitudeSeries& series = *sensors_.attitude_;
    Eigen::Matrix3d world_from_body[2];
    double variance[2];
    for (int k = 0; k < 2; ++k) {
      SeriesPlace place;
      priors_.attitude =
          FindPlace(series.times, k == 0 ? time1_ : time2_, options_.max_gap_s, &place);
      if (priors_.attitude != Coverage::kCovered) return;
      const Eigen::Quaterniond before(series.values[place.index]),
          after(series.values[place.index + 1]);
      world_from_body[k] =
          before.slerp(place.share, after).toRotationMatrix() * options_.imu_from_body;
      variance[k] = sensors_.attitude_noise_.Interpolated(options_.attitude_sigma, place.share);
    }
    MotionPrior& prior = priors_.prior;
    prior.gravity1 = (world_from_body[0].transpose() * options_.world_down).normalized();
    prior.gravity2 = (world_from_body[1].transpose() * options_.world_down).normalized();
    prior.gravity_sigma = std::sqrt((variance[0] + variance[1]) / 2);
    if (sensors_.gyro_) return;
    priors_.rotation = world_from_body[1].transpose() * world_from_body[0];
    priors_.rotation_sigma = std::sqrt(variance[0] + variance[1]);
  }

  void AddGyro() {
    const RateSeries& series = *sensors_.gyro_;
    SeriesPlace first, last;
    priors_.gyro = FindSpan(series.times, Begin(), End(), options_.max_gap_s, &first, &last);
    if (priors_.gyro != Coverage::kCovered || Begin() == End()) return;
    Eigen::Matrix3d begin_from_end = Eigen::Matrix3d::Identity();  // of the IMU
    ForEachPart(series.times, first, last, [&](size_t k, double u, double v, double seconds) {
      const Eigen::Vector3d step = series.values[k + 1] - series.values[k];
      const Eigen::Vector3d rate1 = series.values[k] + u * step,
                            rate2 = series.values[k] + v * step;
      begin_from_end *= ExpSO3(seconds / 2 * (rate1 + rate2));
    });
    const Eigen::Matrix3d imu2_from_imu1 =
        time2_ > time1_ ? Eigen::Matrix3d(begin_from_end.transpose()) : begin_from_end;
    priors_.rotation = options_.imu_from_body.transpose() * imu2_from_imu1 * options_.imu_from_body;

    const double sigma = sensors_.GyroReadingSigma();
    const double seconds = End() - Begin(), bias = options_.gyro_bias * seconds;
    const double off_line = kMeanOffLine * seconds;
    priors_.rotation_sigma =
        std::sqrt(sigma * sigma * SquareSum(IntegralWeights(series.times, first, last)) +
                  bias * bias + off_line * off_line * sensors_.gyro_noise_.Curve(sigma));
  }

  // An error d of R turns its rotation vector, of length a, by |d| (a / 2) / sin(a / 2)
  // perpendicular to it, which is the angle |d| / (2 sin(a / 2)).
  void AddAxis() {
    const Eigen::Vector3d turn = LogSO3(*priors_.rotation);
    const double sine = std::sin(turn.norm() / 2);
    if (!(priors_.rotation_sigma <= 2 * sine * kMaxAxisSigma)) return;
    priors_.prior.axis = turn.normalized();
    priors_.prior.axis_sigma = priors_.rotation_sigma / (2 * sine);
  }

  void AddOdometry() {
    const TimeSeries<double>& series = sensors_.odometry_->readings;
    const SeriesNoise& noise = sensors_.odometry_noise_;
    const double sigma = options_.odometry_sigma;
    SeriesPlace first, last;
    priors_.odometry = FindSpan(series.times, Begin(), End(), options_.max_gap_s, &first, &last);
    if (priors_.odometry != Coverage::kCovered) return;
    const double seconds = End() - Begin();
    priors_.too_long = seconds > kMaxPathSeconds;
    if (priors_.too_long || seconds == 0) return;
    double path = 0, variance = 0;
    if (sensors_.odometry_->is_speed) {
      const std::vector<double> weights = IntegralWeights(series.times, first, last);
      for (size_t k = 0; k < weights.size(); ++k)
        path += weights[k] * series.values[first.index + k];
      const double off_line = kMeanOffLine * seconds;
      variance = sigma * sigma * SquareSum(weights) + off_line * off_line * noise.Curve(sigma);
    } else {
      for (const auto& [place, sign] : {std::pair(first, -1), std::pair(last, 1)}) {
        const double before = series.values[place.index], after = series.values[place.index + 1];
        path += sign * (before + place.share * (after - before));
        variance += noise.Interpolated(sigma, place.share);
      }
    }
    path = std::abs(path);
    const double half = priors_.rotation ? LogSO3(*priors_.rotation).norm() / 2 : 0.0;
    const double fraction = options_.odometry_sigma_fraction * path;
    priors_.prior.distance = half > 0 ? path * std::sin(half) / half : path;
    priors_.prior.distance_sigma = std::sqrt(variance + fraction * fraction);
  }

  const Sensors& sensors_;
  const SensorOptions& options_;
  const double time1_, time2_;
  SensorPriors priors_;
};

SensorPriors PriorsBetween(const Sensors& sensors, double time1, double time2) {
  return PairSensors(sensors, time1, time2).Priors();
}

std::map<std::string, std::string> SensorLines(const Sensors& sensors, const SensorPriors& priors) {
  std::map<std::string, std::string> lines;
  const MotionPrior& prior = priors.prior;
  if (sensors.attitude()) {
    AddLine(&lines, "gravity1", prior.gravity1.has_value(),
            [&](MatchText& text) { text.Vector(*prior.gravity1); });
    AddLine(&lines, "gravity2", prior.gravity2.has_value(),
            [&](MatchText& text) { text.Vector(*prior.gravity2); });
    AddLine(&lines, "gravity_sigma_deg", prior.gravity_sigma.has_value(),
            [&](MatchText& text) { text.SigmaDeg(*prior.gravity_sigma); });
  }
  if (sensors.attitude() || sensors.gyro()) {
    AddLine(&lines, "axis", prior.axis.has_value(),
            [&](MatchText& text) { text.Vector(*prior.axis); });
    AddLine(&lines, "axis_sigma_deg", prior.axis_sigma.has_value(),
            [&](MatchText& text) { text.SigmaDeg(*prior.axis_sigma); });
    AddLine(&lines, "rotation", priors.rotation.has_value(), [&](MatchText& text) {
      text.Quaternion(*priors.rotation).SigmaDeg(priors.rotation_sigma);
    });
  }
  if (sensors.odometry()) {
    AddLine(&lines, "distance", prior.distance.has_value(),
            [&](MatchText& text) { text.Number(*prior.distance).Number(prior.distance_sigma); });
  }
  return lines;
}

}  // namespace rigel
