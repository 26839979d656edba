#include "rigel/core/score_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kT2 = 2.25;

// The second is the first on a machine that has no better one: the tests of equality are then void.
const CpuPath kPaths[] = {CpuPath::kBaseline, BestCpuPath()};

// Matches of one camera at the body's origin, most of them near a motion's epipolar lines, some
// behind the camera; NaN where the kernels may read but must not look.
class Problem {
 public:
  Problem(int size, uint64_t seed) : size_(size) {
    Random random = Random::Stream(7, seed);
    pose.R = ExpSO3(0.05 * random.NormalVector3());
    pose.t = random.UnitVector3();
    for (std::vector<double>& values : data_) values.assign(size + kKernelPadding, kNan);
    for (int k = 0; k < size; ++k) {
      RayPair rays;
      const Eigen::Vector3d X1{random.Uniform(-5, 5), random.Uniform(-5, 5), random.Uniform(4, 20)};
      Eigen::Vector3d X2 = pose * X1;
      if (random.Index(4) == 0) X2 -= random.Uniform(1, 3) * pose.t * X2.z();
      rays.ray1.x = X1.normalized();
      rays.ray2.x = X2.normalized();
      const Eigen::Vector3d noise = 2.0 * random.NormalVector3();
      const double values[] = {kFocal * X1.x() / X1.z(), kFocal * X1.y() / X1.z(),
                               kFocal * X2.x() / X2.z() + noise.x(),
                               kFocal * X2.y() / X2.z() + noise.y()};
      for (int i = 0; i < 4; ++i) data_[i][k] = values[i];
      Set(k, rays);
    }
    const Eigen::Vector3d inv_f(1 / kFocal, 1 / kFocal, 1);
    F = inv_f.asDiagonal() * Skew(pose.t) * pose.R * inv_f.asDiagonal();
    if (seed % 2 == 0) return;
    // Rows of any cameras: near those of pinholes, so that the errors are of their size.
    stride_ = data_[0].size();
    general_.resize(kGeneralArrays * stride_);
    for (int k = 0; k < size; ++k) {
      for (int c = 0; c < kGeneralArrays; ++c) {
        const bool is_one = c < 2 || (c - 2) % 6 == 0 || (c - 2) % 6 == 3;
        general_[c * stride_ + k] = (is_one ? 1.0 : 0.0) + 0.05 * random.Normal();
      }
    }
  }

  void Set(int k, const RayPair& rays) {
    for (int i = 0; i < 3; ++i) {
      data_[4 + i][k] = rays.ray1.x[i];
      data_[7 + i][k] = rays.ray2.x[i];
    }
    rays_.resize(std::max<size_t>(rays_.size(), k + 1));
    rays_[k] = rays;
  }

  RowArrays pixels() const {
    return {data_[0].data(), data_[1].data(), data_[2].data(),
            data_[3].data(), size_,           general_.empty() ? nullptr : general_.data(),
            stride_};
  }
  RayArrays rays() const {
    return {data_[4].data(), data_[5].data(), data_[6].data(),
            data_[7].data(), data_[8].data(), data_[9].data()};
  }
  GroupMotion motion(double min_sin2) const {
    GroupMotion motion;
    Eigen::Map<RowMajor3d>(motion.R) = pose.R;
    Eigen::Map<Eigen::Vector3d>(motion.b) = pose.t;
    motion.min_sin2 = min_sin2;
    return motion;
  }

