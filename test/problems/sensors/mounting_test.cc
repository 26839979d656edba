// The rotation of a mounting as numbers and as a file.
#include "rigel/problems/sensors/mounting.h"

#include "rigel/core/pose.h"
#include "rigel/test/problems/sensors/sensors_test_file.h"

namespace rigel {
namespace {

using testing::EndsWith;

TEST_F(SensorFileTest, MountingIsAQuaternionOrAMatrix) {
  const Eigen::Matrix3d quarter = ExpSO3({0, 0, 1.5707963267948966});
  for (const std::string& text :
       {std::string("0.70710678,0,0,0.70710678"), std::string("0 -1 0 1 0 0 0 0 1"),
        Write("# of the car\n0,-1,0\n1,0,0\n\n0,0,1\n")}) {
    Eigen::Matrix3d R;
    std::string error;
    ASSERT_TRUE(ReadMounting(text, &R, &error)) << error;
    EXPECT_LT((R - quarter).norm(), 1e-7) << text;
    EXPECT_TRUE(IsRotation(R));
  }
}

TEST_F(SensorFileTest, WhatIsNoMountingIsRefused) {
  constexpr char kExpected[] =
      "expected a unit quaternion w,x,y,z or the nine of a rotation matrix, row by row";
  Eigen::Matrix3d R;
  std::string error;
  for (const char* text : {"1,2,3", "1,1,0,0", "1,0,0,0,1,0,0,0,-1", ""}) {
    EXPECT_FALSE(ReadMounting(text, &R, &error)) << text;
    EXPECT_THAT(error, EndsWith(kExpected));
  }
  EXPECT_FALSE(ReadMounting(Write("1 0 0\n0 one 0\n"), &R, &error));
  EXPECT_THAT(error, EndsWith("a.csv:2: '0 one 0', expected numbers"));
  EXPECT_FALSE(ReadMounting(directory_ + "/none", &R, &error));
}

}  // namespace
}  // namespace rigel
