#include "rigel/core/frame_pair.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

using ::testing::HasSubstr;

FramePair MakePair() {
  FramePair pair;
  pair.rig.cameras.resize(2);
  pair.matches.resize(3);
  pair.matches[1].camera1 = 1;
  pair.matches[2].camera2 = 1;
  return pair;
}

TEST(FramePair, AcceptsAValidPair) {
  std::string error;
  EXPECT_TRUE(MakePair().IsValid(&error)) << error;
  EXPECT_TRUE(FramePair().IsValid(&error)) << error;
}

TEST(FramePair, RejectsAnInvalidRig) {
  FramePair pair = MakePair();
  pair.rig.cameras[1].intrinsics.parameters[0] = -1.0;
  std::string error;
  EXPECT_FALSE(pair.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("camera 1"));
}

TEST(FramePair, RejectsAMatchOfAnUnknownCamera) {
  for (const int camera : {-1, 2, 1000}) {
    for (const bool first : {true, false}) {
      FramePair pair = MakePair();
      (first ? pair.matches[2].camera1 : pair.matches[2].camera2) = camera;
      std::string error;
      EXPECT_FALSE(pair.IsValid(&error)) << camera;
      EXPECT_THAT(error, HasSubstr("match 2"));
      EXPECT_THAT(error, HasSubstr("0..1"));
    }
  }
}

TEST(FramePair, RejectsAPixelThatIsNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    for (int k = 0; k < 4; ++k) {
      FramePair pair = MakePair();
      (k < 2 ? pair.matches[1].pixel1 : pair.matches[1].pixel2)[k % 2] = bad;
      std::string error;
      EXPECT_FALSE(pair.IsValid(&error)) << k;
      EXPECT_THAT(error, HasSubstr("match 1"));
      EXPECT_THAT(error, HasSubstr("finite"));
    }
  }
}

TEST(FramePair, RejectsTimesTruthAndNoiseThatMakeNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto error_of = [](const FramePair& pair) {
    std::string error;
    EXPECT_FALSE(pair.IsValid(&error));
    return error;
  };
  for (const double bad : {nan, inf, -inf}) {
    FramePair pair = MakePair();
    pair.time1 = bad;
    EXPECT_THAT(error_of(pair), HasSubstr("time"));
    pair = MakePair();
    pair.time2 = bad;
    EXPECT_THAT(error_of(pair), HasSubstr("time"));
    pair = MakePair();
    pair.truth = Pose();
    pair.truth->t.y() = bad;
    EXPECT_THAT(error_of(pair), HasSubstr("truth"));
  }
  for (const double bad : {0.0, -1.0, nan, inf}) {
    FramePair pair = MakePair();
    pair.noise_px = bad;
    EXPECT_THAT(error_of(pair), HasSubstr("noise_px"));
  }
  FramePair pair = MakePair();
  pair.truth = Pose();
  pair.truth->R(0, 0) = 1.01;
  EXPECT_THAT(error_of(pair), HasSubstr("truth"));
  pair.truth->R = -Eigen::Matrix3d::Identity();
  EXPECT_THAT(error_of(pair), HasSubstr("truth"));
  pair = MakePair();
  pair.prior.axis = Eigen::Vector3d(0, 2, 0);
  EXPECT_THAT(error_of(pair), HasSubstr("axis"));
  // A pair may go back in time.
  pair = MakePair();
  pair.time1 = 2.0;
  pair.time2 = -1.0;
  pair.truth = Pose();
  pair.noise_px = 0.5;
  std::string error;
  EXPECT_TRUE(pair.IsValid(&error)) << error;
}

TEST(FramePair, AMatchIsIntraIfItsCamerasAreTheSame) {
  const FramePair pair = MakePair();
  EXPECT_TRUE(pair.matches[0].IsIntra());
  EXPECT_FALSE(pair.matches[1].IsIntra());
  EXPECT_FALSE(pair.matches[2].IsIntra());
}

}  // namespace
}  // namespace rigel
