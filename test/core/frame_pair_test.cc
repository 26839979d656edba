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
  pair.rig.cameras[1].intrinsics.fx = -1.0;
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

TEST(FramePair, AMatchIsIntraIfItsCamerasAreTheSame) {
  const FramePair pair = MakePair();
  EXPECT_TRUE(pair.matches[0].IsIntra());
  EXPECT_FALSE(pair.matches[1].IsIntra());
  EXPECT_FALSE(pair.matches[2].IsIntra());
}

}  // namespace
}  // namespace rigel