  double Error(int k) const {
    if (general_.empty()) {
      return SampsonError(F, Eigen::Vector3d(data_[0][k], data_[1][k], 1),
                          Eigen::Vector3d(data_[2][k], data_[3][k], 1));
    }
    RowPoint points[2];
    for (int side = 0; side < 2; ++side) {
      const double* of_k = general_.data() + k;
      points[side].p = {data_[2 * side][k], data_[2 * side + 1][k], of_k[side * stride_]};
      for (int i = 0; i < 6; ++i) {
        points[side].J(i / 2, i % 2) = of_k[(2 + 6 * side + i) * stride_];
      }
    }
    return SampsonError(F, points[0], points[1]);
  }
  // In front of one camera is then behind the other.
  void TurnSecondRay(int k) {
    RayPair rays = rays_[k];
    rays.ray2.x = -rays.ray2.x;
    Set(k, rays);
  }
  const RayPair& Rays(int k) const { return rays_[k]; }
  Cheirality Side(int k, double min_sin) const { return TestCheirality(pose, rays_[k], min_sin); }
  bool Behind(int k, double min_sin) const {
    const Cheirality c = Side(k, min_sin);
    return c == Cheirality::kBehind || c == Cheirality::kMixed;
  }

  static constexpr double kFocal = 400;
  Pose pose;
  RowMajor3d F;

 private:
  int size_;
  std::vector<double> data_[10];
  std::vector<double> general_;  // as RowArrays has it; empty: pinholes
  size_t stride_ = 0;
  std::vector<RayPair> rays_;
};

// What a kernel says, so that paths can be compared whole.
struct Said {
  double sum;
  int inliers;
  bool operator==(const Said& o) const { return sum == o.sum && inliers == o.inliers; }
};

Said Sum(const Problem& p, double bound, double sum, CpuPath path) {
  Said said = {0.0, 0};
  said.sum = TruncatedSampsonSum(p.pixels(), p.F.data(), kT2, bound, sum, &said.inliers, path);
  return said;
}

Said SumInFront(const Problem& p, double bound, double sum, CpuPath path) {
  Said said = {0.0, 0};
  said.sum = TruncatedSampsonSumInFront(p.pixels(), p.rays(), p.F.data(), p.motion(1e-4), kT2,
                                        bound, sum, &said.inliers, path);
  return said;
}

// Well-made motions and the three that are not.
void Spoil(int how, Problem* p) {
  if (how == 1) p->F.setZero();
  if (how == 2) p->F(1, 2) = kNan;
  if (how == 3) p->F(0, 1) = kInf;
  if (how == 4) p->pose.R(2, 1) = kNan;
  if (how == 5) p->pose.t.x() = kNan;
}

TEST(ScoreKernel, SumsAreThoseOfTheDefinition) {
  int behind = 0;
  for (int size = 0; size <= 70; ++size) {
    const Problem p(size, size);
    double sum = 0, sum_in_front = 0;
    int inliers = 0, inliers_in_front = 0;
    for (int k = 0; k < size; ++k) {
      const double r2 = p.Error(k) * p.Error(k);
      const bool inlier = r2 < kT2, in_front = !p.Behind(k, 1e-2);
      sum += inlier ? r2 : kT2;
      sum_in_front += inlier && in_front ? r2 : kT2;
      inliers += inlier;
      inliers_in_front += inlier && in_front;
    }
    for (const CpuPath path : kPaths) {
      EXPECT_NEAR(Sum(p, kInf, 0.0, path).sum, sum, 1e-9 * sum);
      EXPECT_EQ(Sum(p, kInf, 0.0, path).inliers, inliers);
      EXPECT_NEAR(SumInFront(p, kInf, 0.0, path).sum, sum_in_front, 1e-9 * sum_in_front);
      EXPECT_EQ(SumInFront(p, kInf, 0.0, path).inliers, inliers_in_front);
    }
    behind += inliers - inliers_in_front;
  }
  EXPECT_GT(behind, 50) << "the two sums were to differ";
}

