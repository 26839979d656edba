// What each minimal solver makes of degenerate configurations. The table of docs/degeneracies.md is
// measured here: RIGEL_UPDATE_DOCS=1 writes it anew.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "rigel/core/angles.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/metrics.h"
#include "rigel/core/random.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/ransac/sampler.h"
#include "rigel/minimal/solvers/seventeen_point_li.h"
#include "rigel/test/core/pinhole.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

// A configuration of rig, motion, scene and matches.
enum class Configuration {
  kInter,                 // between two cameras: the regular case, for comparison
  kIntra,                 // within each of two cameras
  kIntraThree,            // within each of three cameras
  kPureTranslation,       // within the cameras, no rotation
  kCentralRig,            // all camera centres at the body's origin
  kPanoramicRig,          // all camera centres at one point off the origin
  kAxialRig,              // three centres on one line, matches between cameras
  kSingleCamera,          // one camera off the origin
  kForwardMotion,         // t along +z, within the cameras
  kNoMotion,              // R = I, t = 0, within the cameras
  kHorizon,               // all rays perpendicular to the vertical, between cameras
  kPlanarScene,           // all points on the ground, between cameras
  kPureTranslationInter,  // between cameras, no rotation
};

// Shares of noise-free problems.
struct DegeneracyCell {
  double solved = 0.0;     // with any solution
  double rotation = 0.0;   // with a solution of the true rotation (to 1e-4 rad) ...
  double direction = 0.0;  // ... and the true direction of t (to 0.3 deg) or, at t = 0, any
  double scale = 0.0;      // ... and the true |t| (to 5 percent), said to be known
  double no_scale = 0.0;   // the solution nearest to the truth says that |t| is not known
};

constexpr double kRotationTolerance = 1e-4;
constexpr double kDirectionTolerance = 5e-3;
constexpr double kScaleTolerance = 0.05;
// A property is claimed for a configuration if it holds in this share of the problems.
constexpr double kClaimed = 0.95;

struct DegenerateProblem {
  Rig rig;
  Pose truth;
  MotionPrior prior;
  std::vector<Match> matches;
};

Rig MakeRig(Configuration configuration, Random* random) {
  int num_cameras = 2;
  if (configuration == Configuration::kSingleCamera) num_cameras = 1;
  if (configuration == Configuration::kIntraThree || configuration == Configuration::kAxialRig) {
    num_cameras = 3;
  }
  Rig rig;
  for (int k = 0; k < num_cameras; ++k) {
    const Eigen::Vector3d positions[3] = {{-0.5, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.0, 0.4, 0.3}};
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400.0, 400.0, 320.0, 240.0, 640, 480);
    camera.Q = ExpSO3(0.1 * random->NormalVector3());
    camera.s = positions[k] + 0.05 * random->NormalVector3();
    switch (configuration) {
      case Configuration::kCentralRig:
        camera.s.setZero();
        break;
      case Configuration::kPanoramicRig:
        camera.s = {0.3, -0.2, 0.5};
        break;
      case Configuration::kAxialRig:
        camera.s = Eigen::Vector3d(0.1, -0.2, 0.3) + (k - 1) * Eigen::Vector3d(0.5, 0.02, 0.1);
        break;
      case Configuration::kHorizon:
        // Level cameras at one height, so that the horizon is y = 0 for all.
        camera.Q = RotationY(0.1 * random->Normal());
        camera.s.y() = 0.0;
        break;
      default:
        break;
    }
    rig.cameras.push_back(camera);
  }
  return rig;
}

