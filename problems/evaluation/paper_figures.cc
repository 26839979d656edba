#include "rigel/problems/evaluation/paper_figures.h"

#include <algorithm>

namespace rigel {
namespace {

constexpr std::array<std::string_view, 8> kSolvers = {
    "17pt-li", "6pt-stewenius", "6pt-ventura",     "4pt-lee",
    "4pt-liu", "4pt-approx",    "4pt-axis-approx", "3pt-approx"};

using Row = std::array<double, kSolvers.size()>;  // in the order of kSolvers

// These are Table 1: one call, microseconds.
constexpr Row kCallMeanUs = {50.2704, 3759.8892, 57.4035, 28.0242,
                             8.2684,  16.2423,   13.6533, 18.6852};
constexpr Row kCallMedianUs = {48, 3744, 53, 27, 7, 10, 8, 12};

// Table 2, there in seconds.
constexpr Row kRuntimeMs = {776.4, 23472.7, 6454.4, 1048.3, 631.6, 1042.4, 477.2, 1294.5};

// Tables 3 and 4, rows 00, 01, ..., 10.
constexpr std::array<Row, 11> kRotationDeg = {{
    {0.0928, 0.1924, 0.0595, 0.0308, 0.0315, 0.0333, 0.0369, 0.0347},
    {0.0998, 0.4580, 0.0497, 0.0368, 0.0375, 0.0438, 0.0284, 0.0519},
    {0.0826, 0.1801, 0.0545, 0.0289, 0.0287, 0.0297, 0.0345, 0.0329},
    {0.0762, 0.2207, 0.0516, 0.0360, 0.0361, 0.0384, 0.0384, 0.0387},
    {0.0737, 0.2037, 0.0434, 0.0220, 0.0232, 0.0212, 0.0229, 0.0268},
    {0.0742, 0.1968, 0.0456, 0.0268, 0.0270, 0.0266, 0.0283, 0.0292},
    {0.0693, 0.2059, 0.0421, 0.0264, 0.0264, 0.0239, 0.0249, 0.0299},
    {0.0708, 0.1912, 0.0497, 0.0270, 0.0269, 0.0292, 0.0299, 0.0297},
    {0.0777, 0.1901, 0.0498, 0.0254, 0.0255, 0.0284, 0.0317, 0.0292},
    {0.0857, 0.1823, 0.0541, 0.0277, 0.0289, 0.0309, 0.0323, 0.0339},
    {0.0885, 0.1935, 0.0572, 0.0276, 0.0281, 0.0279, 0.0331, 0.0326},
}};
// The same for the direction of translation.
constexpr std::array<Row, 11> kDirectionDeg = {{
    {1.8917, 3.4859, 1.1230, 1.1374, 1.1186, 1.2419, 1.1088, 1.5012},
    {3.9064, 6.8551, 1.3609, 1.3383, 1.3408, 2.2743, 1.2823, 2.3850},
    {1.4328, 2.3983, 0.9234, 0.9630, 0.9621, 1.0481, 1.0051, 1.4019},
    {2.1875, 6.3038, 1.3101, 1.2063, 1.2508, 1.3521, 1.2170, 1.4543},
    {1.4304, 3.1938, 0.6006, 0.5948, 0.6084, 0.6400, 0.6295, 1.4000},
    {1.6829, 3.6314, 0.7776, 0.8465, 0.7951, 0.8900, 0.7687, 1.4447},
    {1.5178, 3.0878, 0.6101, 0.6235, 0.6330, 0.6432, 0.5544, 1.2872},
    {2.1587, 4.7190, 1.1337, 1.0859, 1.0160, 1.2362, 1.1084, 1.6828},
    {2.0057, 4.0091, 1.2802, 1.2133, 1.2476, 1.3881, 1.2634, 1.8108},
    {1.4466, 2.7625, 0.8632, 0.7735, 0.7972, 0.9051, 0.8708, 1.4341},
    {1.6177, 3.0233, 0.9877, 0.9822, 0.9490, 1.0758, 0.9462, 1.5479},
}};

// The row of a table that has no sequences, else null.
const Row* RowOfAll(PaperTable table) {
  switch (table) {
    case PaperTable::kCallMeanUs:
      return &kCallMeanUs;
    case PaperTable::kCallMedianUs:
      return &kCallMedianUs;
    case PaperTable::kRuntimeMs:
      return &kRuntimeMs;
    default:
      return nullptr;
  }
}

}  // namespace

const std::array<std::string_view, 8>& PaperSolvers() { return kSolvers; }

std::optional<double> PaperFigure(PaperTable table, std::string_view solver,
                                  std::string_view sequence) {
  const auto found = std::find(kSolvers.begin(), kSolvers.end(), solver);
  if (found == kSolvers.end()) return std::nullopt;
  const auto column = static_cast<size_t>(found - kSolvers.begin());
  if (const Row* row = RowOfAll(table)) {
    return sequence == "all" ? std::optional<double>((*row)[column]) : std::nullopt;
  }
  const bool two_digits = sequence.size() == 2 && sequence[0] >= '0' && sequence[0] <= '9' &&
                          sequence[1] >= '0' && sequence[1] <= '9';
  if (!two_digits) return std::nullopt;
  const size_t row = 10 * static_cast<size_t>(sequence[0] - '0') + (sequence[1] - '0');
  if (row >= kRotationDeg.size()) return std::nullopt;
  return table == PaperTable::kRotationDeg ? kRotationDeg[row][column] : kDirectionDeg[row][column];
}

}  // namespace rigel