TEST(ScoreKernel, EveryPathGivesTheSameBits) {
  for (int how = 0; how < 6; ++how) {
    for (int size = 0; size <= 70; ++size) {
      Problem p(size, 100 + size);
      Spoil(how, &p);
      const Said whole = Sum(p, kInf, 0.0, CpuPath::kBaseline);
      for (const double bound : {kInf, -1.0, 0.0, 0.3 * whole.sum, whole.sum}) {
        EXPECT_EQ(Sum(p, bound, 0.0, CpuPath::kBaseline), Sum(p, bound, 0.0, kPaths[1]));
        EXPECT_EQ(SumInFront(p, bound, 0.0, CpuPath::kBaseline),
                  SumInFront(p, bound, 0.0, kPaths[1]));
      }
      std::vector<double> errors[2], selected_errors[2];
      std::vector<char> inliers[2];
      for (int i = 0; i < 2; ++i) {
        errors[i].resize(size);
        selected_errors[i].resize(size);
        inliers[i].resize(size);
        SquaredSampsonErrors(p.pixels(), p.F.data(), errors[i].data(), kPaths[i]);
        const int count = SelectInFront(p.pixels(), p.rays(), p.F.data(), p.motion(1e-4), kT2,
                                        selected_errors[i].data(), inliers[i].data(), kPaths[i]);
        EXPECT_EQ(count, std::count(inliers[i].begin(), inliers[i].end(), 1));
        EXPECT_EQ(count, SumInFront(p, kInf, 0.0, kPaths[i]).inliers);
      }
      EXPECT_EQ(inliers[0], inliers[1]);
      for (int k = 0; k < size; ++k) {
        const bool nan = std::isnan(errors[0][k]);
        EXPECT_EQ(nan, std::isnan(errors[1][k]));
        if (nan) continue;
        EXPECT_EQ(errors[0][k], errors[1][k]);
        EXPECT_EQ(errors[0][k], selected_errors[0][k]);
        EXPECT_EQ(errors[0][k], selected_errors[1][k]);
      }
    }
  }
}

// RANSAC asks whether a score is below a bound; the sum of earlier groups is small or large beside
// this group's.
TEST(ScoreKernel, TheBoundNeverRejectsAWinner) {
  for (const CpuPath path : kPaths) {
    for (int size = 1; size <= 200; size += 7) {
      const Problem p(size, 200 + size);
      for (const double before : {0.0, 1e-17, 0.1, 1.0 / 3, 1e6}) {
        for (const auto& sum_of : {Sum, SumInFront}) {
          const Said whole = sum_of(p, kInf, before, path);
          const double step = (whole.sum - before) / 40;
          for (int k = 0; k <= 42; ++k) {
            const double middle = k == 40 ? whole.sum : before + k * step;
            for (const double bound :
                 {std::nextafter(middle, -kInf), middle, std::nextafter(middle, kInf)}) {
              const Said said = sum_of(p, bound, before, path);
              if (whole.sum <= bound) {
                EXPECT_EQ(said, whole);
              } else {
                EXPECT_GT(said.sum, bound);
                EXPECT_LE(said.sum, whole.sum);
                EXPECT_LE(said.inliers, whole.inliers);
                // A sum that is met exactly may still grow.
                if (whole.sum > said.sum) {
                  EXPECT_GT(sum_of(p, said.sum, before, path).sum, said.sum);
                }
              }
            }
          }
        }
      }
    }
  }
}

TEST(ScoreKernel, LookingAtDepthsNeverLowersTheSum) {
  for (int seed = 0; seed < 300; ++seed) {
    const Problem p(1 + seed % 97, seed);
    const Said all = Sum(p, kInf, 0.1, CpuPath::kBaseline);
    const Said in_front = SumInFront(p, kInf, 0.1, kPaths[1]);
    EXPECT_GE(in_front.sum, all.sum);
    EXPECT_LE(in_front.inliers, all.inliers);
  }
}

TEST(ScoreKernel, StopsWithinAGroup) {
  // Most rigs have few camera pairs: to stop between groups only would save nothing.
  Problem p(3000, 1);
  p.F.setZero();
  for (const CpuPath path : kPaths) {
    EXPECT_GT(Sum(p, 90.0, 0.0, path).sum, 90.0);
    EXPECT_LE(Sum(p, 90.0, 0.0, path).sum, 225.0) << "each match counts 2.25";
    EXPECT_EQ(Sum(p, 90.0, 91.0, path).sum, 91.0);
  }
}

