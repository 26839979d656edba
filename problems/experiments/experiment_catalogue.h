// The experiments by name: those of the paper (Li, Liu, Han, Lv) and a few more on the same scene.
#ifndef RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_CATALOGUE_H_
#define RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_CATALOGUE_H_

#include <string>
#include <string_view>
#include <vector>

namespace rigel {

enum class ExperimentVariable {
  kImageNoise,  // px
  kPitch,       // error of the prior about body X, degrees
  kRoll,        // about body Z
  kVibration,   // 1-sigma of a translation along body Y, percent of |t|
  kRotation,    // degrees
  kOutliers,    // percent of the matches
  kMatchCount,
  kInterShare,  // percent of the matches
  kNone,        // the motions of real drives
};

struct ExperimentSpec {
  const char* name;
  const char* about;  // one line
  ExperimentVariable variable;
  const char* x_name;   // with its unit, as in reports; empty for kNone
  const char* x_label;  // of figures
  bool planar;          // planar motion: turns about body Y, no vertical translation
  std::vector<std::string> motions;
  std::vector<double> quick_values, values;  // of the variable; none for kNone
  std::vector<std::string> solvers;
};

// In the order of the paper, then Rigel's own.
const std::vector<ExperimentSpec>& ExperimentCatalogue();

// Null if there is none of that name.
const ExperimentSpec* FindExperiment(std::string_view name);

// "image-noise, pitch-noise, ...", for messages.
std::string ExperimentNames();

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_CATALOGUE_H_
