#include "rigel/problems/evaluation/rig_test_report.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <vector>

#include "rigel/core/angles.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTurnNames[] = {"pitch", "yaw", "roll"};

// Degrees; those that are not known are left out.
Json TurnJson(const std::array<std::optional<double>, 3>& turn) {
  Json json = Json::object();
  for (int axis = 0; axis < 3; ++axis) {
    if (turn[axis]) json[kTurnNames[axis]] = RadToDeg(*turn[axis]);
  }
  return json;
}

// The turns of a camera that are not within the noise and the usual errors of a calibration, the
// largest one if that can be said of none. " pitch -0.022 +- 0.001 deg, roll ...".
std::string TurnText(const CameraTurn& camera) {
  constexpr double kSigmas = 3.0;  // of the noise, and of what every calibration is off by
  std::string text, largest;
  double most = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!camera.turn[axis]) continue;
    const double turn = RadToDeg(*camera.turn[axis]);
    const double sigma = RadToDeg(*camera.sigma[axis]);
    char words[80];
    std::snprintf(words, sizeof(words), " %s %.3f +- %.3f deg", kTurnNames[axis], turn, sigma);
    const double ratio = std::abs(turn) / std::hypot(sigma, kUsualTurnDeg);
    if (ratio > kSigmas) text += (text.empty() ? "" : ",") + std::string(words);
    if (ratio > most) {
      most = ratio;
      largest = words;
    }
  }
  return text.empty() ? largest : text;
}

std::string ProbabilityText(double p) {
  constexpr double kLeast = 1e-9;  // a smaller probability means the same to a reader
  char text[32];
  std::snprintf(text, sizeof(text), p < kLeast ? "p < 1e-9" : "p = %.1g", p);
  return text;
}

}  // namespace

size_t RigNumber(const Rig& rig) {
  size_t number = rig.cameras.size();
  const auto add = [&number](double value) {
    constexpr size_t kPrime = 1099511628211ULL;  // FNV-1a, with numbers instead of bytes
    number = (number ^ std::hash<double>()(value)) * kPrime;
  };
  for (const RigCamera& camera : rig.cameras) {
    for (int k = 0; k < 9; ++k) add(camera.Q(k / 3, k % 3));
    for (int k = 0; k < 3; ++k) add(camera.s(k));
    add(camera.intrinsics.cx());
    add(camera.intrinsics.cy());
  }
  return number;
}

RigTest TestRigOfRun(const EstimateReport& report) {
  std::vector<RigScore> scores;
  size_t rig = 0;
  for (size_t k = 0; k < report.estimates.size(); ++k) {
    const RigScore& score = report.estimates[k].refine.rig_score;
    if (score.empty()) continue;
    if (scores.empty()) rig = report.matches[k].rig;
    if (report.matches[k].rig == rig) scores.push_back(score);
  }
  return TestRig(ScoreOfRun(scores));
}

Json RigTestJson(const RigTest& test) {
  Json json = {{"pairs", test.num_pairs},
               {"chi2", test.chi2},
               {"degrees_of_freedom", test.degrees_of_freedom},
               {"p", test.p},
               {"p_with_calibration", test.p_with_calibration}};
  for (const CameraTurn& turn : test.cameras) {
    json["cameras"].push_back({{"camera", turn.camera},
                               {"p", turn.p},
                               {"p_with_calibration", turn.p_with_calibration},
                               {"turn_deg", TurnJson(turn.turn)},
                               {"turn_sd_deg", TurnJson(turn.sigma)}});
  }
  return json;
}

std::string RigTestLine(const RigTest& test) {
  if (test.degrees_of_freedom == 0 || !(test.p_with_calibration < kRigIsOff)) return "";
  std::string text;
  for (const CameraTurn& camera : test.cameras) {
    if (!(camera.p_with_calibration < kRigIsOff)) continue;
    text += (text.empty() ? "camera " : "; camera ") + std::to_string(camera.camera) + ":" +
            TurnText(camera);
  }
  if (text.empty()) text = "the rig is off, no camera by itself";
  return text + " in " + std::to_string(test.num_pairs) +
         (test.num_pairs == 1 ? " pair" : " pairs") + " (" +
         ProbabilityText(test.p_with_calibration) + "), against camera 0 and the rig";
}

}  // namespace rigel