TEST(ScoreKernel, AddsToTheSumAndToTheCount) {
  const Problem p(64, 2);
  for (const CpuPath path : kPaths) {
    const int once = Sum(p, kInf, 0.0, path).inliers;
    ASSERT_GT(once, 0);
    int inliers = 7;
    EXPECT_GT(TruncatedSampsonSum(p.pixels(), p.F.data(), kT2, kInf, 1e3, &inliers, path), 1e3);
    EXPECT_EQ(inliers, once + 7);
  }
}

TEST(ScoreKernel, AMotionOfZeroOrNanWinsNoMatch) {
  for (const int how : {1, 2, 3}) {
    Problem p(45, 3);
    Spoil(how, &p);
    for (const CpuPath path : kPaths) {
      EXPECT_EQ(Sum(p, kInf, 0.0, path), (Said{45 * kT2, 0}));
      EXPECT_EQ(SumInFront(p, kInf, 0.0, path), (Said{45 * kT2, 0}));
      std::vector<double> errors(45);
      SquaredSampsonErrors(p.pixels(), p.F.data(), errors.data(), path);
      for (const double error : errors) {
        if (how == 1) {
          EXPECT_EQ(error, kInf);
        } else {
          EXPECT_FALSE(error < 1e300);
        }
      }
    }
  }
}

// Whether the kernel leaves out each match, all of them of zero error.
std::vector<bool> LeftOut(const Problem& p, double min_sin2, CpuPath path) {
  Problem fits = p;
  fits.F.setZero();
  fits.F(2, 0) = 1.0;  // x1 = 0
  const int size = p.pixels().size;
  std::vector<double> zeros(size + kKernelPadding, 0.0), errors(size);
  const RowArrays pixels = {zeros.data(), zeros.data(), zeros.data(), zeros.data(), size};
  std::vector<char> inliers(size);
  SelectInFront(pixels, p.rays(), fits.F.data(), p.motion(min_sin2), kT2, errors.data(),
                inliers.data(), path);
  for (const double error : errors) EXPECT_EQ(error, 0.0);
  std::vector<bool> left_out;
  for (const char inlier : inliers) left_out.push_back(inlier == 0);
  return left_out;
}

TEST(ScoreKernel, DepthsAreJudgedAsInCore) {
  for (const CpuPath path : kPaths) {
    int count = 0;
    for (int how : {0, 4, 5}) {
      for (int seed = 0; seed < 50; ++seed) {
        Problem p(61, 400 + seed);
        Spoil(how, &p);
        for (const double min_sin : {0.0, 1e-9, 0.03, 0.2}) {
          const std::vector<bool> left_out = LeftOut(p, min_sin * min_sin, path);
          for (int k = 0; k < 61; ++k) {
            EXPECT_EQ(left_out[k], p.Behind(k, min_sin));
            count += left_out[k];
          }
        }
      }
    }
    EXPECT_GT(count, 500);
  }
}

TEST(ScoreKernel, ParallaxIsTheSineBetweenTheRaysWithoutRotation) {
  for (int size = 0; size < 80; ++size) {
    const Problem p(size, size);
    const RowMajor3d R = p.pose.R;
    for (const CpuPath path : kPaths) {
      std::vector<double> sin2(size);
      SquaredParallax(p.rays(), R.data(), size, sin2.data(), path);
      for (int k = 0; k < size; ++k) {
        const RayPair rays = p.Rays(k);
        EXPECT_NEAR(sin2[k], (R * rays.ray1.x).cross(rays.ray2.x).squaredNorm(), 1e-15);
      }
    }
    std::vector<double> baseline(size), best(size);
    SquaredParallax(p.rays(), R.data(), size, baseline.data(), CpuPath::kBaseline);
    SquaredParallax(p.rays(), R.data(), size, best.data(), BestCpuPath());
    EXPECT_EQ(baseline, best);
  }
}

