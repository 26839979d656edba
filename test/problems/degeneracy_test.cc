// The table of docs/degeneracies.md is measured here: RIGEL_UPDATE_DOCS=1 writes it anew.
#include "rigel/problems/degeneracy.h"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "rigel/minimal/seventeen_point_li.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr char kBegin[] = "<!-- begin of the measured table -->\n";
constexpr char kEnd[] = "<!-- end of the measured table -->\n";
constexpr int kProblems = 100;

TEST(DegeneracyTest, TableOfTheDocumentationIsMeasured) {
  const std::string path = std::string(RIGEL_DOCS_DIR) + "/degeneracies.md";
  std::ifstream in(path);
  ASSERT_TRUE(in) << path;
  std::stringstream buffer;
  buffer << in.rdbuf();
  std::string text = buffer.str();
  const size_t begin = text.find(kBegin);
  const size_t end = text.find(kEnd);
  ASSERT_NE(begin, std::string::npos);
  ASSERT_NE(end, std::string::npos);
  const size_t start = begin + sizeof(kBegin) - 1;
  const std::string documented = text.substr(start, end - start);
  const std::string measured = "\n" + DegeneracyTable(kProblems) + "\n";
  if (std::getenv("RIGEL_UPDATE_DOCS") != nullptr) {
    text.replace(start, end - start, measured);
    std::ofstream(path) << text;
    return;
  }
  EXPECT_EQ(documented, measured) << "run with RIGEL_UPDATE_DOCS=1 to write the table anew";
}

TEST(DegeneracyTest, NoMotionIsNoSolution) {
  for (const SolverInfo& solver : SolverCatalogue()) {
    const DegeneracyCell cell = MeasureDegeneracy(solver, Configuration::kNoMotion, 20);
    EXPECT_EQ(cell.solved, 0.0) << solver.name;
  }
}

// A motion whose |t| nothing determines must not come with a scale that is said to be known.
TEST(DegeneracyTest, UndeterminedScaleIsFlagged) {
  for (const SolverInfo& solver : SolverCatalogue()) {
    // Ackermann motion of a camera off the rotation's axis does determine the scale.
    if (std::string(solver.name) == "2pt-ackermann") continue;
    for (const Configuration configuration :
         {Configuration::kPureTranslation, Configuration::kCentralRig, Configuration::kPanoramicRig,
          Configuration::kSingleCamera}) {
      const DegeneracyCell cell = MeasureDegeneracy(solver, configuration, 50);
      if (cell.solved < 0.05) continue;
      EXPECT_GE(cell.no_scale, 0.95 * cell.solved)
          << solver.name << ", " << ConfigurationName(configuration);
    }
  }
}

// What the page says of 17pt-li: it needs six matches of each of two cameras ...
TEST(DegeneracyTest, SeventeenPointsMustNotBeTooUneven) {
  SceneOptions scene;
  scene.noise_px = 0.0;
  scene.rotation_deg = 5.0;
  const FramePair pair = ScenePair(scene, 1);
  PreparedMatches matches;
  matches.Set(pair.rig, pair.matches, Alignment());
  for (const int first : {9, 11, 12, 14}) {
    std::vector<int> sample;  // the cameras alternate in the scene
    for (int k = 0; k < 17; ++k) sample.push_back(k < first ? 2 * k : 2 * k + 1);
    Solutions solutions;
    Solve17ptLi(matches, sample.data(), &solutions);
    double nearest = kPi;
    for (const Solution& s : solutions) {
      nearest = std::min(nearest, RotationError(pair.truth->R, s.R));
    }
    EXPECT_EQ(nearest < 1e-6, first < 12) << first;
  }
}

// ... and between two cameras its system loses a rank at R = I, which more matches do not mend.
TEST(DegeneracyTest, SystemOfSeventeenPointsLosesARankAtPureTranslation) {
  const auto rank = [](int num_cameras, double rotation_deg, bool inter) {
    SceneOptions scene;
    scene.num_cameras = num_cameras;
    scene.num_matches = 120;
    scene.noise_px = 0.0;
    scene.rotation_deg = rotation_deg;
    scene.motion = MotionPattern::kRandom;
    scene.inter_share = inter ? 1.0 : 0.0;
    const FramePair pair = ScenePair(scene, 1);
    Eigen::MatrixXd A(pair.matches.size(), 18);
    for (size_t m = 0; m < pair.matches.size(); ++m) {
      const Match& match = pair.matches[m];
      const Ray ray1 = MakeRay(pair.rig.cameras[match.camera1], match.pixel1);
      const Ray ray2 = MakeRay(pair.rig.cameras[match.camera2], match.pixel2);
      const Eigen::Matrix3d E = ray2.x * ray1.x.transpose();
      const Eigen::Matrix3d R =
          ray2.x * ray1.s.cross(ray1.x).transpose() + ray2.s.cross(ray2.x) * ray1.x.transpose();
      A.row(m) << E.reshaped().transpose(), R.reshaped().transpose();
    }
    const Eigen::VectorXd s = A.jacobiSvd().singularValues();
    return static_cast<int>((s.array() > 1e-9 * s(0)).count());
  };
  EXPECT_EQ(rank(2, 5.0, false), 14);
  EXPECT_EQ(rank(2, 0.0, false), 14);
  EXPECT_EQ(rank(2, 5.0, true), 14);
  EXPECT_EQ(rank(2, 0.0, true), 13);
  EXPECT_EQ(rank(3, 0.0, true), 17);
}

}  // namespace
}  // namespace rigel
