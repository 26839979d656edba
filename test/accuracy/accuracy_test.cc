// Accuracy regression: median errors of raw and refined motions in a few settings of the scene, of
// five rigs in the street and at one point of each experiment, against expected.json beside this
// file.
//
//   accuracy_test                 compares; names each deviation
//   accuracy_test --update        rewrites expected.json (test/accuracy/update.sh builds first)
//
// A change that moves a median on purpose comes with the updated file, so that its review shows
// what became better and what worse. The motions are deterministic, but another compiler or
// processor rounds differently; then RANSAC may keep another of two hypotheses that score alike in
// a pair or two, and a median of 60 pairs moves a little. The tolerances of expected.json leave
// room for that and not for more; they are edited by hand, --update keeps them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/experiments/experiment.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/test/accuracy/street_rigs.h"

namespace rigel {
namespace {

using Json = nlohmann::json;  // objects are sorted by key

constexpr int kPairs = 60;
constexpr int kThreads = 2;

struct Setting {
  const char* name;
  MotionPattern motion;
  double rotation_deg;
  RotationAxisPattern axis;
  double inter_share;
  double prior_noise_deg;
  const char* solver;
  RefineForm refine;
};

// What gtest and ctest call the parameter.
void PrintTo(const Setting& setting, std::ostream* stream) { *stream << setting.name; }

constexpr auto kForward = MotionPattern::kForward;
constexpr auto kRandom = MotionPattern::kRandom;
constexpr auto kSideways = MotionPattern::kSideways;
constexpr auto kPlanar = MotionPattern::kPlanar;
constexpr auto kY = RotationAxisPattern::kY;
constexpr auto kAny = RotationAxisPattern::kRandom;
constexpr auto kFull = RefineForm::kFull;
constexpr auto kPrior = RefineForm::kPrior;

// Named MOTION-ANGLE-MATCHES-SOLVER[-noise][-prior]: half of the matches are inter-camera in "half"
// settings, the prior is off by half a degree of pitch in "noise" settings, exact in the refinement
// of "prior" settings. All have 20 percent of outliers.
const Setting kSettings[] = {
    {"forward-1deg-intra-4pt_approx", kForward, 1, kY, 0, 0, "4pt-approx", kFull},
    {"forward-1deg-intra-4pt_approx_polished", kForward, 1, kY, 0, 0, "4pt-approx-polished", kFull},
    {"forward-1deg-intra-4pt", kForward, 1, kY, 0, 0, "4pt", kFull},
    {"forward-1deg-intra-4pt-noise", kForward, 1, kY, 0, 0.5, "4pt", kFull},
    {"forward-1deg-intra-4pt-prior", kForward, 1, kY, 0, 0, "4pt", kPrior},
    {"forward-1deg-half-4pt_axis", kForward, 1, kY, 0.5, 0, "4pt-axis", kFull},
    {"forward-1deg-half-4pt_axis-noise", kForward, 1, kY, 0.5, 0.5, "4pt-axis", kFull},
    {"forward-1deg-half-4pt_axis-prior", kForward, 1, kY, 0.5, 0, "4pt-axis", kPrior},
    {"forward-1deg-half-4pt_axis-noise-prior", kForward, 1, kY, 0.5, 0.5, "4pt-axis", kPrior},
    {"forward-10deg-intra-4pt_axis_approx", kForward, 10, kY, 0, 0, "4pt-axis-approx", kFull},
    {"forward-10deg-intra-4pt_axis_approx_polished", kForward, 10, kY, 0, 0,
     "4pt-axis-approx-polished", kFull},
    {"forward-10deg-intra-4pt_axis", kForward, 10, kY, 0, 0, "4pt-axis", kFull},
    {"sideways-1deg-intra-4pt_axis", kSideways, 1, kY, 0, 0, "4pt-axis", kFull},
    {"sideways-10deg-half-4pt", kSideways, 10, kY, 0.5, 0, "4pt", kFull},
    {"random-1deg-half-4pt_approx", kRandom, 1, kAny, 0.5, 0, "4pt-approx", kFull},
    {"random-10deg-half-4pt", kRandom, 10, kAny, 0.5, 0, "4pt", kFull},
    {"random-10deg-half-4pt-noise", kRandom, 10, kAny, 0.5, 0.5, "4pt", kFull},
    {"planar-1deg-intra-3pt_approx", kPlanar, 1, kY, 0, 0, "3pt-approx", kFull},
    {"planar-1deg-half-3pt", kPlanar, 1, kY, 0.5, 0, "3pt", kFull},
    {"planar-1deg-half-3pt-prior", kPlanar, 1, kY, 0.5, 0, "3pt", kPrior},
    {"planar-10deg-intra-3pt_approx_polished", kPlanar, 10, kY, 0, 0, "3pt-approx-polished", kFull},
    {"planar-10deg-half-3pt-noise", kPlanar, 10, kY, 0.5, 0.5, "3pt", kFull},
};

// Named street-RIG[-body]: with the body's axes as prior in "body" settings, else without prior.
// The noise is unknown, |t| is unknown, 20 percent are outliers. Turns are of 1 degree.
struct StreetSetting {
  const char* name;
  StreetOptions (*street)();
  bool body_prior;
  double inter_share;
};
void PrintTo(const StreetSetting& setting, std::ostream* stream) { *stream << setting.name; }

const StreetSetting kStreetSettings[] = {
    {"street-front_camera", &FrontCamera, false, 0.0},
    {"street-front_camera-body", &FrontCamera, true, 0.0},
    {"street-front_stereo", &FrontStereo, false, 0.3},
    {"street-front_stereo-body", &FrontStereo, true, 0.3},
    {"street-four_cameras", &FourCameras, false, 0.0},
    {"street-four_cameras-body", &FourCameras, true, 0.0},
    {"street-six_cameras", &SixCameras, false, 0.0},
    {"street-six_cameras-body", &SixCameras, true, 0.0},
    {"street-camera_frame_stereo", &CameraFrameStereo, false, 0.3},
    {"street-camera_frame_stereo-body", &CameraFrameStereo, true, 0.3},
};

// To 4 significant digits, so that the file stays the same when nothing has changed.
double Rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return std::stod(text);
}

// Quantity to median, "raw_rotation_deg" and so on, and "failures"; without those that are not
// observable.
Json Medians(const SolverSummary& summary) {
  Json medians;
  medians["failures"] = summary.failures;
  const auto put = [&](const char* name, const std::optional<Statistics>& s) {
    if (s) medians[name] = Rounded(s->median);
  };
  put("raw_rotation_deg", summary.raw_rotation_deg);
  put("raw_direction_deg", summary.raw_direction_deg);
  put("raw_scale", summary.raw_scale);
  put("refined_rotation_deg", summary.refined_rotation_deg);
  put("refined_direction_deg", summary.refined_direction_deg);
  put("refined_scale", summary.refined_scale);
  return medians;
}

Json Measure(const Setting& setting) {
  SceneOptions scene;
  scene.num_matches = 150;
  scene.motion = setting.motion;
  scene.rotation_deg = setting.rotation_deg;
  scene.rotation_axis = setting.axis;
  scene.inter_share = setting.inter_share;
  scene.outlier_share = 0.2;
  PriorSourceOptions prior;
  prior.noise = DegToRad(setting.prior_noise_deg);
  std::vector<FramePair> pairs(kPairs);
  for (int k = 0; k < kPairs; ++k) {
    std::string error;
    EXPECT_TRUE(MakeScenePair(scene, k, &pairs[k], &error) &&
                ApplyPriorSource(prior, k, &pairs[k], &error))
        << error;
  }
  EstimateOptions options;
  options.solver = setting.solver;
  options.refine.form = setting.refine;
  const SolverSummary summary =
      Summarize(setting.solver, "all", RunSolver(pairs, options, kThreads, {}));
  return Medians(summary);
}

// Medians, RMS errors over RMS bounds, and the mean NEES over degrees of freedom.
Json MeasureStreet(const StreetSetting& setting) {
  StreetOptions street = setting.street();
  street.outlier_share = 0.2;
  street.inter_share = setting.inter_share;
  PriorSourceOptions prior;
  prior.source = PriorSource::kBody;
  prior.down = street.axes.down;
  prior.forward = street.axes.forward;
  std::vector<FramePair> pairs(kPairs);
  for (int k = 0; k < kPairs; ++k) {
    std::string error;
    EXPECT_TRUE(MakeStreetPair(street, k, &pairs[k], &error)) << error;
    if (setting.body_prior) {
      EXPECT_TRUE(ApplyPriorSource(prior, k, &pairs[k], &error)) << error;
    } else {
      pairs[k].prior = MotionPrior();
    }
  }
  const SolverSummary summary =
      Summarize("auto", "all", RunSolver(pairs, EstimateOptions(), kThreads, {}));
  Json measured = Medians(summary);
  const auto put_efficiency = [&](const char* name, const std::optional<Statistics>& error,
                                  const std::optional<Statistics>& bound) {
    if (error && bound) measured[name] = Rounded(error->rms / bound->rms);
  };
  put_efficiency("bound_share_rotation", summary.refined_rotation_deg, summary.bound_rotation_deg);
  put_efficiency("bound_share_rig_direction", summary.refined_rig_direction_deg,
                 summary.bound_rig_direction_deg);
  if (summary.nees) measured["nees"] = Rounded(summary.nees->ratio);
  return measured;
}

// The experiments, thinned: the largest value of the grid, random motion. 6pt-stewenius would take
// nine tenths of the time; the motions of drives need files of their own.
std::vector<std::string> ExperimentNamesHere() {
  std::vector<std::string> names;
  for (const ExperimentSpec& spec : ExperimentCatalogue()) {
    if (spec.variable != ExperimentVariable::kNone) names.push_back(spec.name);
  }
  return names;
}

// Entry, "experiment-outliers-80-4pt_liu-paper" and so on, to its medians.
Json MeasureExperiment(const std::string& name) {
  ExperimentSpec spec = *FindExperiment(name);
  spec.solvers.erase(std::remove(spec.solvers.begin(), spec.solvers.end(), "6pt-stewenius"),
                     spec.solvers.end());
  ExperimentOptions options;
  options.pairs = kPairs;
  options.num_threads = kThreads;
  ExperimentPlan plan;
  std::string error;
  EXPECT_TRUE(PlanExperiment(spec, options, &plan, &error)) << error;
  const double last = spec.values.back();
  std::vector<ExperimentRow> rows;
  EXPECT_TRUE(RunExperimentPoint(plan, {"random", "", last}, {}, {}, &rows, &error)) << error;
  Json entries;
  for (const ExperimentRow& row : rows) {
    std::ostringstream entry;
    entry << "experiment-" << name << "-" << last << "-" << row.summary.solver << "-" << row.loop;
    entries[entry.str()] = Medians(row.summary);
  }
  return entries;
}

Json ReadExpected() {
  std::ifstream file(RIGEL_ACCURACY_DATA);
  Json expected = Json::parse(file, nullptr, false);
  EXPECT_TRUE(expected.is_object()) << RIGEL_ACCURACY_DATA << " cannot be read";
  return expected.is_object() ? expected : Json::object();
}

std::string Text(const Json& number) { return number.is_null() ? "nothing" : number.dump(); }

// relative * |expected| + absolute.
double Tolerance(const Json& tolerances, const std::string& quantity, const Json& expected) {
  const Json entry = tolerances.value(quantity, Json::object());
  const double value = expected.is_number() ? expected.get<double>() : 0.0;
  return entry.value("relative", 0.0) * std::abs(value) + entry.value("absolute", 0.0);
}

class Accuracy : public testing::TestWithParam<Setting> {};

std::string TestName(std::string name) {
  for (char& c : name) {
    if (c == '-') c = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scene, Accuracy, testing::ValuesIn(kSettings),
                         [](const auto& setting) { return TestName(setting.param.name); });

void ExpectAsExpected(const std::string& name, const Json& measured) {
  const Json file = ReadExpected();
  const Json tolerances = file.value("tolerances", Json::object());
  const Json expected = file.value("medians", Json::object()).value(name, Json::object());
  Json quantities = measured;  // of both
  quantities.update(expected);
  for (const auto& [quantity, ignored] : quantities.items()) {
    const Json want = expected.value(quantity, Json());
    const Json got = measured.value(quantity, Json());
    const double tolerance = Tolerance(tolerances, quantity, want);
    const bool agree = want.is_number() && got.is_number() &&
                       std::abs(got.get<double>() - want.get<double>()) <= tolerance;
    EXPECT_TRUE(agree) << name << "/" << quantity << ": expected " << Text(want) << " +- "
                       << Text(Rounded(tolerance)) << ", got " << Text(got)
                       << "\nif that is meant to be: test/accuracy/update.sh";
  }
}

TEST_P(Accuracy, MediansAreAsExpected) { ExpectAsExpected(GetParam().name, Measure(GetParam())); }

class StreetAccuracy : public testing::TestWithParam<StreetSetting> {};

INSTANTIATE_TEST_SUITE_P(Rigs, StreetAccuracy, testing::ValuesIn(kStreetSettings),
                         [](const auto& setting) { return TestName(setting.param.name); });

TEST_P(StreetAccuracy, FiguresAreAsExpected) {
  ExpectAsExpected(GetParam().name, MeasureStreet(GetParam()));
}

class ExperimentAccuracy : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Experiments, ExperimentAccuracy, testing::ValuesIn(ExperimentNamesHere()),
                         [](const auto& name) {
                           std::string text = name.param;
                           std::replace(text.begin(), text.end(), '-', '_');
                           return text;
                         });

TEST_P(ExperimentAccuracy, MediansAreAsExpected) {
  const Json measured = MeasureExperiment(GetParam());
  for (const auto& [name, medians] : measured.items()) ExpectAsExpected(name, medians);
}

TEST(AccuracyData, HasTheSettingsOfTheTestAndNoOthers) {
  const Json file = ReadExpected();
  std::map<std::string, int> names;
  for (const Setting& setting : kSettings) EXPECT_EQ(++names[setting.name], 1) << setting.name;
  for (const StreetSetting& street : kStreetSettings) EXPECT_EQ(++names[street.name], 1);
  const Json all = file.value("medians", Json::object());
  const Json tolerances = file.value("tolerances", Json::object());
  int num_of_experiments = 0;
  for (const auto& [name, medians] : all.items()) {
    const bool of_experiment = name.rfind("experiment-", 0) == 0;
    num_of_experiments += of_experiment;
    EXPECT_EQ(names.count(name), of_experiment ? 0u : 1u) << name << " is in the file only";
    for (const auto& [quantity, value] : medians.items()) {
      EXPECT_TRUE(tolerances.contains(quantity)) << quantity << " has no tolerance";
    }
  }
  int wanted = 0;  // both loops
  for (const std::string& name : ExperimentNamesHere()) {
    const std::vector<std::string>& solvers = FindExperiment(name)->solvers;
    wanted += 2 * static_cast<int>(solvers.size());
    wanted -= 2 * static_cast<int>(std::count(solvers.begin(), solvers.end(), "6pt-stewenius"));
  }
  EXPECT_EQ(num_of_experiments, wanted) << "the file has too few or too many experiments";
}

// One line a stage of a setting, so that a diff shows what moved.
std::string Format(const Json& file) {
  std::ostringstream text;
  text << "{\n";
  text << "  \"about\": " << file["about"].dump() << ",\n";
  text << "  \"medians\": {\n";
  const Json& medians = file["medians"];
  size_t settings = 0;
  for (const auto& [name, values] : medians.items()) {
    text << "    " << Json(name).dump() << ": {";
    std::string stage;
    size_t quantities = 0;
    for (const auto& [quantity, value] : values.items()) {
      const std::string its_stage = quantity.substr(0, quantity.find('_'));
      text << (its_stage == stage ? " " : "\n      ") << Json(quantity).dump() << ": "
           << value.dump() << (++quantities < values.size() ? "," : "");
      stage = its_stage;
    }
    text << "\n    }" << (++settings < medians.size() ? "," : "") << "\n";
  }
  text << "  },\n  \"tolerances\": {\n";
  const Json& tolerances = file["tolerances"];
  size_t quantities = 0;
  for (const auto& [quantity, value] : tolerances.items()) {
    text << "    " << Json(quantity).dump() << ": {\"absolute\": " << value["absolute"].dump()
         << ", \"relative\": " << value["relative"].dump() << "}"
         << (++quantities < tolerances.size() ? "," : "") << "\n";
  }
  text << "  }\n}\n";
  return text.str();
}

int Update() {
  Json file = ReadExpected();
  if (!file.contains("about") || !file.contains("tolerances")) {
    std::cerr << RIGEL_ACCURACY_DATA
              << ": no \"about\" or no \"tolerances\", which only an editor adds\n";
    return 1;
  }
  const Json before = file.value("medians", Json::object());
  Json all = Json::object();
  for (const Setting& setting : kSettings) all[setting.name] = Measure(setting);
  for (const StreetSetting& street : kStreetSettings) all[street.name] = MeasureStreet(street);
  for (const std::string& name : ExperimentNamesHere()) all.update(MeasureExperiment(name));
  file["medians"] = all;
  int changed = 0;
  for (const auto& [name, medians] : all.items()) {
    const Json old = before.value(name, Json::object());
    Json quantities = medians;
    quantities.update(old);
    for (const auto& [quantity, ignored] : quantities.items()) {
      const Json was = old.value(quantity, Json());
      const Json is = medians.value(quantity, Json());
      if (was == is) continue;
      ++changed;
      std::cout << name << "/" << quantity << ": " << Text(was) << " -> " << Text(is) << "\n";
    }
  }
  std::ofstream stream(RIGEL_ACCURACY_DATA, std::ios::binary);
  stream << Format(file);
  stream.close();
  if (!stream || testing::Test::HasFailure()) {
    std::cerr << RIGEL_ACCURACY_DATA << ": cannot be written\n";
    return 1;
  }
  std::cout << changed << " medians changed in " << RIGEL_ACCURACY_DATA << "\n";
  return 0;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (argc == 2 && std::strcmp(argv[1], "--update") == 0) return rigel::Update();
  if (argc > 1) {
    std::cerr << "unexpected argument " << argv[1] << "; expected --update or nothing\n";
    return 2;
  }
  return RUN_ALL_TESTS();
}
