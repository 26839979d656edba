// Figures of the paper that this library follows: its Table 1, measured on simulated samples, and
// its Tables 2 to 4, measured on KITTI odometry.
//
//   Li, Liu, Han, Lv: Efficient Minimal Solvers for Relative Pose Estimation in Autonomous Driving
//   Applications. Table 1: runtime of one call of a solver; Table 2: average runtime within RANSAC;
//   Tables 3, 4: median rotation and median translation direction errors of sequences 00 to 10.
//
// Their matches, thresholds, priors and machine are not ours: beside measured figures they say what
// was published, not what these matches give.
#ifndef RIGEL_PROBLEMS_EVALUATION_PAPER_FIGURES_H_
#define RIGEL_PROBLEMS_EVALUATION_PAPER_FIGURES_H_

#include <array>
#include <optional>
#include <string_view>

namespace rigel {

enum class PaperTable {
  kCallMeanUs,  // of the sequence "all" only, as the next two
  kCallMedianUs,
  kRuntimeMs,     // over all sequences of KITTI
  kRotationDeg,   // of "00" to "10"
  kDirectionDeg,  // of "00" to "10"
};

// Names of the solvers in the order of the tables.
const std::array<std::string_view, 8>& PaperSolvers();

// Nothing where the paper has no such solver or sequence.
std::optional<double> PaperFigure(PaperTable table, std::string_view solver,
                                  std::string_view sequence);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_PAPER_FIGURES_H_
