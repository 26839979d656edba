#include "rigel/core/rig.h"

#include <functional>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/pose.h"

namespace rigel {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Rig MakeRig() {
  Rig rig;
  for (int k = 0; k < 3; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400.0, 410.0, 320.0, 240.0, 640, 480);
    camera.Q = ExpSO3(Eigen::Vector3d(0.1, 0.2 * k, -0.3));
    camera.s = Eigen::Vector3d(0.5 * k, 0.0, 1.0);
    rig.cameras.push_back(camera);
  }
  return rig;
}

TEST(Rig, AcceptsAValidRig) {
  std::string error = "untouched";
  EXPECT_TRUE(MakeRig().IsValid(&error));
  EXPECT_EQ(error, "untouched");
  EXPECT_EQ(MakeRig().size(), 3);
}

TEST(Rig, ToleratesARotationOfSixDigits) {
  // Calibration files are rounded.
  Rig rig = MakeRig();
  rig.cameras[1].Q.array() += 1e-8;
  std::string error;
  EXPECT_TRUE(rig.IsValid(&error)) << error;
}

TEST(Rig, NamesTheCameraAndWhatIsWrong) {
  struct Case {
    const char* message;
    std::function<void(RigCamera*)> damage;
  };
  const Case cases[] = {
      {"pinhole: fx is", [](RigCamera* c) { c->intrinsics.parameters[0] = 0.0; }},
      {"pinhole: fx is", [](RigCamera* c) { c->intrinsics.parameters[0] = -400.0; }},
      {"pinhole: fy is", [](RigCamera* c) { c->intrinsics.parameters[1] = 0.0; }},
      {"pinhole: fx is", [](RigCamera* c) { c->intrinsics.parameters[0] = kNan; }},
      {"pinhole: fy is", [](RigCamera* c) { c->intrinsics.parameters[1] = kNan; }},
      {"pinhole: fx is", [](RigCamera* c) { c->intrinsics.parameters[0] = kInf; }},
      {"pinhole: fy is", [](RigCamera* c) { c->intrinsics.parameters[1] = kInf; }},
      {"pinhole: cx is", [](RigCamera* c) { c->intrinsics.parameters[2] = kNan; }},
      {"pinhole: cy is", [](RigCamera* c) { c->intrinsics.parameters[3] = kInf; }},
      {"position", [](RigCamera* c) { c->s.y() = kNan; }},
      {"sigmas", [](RigCamera* c) { c->rotation_sigma = -1.0; }},
      {"sigmas", [](RigCamera* c) { c->position_sigma = kNan; }},
      {"sigmas", [](RigCamera* c) { c->focal_sigma = kInf; }},
      {"time offset", [](RigCamera* c) { c->time_offset = kNan; }},
      {"rotation", [](RigCamera* c) { c->Q(1, 2) = kNan; }},
      {"rotation", [](RigCamera* c) { c->Q(1, 2) += 1e-3; }},
      {"rotation", [](RigCamera* c) { c->Q *= 1.01; }},
      {"rotation", [](RigCamera* c) { c->Q.setZero(); }},
      // Orthonormal, but a reflection.
      {"rotation", [](RigCamera* c) { c->Q.col(0) = -c->Q.col(0).eval(); }},
  };
  for (size_t k = 0; k < std::size(cases); ++k) {
    Rig rig = MakeRig();
    cases[k].damage(&rig.cameras[1]);
    std::string error;
    EXPECT_FALSE(rig.IsValid(&error)) << "case " << k;
    EXPECT_THAT(error, HasSubstr("camera 1")) << "case " << k;
    EXPECT_THAT(error, HasSubstr(cases[k].message)) << "case " << k;
  }
}

}  // namespace
}  // namespace rigel