bool MakeProblem(const SolverInfo& solver, Configuration configuration, int index,
                 DegenerateProblem* problem) {
  Random random =
      Random::Stream(static_cast<uint64_t>(configuration) + 1, static_cast<uint64_t>(index));
  problem->rig = MakeRig(configuration, &random);
  const double degrees = solver.exact ? 5.0 : 0.1;
  Pose& truth = problem->truth;
  truth.R = RotationY(DegToRad(degrees));
  // Every solver's prior is to be true, the planar ones' as well.
  const double heading = random.Uniform(0.0, 2.0 * kPi);
  truth.t = {std::sin(heading), solver.prior == PriorKind::kPlanar ? 0.0 : 0.3 * random.Normal(),
             std::cos(heading)};
  if (configuration == Configuration::kForwardMotion) truth.t = Eigen::Vector3d::UnitZ();
  if (configuration == Configuration::kHorizon) truth.t.y() = 0.0;
  const bool pure_translation = configuration == Configuration::kPureTranslation ||
                                configuration == Configuration::kPureTranslationInter;
  if (pure_translation) truth.R.setIdentity();
  if (configuration == Configuration::kNoMotion) truth = Pose();
  if (std::string_view(solver.name) == "2pt-ackermann" &&
      configuration != Configuration::kNoMotion) {
    const double half = pure_translation ? 0.0 : 0.5 * degrees;
    truth.t = -(RotationY(DegToRad(half)) * Eigen::Vector3d::UnitZ());
  }
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  problem->prior.gravity1 = problem->prior.gravity2 = y;
  problem->prior.axis = problem->prior.normal = y;
  problem->prior.forward = Eigen::Vector3d::UnitZ();

  const int num_cameras = problem->rig.size();
  bool inter = false;
  switch (configuration) {
    case Configuration::kInter:
    case Configuration::kAxialRig:
    case Configuration::kHorizon:
    case Configuration::kPlanarScene:
    case Configuration::kPureTranslationInter:
      inter = solver.sampling != SampleKind::kOneCamera;
      break;
    default:
      break;
  }
  const int wanted = 4 * solver.sample_size;
  problem->matches.clear();
  for (int draw = 0; draw < 20000 && static_cast<int>(problem->matches.size()) < wanted; ++draw) {
    Match match;
    match.camera1 = draw % num_cameras;
    match.camera2 = inter ? (match.camera1 + 1) % num_cameras : match.camera1;
    const RigCamera& camera1 = problem->rig.cameras[match.camera1];
    const RigCamera& camera2 = problem->rig.cameras[match.camera2];
    match.pixel1 = {random.Uniform(0.0, 640.0), random.Uniform(0.0, 480.0)};
    double depth = random.Uniform(5.0, 30.0);
    const Ray ray = MakeRay(camera1, match.pixel1);
    Eigen::Vector3d X = ray.s + depth * ray.x;
    if (configuration == Configuration::kHorizon) X.y() = 0.0;
    if (configuration == Configuration::kPlanarScene) {
      // The ground, 1.5 m below the body.
      if (!(ray.x.y() > 0.02)) continue;
      depth = (1.5 - ray.s.y()) / ray.x.y();
      X = ray.s + depth * ray.x;
    }
    const Eigen::Vector3d X1 = camera1.Q.transpose() * (X - camera1.s);
    const Eigen::Vector3d X2 = camera2.Q.transpose() * (truth * X - camera2.s);
    if (!(X1.z() > 0.1 && X2.z() > 0.1)) continue;
    match.pixel1 = ProjectPinhole(camera1.intrinsics, X1);
    match.pixel2 = ProjectPinhole(camera2.intrinsics, X2);
    if (!camera2.intrinsics.InImage(match.pixel2)) continue;
    problem->matches.push_back(match);
  }
  return static_cast<int>(problem->matches.size()) == wanted;
}

std::string CellText(const DegeneracyCell& cell, bool no_motion) {
  if (cell.solved < 1.0 - kClaimed) return "none";
  std::string text;
  if (cell.rotation >= kClaimed) text += "R";
  if (!no_motion && cell.direction >= kClaimed) text += " t";
  if (!no_motion && cell.scale >= kClaimed) text += " s";
  if (text.empty()) {
    text = cell.rotation < 1.0 - kClaimed
               ? "-"
               : "R " + std::to_string(static_cast<int>(std::lround(100 * cell.rotation))) + " %";
  }
  if (cell.no_scale >= kClaimed) text += " (s?)";
  return text;
}

const std::vector<Configuration>& AllConfigurations() {
  static const std::vector<Configuration> all = {Configuration::kInter,
                                                 Configuration::kIntra,
                                                 Configuration::kIntraThree,
                                                 Configuration::kPureTranslation,
                                                 Configuration::kPureTranslationInter,
                                                 Configuration::kCentralRig,
                                                 Configuration::kPanoramicRig,
                                                 Configuration::kAxialRig,
                                                 Configuration::kSingleCamera,
                                                 Configuration::kForwardMotion,
                                                 Configuration::kNoMotion,
                                                 Configuration::kHorizon,
                                                 Configuration::kPlanarScene};
  return all;
}

