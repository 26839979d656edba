// Figures of the paper that this library follows: its Tables 2 to 4, measured on KITTI odometry.
//
//   Li, Liu, Han, Lv: Efficient Minimal Solvers for Relative Pose Estimation in Autonomous Driving
//   Applications. Table 2: average runtime within RANSAC; Tables 3, 4: median rotation and median
//   translation direction errors of sequences 00 to 10.
//
// Their matches, thresholds, priors and machine are not ours: beside measured figures they say what
// was published, not what these matches give.
#ifndef RIGEL_PROBLEMS_EVALUATION_PAPER_FIGURES_H_
#define RIGEL_PROBLEMS_EVALUATION_PAPER_FIGURES_H_

#include <optional>
#include <string_view>

namespace rigel {

enum class PaperTable {
  kRuntimeMs,     // over all sequences: of the sequence "all" only
  kRotationDeg,   // of "00" to "10"
  kDirectionDeg,  // of "00" to "10"
};

// Nothing where the paper has no such solver or sequence.
std::optional<double> PaperFigure(PaperTable table, std::string_view solver,
                                  std::string_view sequence);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_PAPER_FIGURES_H_
