#include "rigel/refine/least_squares/loss.h"

#include <cmath>

#include "rigel/core/enum_names.h"

namespace rigel {
namespace {

class TruncatedLoss : public ceres::LossFunction {
 public:
  explicit TruncatedLoss(double scale) : scale2_(scale * scale) {}
  void Evaluate(double s, double rho[3]) const override {
    const bool inside = s < scale2_;
    rho[0] = inside ? s : scale2_;
    rho[1] = inside ? 1.0 : 0.0;
    rho[2] = 0.0;
  }

 private:
  double scale2_;
};

constexpr EnumName<LossKind> kLossNames[] = {{LossKind::kNone, "none"},
                                             {LossKind::kHuber, "huber"},
                                             {LossKind::kCauchy, "cauchy"},
                                             {LossKind::kTukey, "tukey"},
                                             {LossKind::kTruncated, "truncated"}};

}  // namespace

const char* LossName(LossKind kind) { return NameOf(kLossNames, kind); }

bool ParseLoss(std::string_view name, LossKind* kind) { return FindValue(kLossNames, name, kind); }

std::unique_ptr<ceres::LossFunction> MakeLoss(LossKind kind, double scale) {
  switch (kind) {
    case LossKind::kNone:
      return nullptr;
    case LossKind::kHuber:
      return std::make_unique<ceres::HuberLoss>(scale);
    case LossKind::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(scale);
    case LossKind::kTukey:
      return std::make_unique<ceres::TukeyLoss>(scale);
    case LossKind::kTruncated:
      return std::make_unique<TruncatedLoss>(scale);
  }
  return nullptr;
}

double LossWeight(LossKind kind, double scale, double r) {
  const double s = r * r;
  const double scale2 = scale * scale;
  switch (kind) {
    case LossKind::kNone:
      return 1.0;
    case LossKind::kHuber:
      return s <= scale2 ? 1.0 : scale / std::sqrt(s);
    case LossKind::kCauchy:
      return 1.0 / (1.0 + s / scale2);
    case LossKind::kTukey: {
      const double u = 1.0 - s / scale2;
      return u > 0 ? u * u : 0.0;
    }
    case LossKind::kTruncated:
      return s < scale2 ? 1.0 : 0.0;
  }
  return 1.0;
}

}  // namespace rigel