const char* ConfigurationName(Configuration configuration) {
  switch (configuration) {
    case Configuration::kInter:
      return "inter-camera";
    case Configuration::kIntra:
      return "intra, 2 cameras";
    case Configuration::kIntraThree:
      return "intra, 3 cameras";
    case Configuration::kPureTranslation:
      return "pure translation, intra";
    case Configuration::kPureTranslationInter:
      return "pure translation, inter";
    case Configuration::kCentralRig:
      return "central rig";
    case Configuration::kPanoramicRig:
      return "panoramic rig";
    case Configuration::kAxialRig:
      return "axial rig";
    case Configuration::kSingleCamera:
      return "single camera";
    case Configuration::kForwardMotion:
      return "forward motion";
    case Configuration::kNoMotion:
      return "no motion";
    case Configuration::kHorizon:
      return "horizon";
    case Configuration::kPlanarScene:
      return "planar scene";
  }
  return "unknown";
}

// Rotation of 5 degrees for exact solvers and 0.1 degrees for first-order ones, so that their bias
// stays below the tolerances.
DegeneracyCell MeasureDegeneracy(const SolverInfo& solver, Configuration configuration,
                                 int num_problems) {
  DegeneracyCell cell;
  int problems = 0;
  for (int k = 0; k < num_problems; ++k) {
    DegenerateProblem problem;
    if (!MakeProblem(solver, configuration, k, &problem)) continue;
    ++problems;
    Alignment alignment;
    std::string error;
    if (!MakeAlignment(problem.prior, solver.prior, &alignment, &error)) continue;
    const GroupedMatches grouped(problem.rig, problem.matches);
    const PreparedMatches matches(problem.rig, grouped.matches(), alignment);
    const Sampler sampler(grouped.groups(), solver.sampling, solver.sample_size);
    Random random = Random::Stream(99, static_cast<uint64_t>(k));
    std::vector<int> sample(64);
    Solutions solutions;
    if (sampler.Draw(&random, sample.data())) solver.solve(matches, sample.data(), &solutions);
    bool rotation = false, direction = false, scale = false, no_scale = false;
    double nearest = std::numeric_limits<double>::infinity();
    const bool still = problem.truth.t.isZero(0);
    for (const Solution& solution : solutions) {
      const double r = RotationError(problem.truth.R, solution.R);
      if (r < nearest) {
        nearest = r;
        no_scale = !solution.has_scale;
      }
      if (!(r < kRotationTolerance)) continue;
      rotation = true;
      if (!still &&
          !(TranslationDirectionError(problem.truth.t, solution.t) < kDirectionTolerance)) {
        continue;
      }
      direction = true;
      if (solution.has_scale && !still &&
          ScaleError(problem.truth.t, solution.t) < kScaleTolerance) {
        scale = true;
      }
    }
    cell.solved += solutions.empty() ? 0 : 1;
    cell.rotation += rotation ? 1 : 0;
    cell.direction += direction ? 1 : 0;
    cell.scale += scale ? 1 : 0;
    cell.no_scale += no_scale ? 1 : 0;
  }
  if (problems > 0) {
    for (double* share :
         {&cell.solved, &cell.rotation, &cell.direction, &cell.scale, &cell.no_scale}) {
      *share /= problems;
    }
  }
  return cell;
}

// The table of docs/degeneracies.md: Markdown, one row a solver, one column a configuration.
std::string DegeneracyTable(int num_problems) {
  std::string text = "| solver |";
  std::string rule = "| --- |";
  for (const Configuration configuration : AllConfigurations()) {
    text += std::string(" ") + ConfigurationName(configuration) + " |";
    rule += " --- |";
  }
  text += "\n" + rule + "\n";
  for (const SolverInfo& solver : SolverCatalogue()) {
    text += std::string("| `") + solver.name + "` |";
    for (const Configuration configuration : AllConfigurations()) {
      text += " " +
              CellText(MeasureDegeneracy(solver, configuration, num_problems),
                       configuration == Configuration::kNoMotion) +
              " |";
    }
    text += "\n";
  }
  return text;
}

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