TEST(ScoreKernel, DepthsAtBoundariesAreJudgedAsInCore) {
  Problem p(8, 5);
  p.pose = Pose();
  p.pose.t = {0, 0, 1};
  const Eigen::Vector3d z(0, 0, 1), side(0.6, 0, 0.8), other(-0.6, 0, 0.8);
  const auto rays = [](const Eigen::Vector3d& x1, const Eigen::Vector3d& x2) {
    RayPair pair;
    pair.ray1.x = x1;
    pair.ray2.x = x2;
    return pair;
  };
  p.Set(0, rays(side, z));   // d1 = 0
  p.Set(1, rays(-z, side));  // d2 = 0
  p.Set(2, rays(side, side));
  p.Set(3, rays(side, -side));
  p.Set(4, rays(side, other));
  p.Set(5, rays(Eigen::Vector3d::Zero(), z));
  p.Set(6, rays(z, z));
  p.Set(7, rays(side, -Eigen::Vector3d(6, 0, 9).normalized()));  // behind the second camera only
  for (const CpuPath path : kPaths) {
    const std::vector<bool> left_out = LeftOut(p, 0.0, path);
    for (int k = 0; k < 8; ++k) EXPECT_EQ(left_out[k], p.Behind(k, 0.0)) << k;
    EXPECT_TRUE(left_out[0]);
    EXPECT_TRUE(left_out[1]);
    EXPECT_FALSE(left_out[2]);
  }
}

TEST(ScoreKernel, AParallaxAtTheLimitIsUndecided) {
  Problem p(1, 6);
  p.pose = Pose();
  p.pose.t = {-0.3, 0, 1};
  RayPair rays;
  rays.ray1.x = {0, 0, 1};
  rays.ray2.x = {-0.5, 0, 1};  // sin^2 = 0.25 without rounding
  p.Set(0, rays);
  ASSERT_EQ(TestCheirality(p.pose, rays, 0.49), Cheirality::kMixed);
  for (const CpuPath path : kPaths) {
    EXPECT_FALSE(LeftOut(p, 0.25, path)[0]);
    EXPECT_TRUE(LeftOut(p, std::nextafter(0.25, 0.0), path)[0]);
  }
}

TEST(ScoreKernel, DepthsAreCountedAsTestCheiralityJudgesThem) {
  constexpr double kMinSin = 0.02;
  int behind = 0, mixed = 0, undecided = 0;
  for (int size = 0; size < 70; ++size) {
    Problem p(size, 300 + size);
    for (int k = 0; k < size; k += 3) p.TurnSecondRay(k);
    DepthCounts expected;
    for (int k = 0; k < size; ++k) {
      if (!(p.Error(k) * p.Error(k) < kT2)) continue;
      const Cheirality side = p.Side(k, kMinSin);
      expected.in_front += side == Cheirality::kInFront;
      expected.behind += side == Cheirality::kBehind;
      expected.decided += side != Cheirality::kUndecided;
      mixed += side == Cheirality::kMixed;
      undecided += side == Cheirality::kUndecided;
    }
    behind += expected.behind;
    for (const CpuPath path : kPaths) {
      DepthCounts counts;
      CountDepths(p.pixels(), p.rays(), p.F.data(), p.motion(kMinSin * kMinSin), kT2, &counts,
                  path);
      EXPECT_EQ(counts.in_front, expected.in_front) << size;
      EXPECT_EQ(counts.behind, expected.behind) << size;
      EXPECT_EQ(counts.decided, expected.decided) << size;
    }
  }
  // All kinds occurred.
  EXPECT_GT(behind, 0);
  EXPECT_GT(mixed, 0);
  EXPECT_GT(undecided, 0);
}

}  // namespace
}  // namespace rigel
